//! Textures to a library.

use serde::Deserialize;
use serde_json::json;

use crate::call::{Answer, Files, parsed};
use crate::refusal::Refusal;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Pack {
    /// Name of the library.
    #[serde(default)]
    name: String,
    /// Names of the textures, which are the files.
    textures: Vec<String>,
}

/// Packs textures; the bytes are the library.
pub(crate) fn pack(json: &[u8], files: Files<'_>) -> Result<Answer, Refusal> {
    let call: Pack = parsed(json)?;
    if call.textures.len() != files.len() {
        return Err(Refusal::argument("a file is missing"));
    }
    let mut writer = htex_library::MemoryWriter::new(&call.name)?;
    for (name, bytes) in call.textures.iter().zip(files) {
        writer.add(name, bytes)?;
    }
    let (packed, bytes) = writer.finish()?;
    Answer::new(
        &json!({ "entries": packed.entries, "bytes": packed.bytes }),
        bytes,
    )
}
