//! Friction maps: 8-bit PNG images, as displays by electroadhesion take them (TanvasTouch). A pixel
//! is the friction there, black for the least and white for the most.
//!
//! An image is an asset of the model `org.htex.map`, which has its pixels as they are and follows
//! the place of the finger. The distance of the pixels is that of the chunk `pHYs` (PNG, section
//! 11.3.4.3), unless one is given. An asset with such a model goes out as its own pixels. Any other
//! texture goes out as one row, whose waves have at a speed the magnitudes that the texture plays
//! there.

mod asset;
mod image;
#[cfg(feature = "export")]
mod write;

pub(crate) use asset::{Surface, held};
pub use image::{Image, read};
pub(crate) use image::{PITCH_MM, rights};
#[cfg(feature = "export")]
pub(crate) use write::written;

/// The model of the pixels.
const MODEL: &str = "org.htex.map";
