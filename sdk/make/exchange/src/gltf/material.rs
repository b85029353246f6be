//! The properties of the glTF extension `HTEX_texture`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::Fault;

/// The extension's name in a glTF file.
pub const EXTENSION: &str = "HTEX_texture";

/// The extension `HTEX_texture` of a glTF 2.0 material. The extension refers to the texture that a
/// finger feels when it slides over surfaces of this material. Properties that are not described
/// here are allowed, including `extensions` and `extras`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct Material {
    /// Index of the buffer view that contains a `.htex` file.
    pub buffer_view: u32,
    /// Media type of the bytes in the buffer view.
    pub mime_type: MediaType,
    /// The number n of the set of texture coordinates `TEXCOORD_n`. These coordinates state where
    /// on the surface a point lies.
    #[serde(default)]
    pub tex_coord: u32,
    /// Two lengths on the surface, in millimetres: the length of one unit of the first texture
    /// coordinate, and the length of one unit of the second. If this property is missing, distances
    /// on the surface follow from the geometry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("items" = {"type": "number", "exclusiveMinimum": 0}))]
    pub tex_coord_size_mm: Option<[f64; 2]>,
}

/// Media types of assets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum MediaType {
    /// A `.htex` file.
    #[serde(rename = "application/vnd.htex+zip")]
    Htex,
}

impl Material {
    /// Checks the rules that the types do not express. `pointer` is the JSON pointer to the
    /// extension.
    pub(super) fn check(&self, pointer: &str) -> Result<(), Fault> {
        let sizes = self.tex_coord_size_mm.iter().flatten();
        for (i, size_mm) in sizes.enumerate() {
            // Written this way so that NaN is also refused.
            if !(*size_mm > 0.0 && size_mm.is_finite()) {
                return Err(Fault::new(
                    format!("{pointer}/texCoordSizeMm/{i}"),
                    format!("{size_mm} mm; a surface is longer than 0 mm"),
                ));
            }
        }
        Ok(())
    }
}

/// Returns the JSON Schema of the extension: `spec/schemas/gltf-material-1.json`.
#[must_use]
pub fn material_schema() -> Value {
    let title = "extension HTEX_texture of materials of glTF 2.0";
    htex_base::schema::document::<Material>("gltf-material-1.json", title)
}
