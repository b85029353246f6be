//! Imports texture models of the Penn Haptic Texture Toolkit (HaTT; Culbertson, Lopez Delgado and
//! Kuchenbecker 2014). The models are XML files.
//!
//! A file has nodes. Each node has a speed, a force, a variance, a gain, and a filter with poles
//! and zeros. The filter runs at a sample rate of 1 kHz. White noise with the node's variance
//! passes through the filter and is multiplied by the node's gain. The result is the acceleration
//! of a rigid tool, m/s². The asset has the same filters at the same speeds and forces (model
//! `org.htex.arma`). It also has the toolkit's triangles, which connect these pairs of speed and
//! force. The extension [`EXTENSION`] stores the values that a player does not use: friction,
//! sample rate, and the largest speed and force. At each node, the asset has the same magnitudes as
//! the file's filter. Between nodes, the toolkit interpolates line spectral frequencies, variance
//! and gain. A player of the asset interpolates the same line spectral frequencies, but it
//! interpolates levels instead of variance and gain. A node of variance 0 is silent, but its line
//! spectral frequencies are still used in the interpolation.
//!
//! Line spectral frequencies are stored as 32-bit floats, which limits the accuracy of the
//! magnitudes. The importer computes the line spectral frequencies from the filter coefficients.
//! The file also contains line spectral frequencies, but only with six decimals. With the values
//! from the file, a notch would change by up to 0.02 dB.

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
