//! Writes a glTF file with a rectangle whose material refers to an asset.

use std::borrow::Cow;

use htex_author::AuthorError;
use htex_format::Rights;
use serde_json::{Value, json};

use super::glb;
use super::material::{EXTENSION, Material, MediaType};
use super::read::{data_uri, read};
use crate::error::ExchangeError;
use crate::export::Export;
use crate::json::{self, MOST_BYTES};

/// Side of the rectangle, millimetres. Each texture coordinate goes from 0 to 1 along it.
const SIDE_MM: f64 = 100.0;
/// Half the side in metres, the unit of glTF.
const HALF_M: f32 = 0.05;
/// Corners with their texture coordinates. The first coordinate goes from left to right, the second
/// from the upper edge to the lower edge.
const CORNERS: [([f32; 3], [f32; 2]); 4] = [
    ([-HALF_M, HALF_M, 0.0], [0.0, 0.0]),
    ([-HALF_M, -HALF_M, 0.0], [0.0, 1.0]),
    ([HALF_M, HALF_M, 0.0], [1.0, 0.0]),
    ([HALF_M, -HALF_M, 0.0], [1.0, 1.0]),
];
/// The rectangle faces +Z. Seen from +Z, the corners of its triangles run counterclockwise.
const NORMAL: [f32; 3] = [0.0, 0.0, 1.0];
const TRIANGLES: [u16; 6] = [0, 1, 2, 2, 1, 3];

/// Numeric constants of glTF 2.0.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Writes a glTF file with a rectangle and the asset. If the extension `.gltf` is requested, writes
/// a `.gltf` file with an embedded buffer, otherwise a `.glb` file.
pub(crate) fn export(
    asset: &htex_play::Texture,
    job: &Export<'_>,
) -> Result<Vec<u8>, ExchangeError> {
    let format = job.format;
    let manifest = asset.manifest();
    let asset = match job.file {
        Some(file) => Cow::Borrowed(file),
        None => Cow::Owned(asset.data().to_bytes().map_err(AuthorError::from)?),
    };
    if asset.len() as u64 > MOST_BYTES {
        return Err(format.cannot(too_long(asset.len())));
    }
    let mut buffer = Buffer::of_rectangle();
    let texture = Material {
        // Added after the rectangle, because the rectangle's numbers need offsets that are
        // multiples of four, and an asset may have any length.
        buffer_view: buffer.add(&asset, None),
        mime_type: MediaType::Htex,
        tex_coord: 0,
        tex_coord_size_mm: Some([SIDE_MM; 2]),
    };
    let mut document = document(&manifest.name, &texture, &buffer);
    let rights = Rights::from_manifest(manifest);
    if !rights.is_empty() {
        document["asset"]["copyright"] = rights.described("").into();
    }
    let file = match job.extension {
        Some("gltf") => {
            document["buffers"][0]["uri"] = data_uri(&buffer.bytes).into();
            json::written(&document)
        }
        _ => glb::file(document.to_string().into_bytes(), buffer.bytes),
    };
    if file.len() as u64 > MOST_BYTES {
        return Err(format.cannot(too_long(file.len())));
    }
    let again = read(&file).map_err(|fault| format.cannot(fault.to_string()))?;
    if again.bytes == *asset && again.material == texture {
        Ok(file)
    } else {
        Err(format.cannot("what was written is read as another asset"))
    }
}

fn too_long(bytes: usize) -> String {
    format!(
        "the file would have at least {bytes} bytes, and at most {MOST_BYTES} are read; a .glb is a quarter shorter than a .gltf"
    )
}

/// The buffer and its views.
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
}

impl Buffer {
    /// Makes the buffer of the rectangle: positions, normals, texture coordinates, and the indices
    /// of the triangles.
    fn of_rectangle() -> Self {
        let mut made = Self { bytes: Vec::new(), views: Vec::new() };
        let floats = |values: Vec<f32>| -> Vec<u8> {
            values.into_iter().flat_map(f32::to_le_bytes).collect()
        };
        let positions = CORNERS.iter().flat_map(|(position, _)| *position);
        made.add(&floats(positions.collect()), Some(ARRAY_BUFFER));
        made.add(&floats([NORMAL; 4].concat()), Some(ARRAY_BUFFER));
        let coordinates = CORNERS.iter().flat_map(|(_, coordinates)| *coordinates);
        made.add(&floats(coordinates.collect()), Some(ARRAY_BUFFER));
        let triangles = TRIANGLES.into_iter().flat_map(u16::to_le_bytes);
        made.add(&Vec::from_iter(triangles), Some(ELEMENT_ARRAY_BUFFER));
        made
    }

    /// Adds a view with these bytes and returns its index.
    fn add(&mut self, bytes: &[u8], target: Option<u32>) -> u32 {
        let mut view = json!({
            "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()
        });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend(bytes);
        self.views.push(view);
        self.views.len() as u32 - 1
    }
}

fn document(name: &str, texture: &Material, buffer: &Buffer) -> Value {
    let vector = |view: usize, kind: &str| json!({"bufferView": view, "componentType": FLOAT, "count": CORNERS.len(), "type": kind});
    let mut positions = vector(0, "VEC3");
    // The specification requires minimum and maximum for positions, but not for other numbers.
    positions["min"] = json!([-HALF_M, -HALF_M, 0.0]);
    positions["max"] = json!([HALF_M, HALF_M, 0.0]);
    let indices = json!({
        "bufferView": 3, "componentType": UNSIGNED_SHORT, "count": TRIANGLES.len(), "type": "SCALAR"
    });
    json!({
        "asset": {"version": "2.0", "generator": concat!("htex ", env!("CARGO_PKG_VERSION"))},
        "extensionsUsed": [EXTENSION],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": name, "mesh": 0}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0,
        }]}],
        "materials": [{
            "name": name,
            "pbrMetallicRoughness": {"metallicFactor": 0.0},
            "extensions": {EXTENSION: texture},
        }],
        "accessors": [positions, vector(1, "VEC3"), vector(2, "VEC2"), indices],
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": buffer.bytes.len()}],
    })
}
