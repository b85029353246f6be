//! Reads and writes friction maps: 8-bit PNG images, as electroadhesion displays use them
//! (TanvasTouch). Each pixel is the friction at its place, from black for the least to white for
//! the most.
//!
//! An image becomes an asset with the model `org.htex.map`, which stores the pixels unchanged and
//! follows the place of the finger. The distance between pixels comes from the chunk `pHYs` (PNG,
//! section 11.3.4.3), unless the user gives it. When an asset with this model is exported, the
//! image has the same pixels. Any other texture is exported as one row of pixels. At one speed, the
//! waves in this row have the magnitudes that the texture plays.

mod asset;
mod image;
#[cfg(feature = "export")]
mod write;

pub(crate) use asset::import;
pub use image::{Image, read};
pub(crate) use image::{PITCH_MM, rights};
#[cfg(feature = "export")]
pub(crate) use write::export;

/// The model that plays the pixels.
const MODEL: &str = "org.htex.map";
