//! Makes the textures that come with the studio, `sdk/studio/shelf/shelf.htexlib`, anew.

use anyhow::Result;

use crate::programs::{program, run};

/// Makes the library of the studio's shelf by the `htex` command.
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
