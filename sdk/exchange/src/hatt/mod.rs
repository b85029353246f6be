//! Texture models of the Penn Haptic Texture Toolkit (HaTT; Culbertson, Lopez Delgado and
//! Kuchenbecker 2014), which are XML files.
//!
//! A file has nodes of speed and force. At each the acceleration of a rigid tool, m/s², is white
//! noise of a variance through a filter with poles and zeros at 1 kHz, times a gain. An asset has
//! the same filters at the same motions (`org.htex.arma`), the toolkit's triangles between them,
//! and in the extension [`EXTENSION`] what a player does not use: friction, rate and the largest
//! speed and force. At each node the asset's magnitude is that of the file's filter. Between nodes
//! the toolkit mixes lines, variance and gain; the asset mixes the same lines, and levels. A node
//! of variance 0 is silent, and its lines are mixed.
//!
//! Magnitudes are exact to what 32-bit floats hold of the lines, which are computed of the
//! coefficients: those in the file have six decimals, by which a notch is off by up to 0.02 dB.

mod asset;
mod document;
mod element;
mod extension;
mod fault;
mod node;
mod texture;
mod work;
mod zeros;

pub use asset::{Imported, asset};
pub use document::{MOST_BYTES, MOST_ELEMENTS};
pub use extension::{EXTENSION, Hatt, extension_schema};
pub use fault::{Fault, Place};
pub use node::Node;
pub use texture::{Texture, read};
