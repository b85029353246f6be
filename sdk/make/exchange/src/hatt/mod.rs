//! Imports texture models of the Penn Haptic Texture Toolkit (HaTT; Culbertson, Lopez Delgado and
//! Kuchenbecker 2014). The models are XML files.
//!
//! A file has nodes. Each node has a speed, a force and a filter with poles and zeros, which runs
//! at a sample rate of 1 kHz. The acceleration of a rigid tool, m/s², is white noise of some
//! variance that passes through the filter and is multiplied by a gain. The asset has the same
//! filters at the same speeds and forces (model `org.htex.arma`), with the toolkit's triangles
//! between them. The extension [`EXTENSION`] stores what a player does not use: friction, sample
//! rate, and the largest speed and force. At each node, the asset has the magnitude of the file's
//! filter. Between nodes, the toolkit interpolates line spectral frequencies, variance and gain.
//! The asset interpolates the same line spectral frequencies, and levels. A node of variance 0 is
//! silent, but its line spectral frequencies also take part in the interpolation.
//!
//! Line spectral frequencies are stored as 32-bit floats, which limits the accuracy of the
//! magnitudes. They are computed from the filter coefficients. The file also has line spectral
//! frequencies, but only with six decimals, which would change a notch by up to 0.02 dB.

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
