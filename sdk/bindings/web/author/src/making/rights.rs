//! Returns the licence and the author of textures, to store them in files that are made from these
//! textures.

use htex::format::Asset;
use htex_format::Rights;
use serde::Serialize;

use crate::answer::{Answer, Files};
use crate::document::Document;
use crate::refusal::Refusal;

#[derive(Serialize)]
struct RightsSummary<'a> {
    license: Option<&'a str>,
    author: Option<&'a str>,
    /// Both as SPDX lines.
    text: String,
}

/// Returns the licence and the author of a texture, which is the only file. The bytes of the answer
/// are a chunk with both, for a WAV file.
pub(crate) fn rights(call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    call.finish()?;
    let [bytes] = files else {
        return Err(Refusal::argument("give one texture"));
    };
    let rights = Rights::from_manifest(&Asset::from_bytes(bytes)?.manifest);
    let stated = RightsSummary {
        license: rights.license.as_deref(),
        author: rights.author.as_deref(),
        text: rights.to_text(),
    };
    Answer::new(&stated, rights.riff())
}
