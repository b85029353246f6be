//! Import of texture models from the Penn Haptic Texture Toolkit (HaTT; Culbertson, Lopez Delgado
//! and Kuchenbecker 2014), which are XML files.
//!
//! A file has nodes of speed and force. At each node the acceleration of a rigid tool, m/s², is
//! white noise of some variance, passed through a filter with poles and zeros at 1 kHz and
//! multiplied by a gain. The asset has the same filters at the same motions (`org.htex.arma`), with
//! the toolkit's triangles between them. The extension [`EXTENSION`] stores what a player does not
//! use: friction, rate, and the largest speed and force. At each node the asset has the magnitude
//! of the file's filter. Between nodes, the toolkit mixes line spectral frequencies, variance and
//! gain; the asset mixes the same line spectral frequencies, and levels. A node of variance 0 is
//! silent, but its line spectral frequencies are mixed.
//!
//! Magnitudes are as exact as line spectral frequencies stored as 32-bit floats allow. The line
//! spectral frequencies are computed from the coefficients, because those in the file have six
//! decimals, which puts a notch off by up to 0.02 dB.

mod asset;
mod document;
mod element;
mod extension;
mod node;
mod texture;
mod work;
mod zeros;

pub use asset::asset;
pub(crate) use asset::import;
pub use document::MOST_BYTES;
pub use extension::{EXTENSION, extension_schema};
pub use node::Node;
pub use texture::{Texture, read};
