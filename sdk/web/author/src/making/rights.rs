//! Licence and author of textures, for what is written of them elsewhere.

use htex::AssetData;
use htex_format::Rights;
use serde::Serialize;

use crate::answer::{Answer, Files};
use crate::document::Document;
use crate::refusal::Refusal;

#[derive(Serialize)]
struct Stated<'a> {
    license: Option<&'a str>,
    author: Option<&'a str>,
    /// Both as lines of SPDX.
    text: String,
}

/// Tells the rights of a texture, the file; the bytes are their chunk of a WAV file.
pub(crate) fn rights(call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    call.finish()?;
    let [bytes] = files else {
        return Err(Refusal::argument("give one texture"));
    };
    let rights = Rights::of(&AssetData::from_bytes(bytes)?.manifest);
    let stated = Stated {
        license: rights.license.as_deref(),
        author: rights.author.as_deref(),
        text: rights.to_text(),
    };
    Answer::new(&stated, rights.riff())
}
