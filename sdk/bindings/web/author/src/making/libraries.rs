//! Packs textures into a library.

use crate::answer::{Answer, Files};
use crate::document::Document;
use crate::refusal::Refusal;

/// Packs textures under the given names. The files are the textures. The bytes of the answer are
/// the library.
pub(crate) fn pack(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let name = call.text("name")?.unwrap_or_default();
    let textures = call.texts("textures")?;
    let is_unlicensed = call.flag("unlicensed")?;
    call.finish()?;
    if textures.len() != files.len() {
        return Err(Refusal::argument("a file is missing"));
    }
    let mut writer = htex_format::library::MemoryWriter::new(&name)?;
    writer.describe_with(htex_author::describe);
    if is_unlicensed {
        writer.allow_unlicensed();
    }
    for (name, bytes) in textures.iter().zip(files) {
        writer.add(name, bytes)?;
    }
    let (_, bytes) = writer.finish()?;
    Answer::new(&(), bytes)
}
