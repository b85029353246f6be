//! glTF 2.0 with the extension `HTEX_texture`: a material that carries an asset, whose file is a
//! buffer view (`spec/materials-1.md`).
//!
//! Only the objects on the way from a material to the bytes are read, by types of this crate: a
//! mesh may have anything else, and may be wrong in it.

mod glb;
mod material;
mod read;
#[cfg(feature = "export")]
mod write;

pub use material::{EXTENSION, Material, MediaType, material_schema};
pub use read::{Texture, read};

pub(crate) use read::{copyright, held};
#[cfg(feature = "export")]
pub(crate) use write::written;
