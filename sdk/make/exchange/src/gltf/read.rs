//! Reads the asset to which a material of a glTF file refers.

use std::borrow::Cow;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Deserialize;

use super::glb::{Chunks, chunks};
use super::material::{EXTENSION, Material};
use crate::error::Fault;
use crate::format::Naming;
use crate::import::ImportedAsset;
use crate::json;

/// Allowed media types of buffers in data URIs (glTF 2.0, section 3.6.1).
const BUFFER_TYPES: [&str; 2] = ["application/octet-stream", "application/gltf-buffer"];
/// Number of bytes by which a buffer in a container may be shorter than its chunk.
const MOST_PADDING: usize = 3;

/// The texture that was found in a glTF file.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Texture {
    /// The properties of the material's extension.
    pub material: Material,
    /// The bytes of the `.htex` file.
    pub bytes: Vec<u8>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Document {
    asset: Header,
    #[serde(default)]
    extensions_used: Vec<String>,
    #[serde(default)]
    materials: Vec<MaterialObject>,
    #[serde(default)]
    buffer_views: Vec<View>,
    #[serde(default)]
    buffers: Vec<Buffer>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Header {
    version: String,
    min_version: Option<String>,
}

#[derive(Debug, Deserialize)]
struct MaterialObject {
    #[serde(default)]
    extensions: Extensions,
}

#[derive(Debug, Default, Deserialize)]
struct Extensions {
    #[serde(rename = "HTEX_texture")]
    texture: Option<Material>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct View {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Buffer {
    byte_length: usize,
    uri: Option<String>,
}

/// Reads the texture of a `.glb` or a `.gltf` file.
///
/// # Errors
/// Returns an error if the file is not glTF 2.0, if no material has a texture, if several materials
/// have different textures, or if the bytes of the asset are not where the file states. The error
/// names the place: a JSON pointer, or a byte offset in a `.glb`. This function does not check that
/// the bytes are a valid asset.
pub fn read(file: &[u8]) -> Result<Texture, Fault> {
    if file.len() as u64 > json::MOST_BYTES {
        let most = json::MOST_BYTES;
        let problem = format!("it has {} bytes, and at most {most} are read", file.len());
        return Err(Fault::whole(problem));
    }
    let chunks = chunks(file)?;
    let document: Document = json::read(chunks.json)?;
    document.check_version()?;
    let (pointer, material) = document.texture()?;
    material.check(&pointer)?;
    document.check_used()?;
    let bytes = document.bytes_of(material, &pointer, &chunks)?;
    Ok(Texture { material: material.clone(), bytes })
}

/// Returns the copyright that a file states, or `None` if it states none or cannot be read.
pub(crate) fn copyright(file: &[u8]) -> Option<String> {
    crate::rights::text(chunks(file).ok()?.json, "asset", "copyright")
}

/// Reads the texture of a file as an asset. The asset keeps its own name.
pub(crate) fn import(file: &[u8], _: &Naming<'_>) -> Result<ImportedAsset, Fault> {
    let texture = read(file)?;
    let asset = htex_format::Asset::from_bytes(&texture.bytes).map_err(|error| {
        let pointer = format!("/bufferViews/{}", texture.material.buffer_view);
        Fault::new(pointer, error.to_string())
    })?;
    Ok(ImportedAsset::new(asset, Some(texture.bytes), Vec::new()))
}

impl Document {
    fn check_version(&self) -> Result<(), Fault> {
        let versions = [
            ("minVersion", self.asset.min_version.as_deref()),
            ("version", Some(&self.asset.version[..])),
        ];
        for (key, version) in versions {
            let Some(version) = version else { continue };
            let is_read = match key {
                // A file that needs a later version may use properties that this reader does not
                // know. A file that only names a later version 2.x must still be readable.
                "minVersion" => version == "2.0",
                _ => version.starts_with("2."),
            };
            if !is_read {
                let problem = format!("this is glTF {version}, and 2.0 is read");
                return Err(Fault::new(format!("/asset/{key}"), problem));
            }
        }
        Ok(())
    }

    /// Returns the only texture of the file, with the JSON pointer to it. Several materials may
    /// share this texture.
    fn texture(&self) -> Result<(String, &Material), Fault> {
        let all = self.materials.iter().enumerate();
        let mut textures = all.filter_map(|(i, m)| Some((i, m.extensions.texture.as_ref()?)));
        let Some((first, texture)) = textures.next() else {
            let problem =
                format!("no material has the extension {EXTENSION}, which carries a texture");
            return Err(Fault::new("/materials", problem));
        };
        if let Some((other, _)) = textures.find(|(_, t)| t.buffer_view != texture.buffer_view) {
            let problem = format!(
                "material {first} carries another texture; keep one of them in the file that is imported"
            );
            return Err(Fault::new(pointer_to(other), problem));
        }
        Ok((pointer_to(first), texture))
    }

    fn check_used(&self) -> Result<(), Fault> {
        if self.extensions_used.iter().any(|name| name == EXTENSION) {
            return Ok(());
        }
        let problem = format!("a material has the extension {EXTENSION}; list it here");
        Err(Fault::new("/extensionsUsed", problem))
    }

    fn bytes_of(
        &self,
        material: &Material,
        pointer: &str,
        chunks: &Chunks<'_>,
    ) -> Result<Vec<u8>, Fault> {
        let index = material.buffer_view as usize;
        let view = self.buffer_views.get(index).ok_or_else(|| {
            let there = self.buffer_views.len();
            let problem = format!("there is no buffer view {index}; the file has {there}");
            Fault::new(format!("{pointer}/bufferView"), problem)
        })?;
        let of_view =
            |key: &str, problem: String| Fault::new(format!("/bufferViews/{index}/{key}"), problem);
        if view.byte_stride.is_some() {
            let problem = "only vertices have a stride; leave it out".to_owned();
            return Err(of_view("byteStride", problem));
        }
        let buffer = self.buffers.get(view.buffer).ok_or_else(|| {
            let (index, there) = (view.buffer, self.buffers.len());
            let problem = format!("there is no buffer {index}; the file has {there}");
            of_view("buffer", problem)
        })?;
        let bytes = buffer.bytes(view.buffer, chunks)?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let taken = end.and_then(|end| bytes.get(view.byte_offset..end)).ok_or_else(|| {
            let problem = format!(
                "{} bytes from {} on reach over the end of buffer {}, which has {}",
                view.byte_length,
                view.byte_offset,
                view.buffer,
                bytes.len()
            );
            of_view("byteLength", problem)
        })?;
        Ok(taken.to_vec())
    }
}

fn pointer_to(material: usize) -> String {
    format!("/materials/{material}/extensions/{EXTENSION}")
}

impl Buffer {
    /// Returns the bytes of a buffer. Their number is the buffer's stated length.
    fn bytes<'a>(&self, index: usize, chunks: &Chunks<'a>) -> Result<Cow<'a, [u8]>, Fault> {
        let pointer = format!("/buffers/{index}");
        let whole = match &self.uri {
            Some(uri) => Cow::Owned(decoded(uri, &format!("{pointer}/uri"))?),
            None => Cow::Borrowed(self.in_container(index, chunks, &pointer)?),
        };
        let there = whole.len();
        if self.byte_length > there {
            let problem = format!("{} bytes are stated, and {there} are there", self.byte_length);
            return Err(Fault::new(format!("{pointer}/byteLength"), problem));
        }
        Ok(match whole {
            Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[..self.byte_length]),
            Cow::Owned(mut bytes) => {
                bytes.truncate(self.byte_length);
                Cow::Owned(bytes)
            }
        })
    }

    fn in_container<'a>(
        &self,
        index: usize,
        chunks: &Chunks<'a>,
        pointer: &str,
    ) -> Result<&'a [u8], Fault> {
        let binary = chunks.binary.filter(|_| index == 0).ok_or_else(|| {
            let problem =
                "it has no `uri`, and only the first buffer of a .glb is in its second chunk";
            Fault::new(pointer, problem)
        })?;
        if binary.len() > self.byte_length.saturating_add(MOST_PADDING) {
            let problem = format!(
                "{} bytes are stated, and the chunk of the .glb has {}, more than it is filled up by",
                self.byte_length,
                binary.len()
            );
            return Err(Fault::new(format!("{pointer}/byteLength"), problem));
        }
        Ok(binary)
    }
}

/// Decodes a base64 data URI (RFC 2397).
fn decoded(uri: &str, pointer: &str) -> Result<Vec<u8>, Fault> {
    let data = uri.strip_prefix("data:").ok_or_else(|| {
        let problem = "the buffer is another file, which is not read; import a .glb, or a .gltf with its buffers in it";
        Fault::new(pointer, problem)
    })?;
    let (header, text) = data.split_once(',').unwrap_or((data, ""));
    let media_type = header.strip_suffix(";base64");
    if !media_type.is_some_and(|media_type| BUFFER_TYPES.contains(&media_type)) {
        let problem = format!(
            "a buffer in a data URI begins with data:{};base64, or data:{};base64,",
            BUFFER_TYPES[0], BUFFER_TYPES[1]
        );
        return Err(Fault::new(pointer, problem));
    }
    STANDARD
        .decode(text)
        .map_err(|error| Fault::new(pointer, format!("this is not base64: {error}")))
}

/// Encodes a buffer as a data URI.
pub(super) fn data_uri(bytes: &[u8]) -> String {
    format!("data:{};base64,{}", BUFFER_TYPES[1], STANDARD.encode(bytes))
}
