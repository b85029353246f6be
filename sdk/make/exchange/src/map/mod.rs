//! Reads and writes friction maps: 8-bit PNG images, which electroadhesion displays such as
//! TanvasTouch use. The value of a pixel is the friction at the pixel's place. Black is the lowest
//! friction and white the highest.
//!
//! An imported image becomes an asset with the model `org.htex.map`. This model stores the pixels
//! unchanged and plays the friction at the finger's position. The distance between pixels comes
//! from the chunk `pHYs` (PNG, section 11.3.4.3), unless the user gives it. When an asset with this
//! model is exported, the image has the same pixels. Any other texture is exported as one row of
//! pixels. If a finger slides over this row at the export's speed, the finger feels waves with the
//! same magnitudes as the waves of the texture.

mod asset;
mod image;
mod write;

pub(crate) use asset::import;
pub use image::{Image, read};
pub(crate) use image::{PITCH_MM, rights};
pub(crate) use write::export;

/// The model that plays the pixels.
const MODEL: &str = "org.htex.map";
