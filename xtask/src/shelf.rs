//! Remakes the textures that come with the studio and with each release,
//! `sdk/bindings/studio/shelf/shelf.htexlib`.

use anyhow::Result;

use crate::programs::{program, run};

/// Makes the library of textures that comes with the studio, with the `htex` command.
///
/// # Errors
/// A message with the file or the program.
pub fn shelf() -> Result<()> {
    let command = crate::bindings::command()?;
    run(program("node", &crate::studio::source())
        .arg("shelf/make.mjs")
        .arg(command)
        .arg("shelf/shelf.htexlib"))
}
