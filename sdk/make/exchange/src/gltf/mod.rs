//! Reads and writes glTF 2.0 files with the extension `HTEX_texture` (`spec/materials-1.md`). A
//! material refers to an asset, whose file is stored in a buffer view.
//!
//! The reader reads only the objects that lead from a material to the bytes of the asset. It
//! ignores everything else in the file, even if it is invalid.

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
