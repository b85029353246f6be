//! Reads and writes glTF 2.0 files with the extension `HTEX_texture` (`spec/materials-1.md`). A
//! material refers to a buffer view that contains the file of an asset.
//!
//! The reader reads only the objects that lead from a material to the bytes of the asset. It
//! ignores all other contents of the file, even invalid contents.

mod glb;
mod material;
mod read;
mod write;

pub use material::{EXTENSION, Material, MediaType, material_schema};
pub use read::{Texture, read};

pub(crate) use read::{copyright, import};
pub(crate) use write::export;
