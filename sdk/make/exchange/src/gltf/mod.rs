//! glTF 2.0 with the extension `HTEX_texture`: a material with an asset, whose file is stored in a
//! buffer view (`spec/materials-1.md`).
//!
//! The types of this crate read only the objects on the way from a material to the bytes.
//! Everything else in a file is ignored, even if it is wrong.

mod glb;
mod material;
mod read;
#[cfg(feature = "export")]
mod write;

pub use material::{EXTENSION, Material, MediaType, material_schema};
pub use read::{Texture, read};

pub(crate) use read::{copyright, import};
#[cfg(feature = "export")]
pub(crate) use write::export;
