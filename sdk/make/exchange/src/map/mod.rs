//! Friction maps: 8-bit PNG images, as used by electroadhesion displays (TanvasTouch). Each pixel
//! is the friction at its place: black is the least, white the most.
//!
//! An image becomes an asset of the model `org.htex.map`, which stores its pixels unchanged and
//! follows the place of the finger. The distance between pixels comes from the chunk `pHYs` (PNG,
//! section 11.3.4.3), unless the user gives one. An asset with such a model is exported as its own
//! pixels. Any other texture is exported as one row of pixels: at one speed, its waves have the
//! magnitudes that the texture plays.

mod asset;
mod image;
#[cfg(feature = "export")]
mod write;

pub(crate) use asset::import;
pub use image::{Image, read};
pub(crate) use image::{PITCH_MM, rights};
#[cfg(feature = "export")]
pub(crate) use write::export;

/// The model of the pixels.
const MODEL: &str = "org.htex.map";
