//! Downloads the inputs that a command reads by URI, and uploads its outputs.

use std::fs::File;
use std::path::Path;

use htex_base::files::AtFile;
use htex_base::storage::{Storage, StorageError};
use htex_format::Limits;

use crate::failure::Failure;
use crate::located::{Role, keep, taken};

/// Maximum size of a downloaded recording, bytes. `--most-numbers` limits how many of its values
/// are kept.
const MOST_RECORDING_BYTES: u64 = 16 << 30;

/// Downloads the inputs, and checks that the outputs can be written, as far as that is possible
/// without a request.
#[allow(clippy::disallowed_methods, reason = "a new temporary folder of this user")]
pub(crate) fn fetch() -> Result<(), Failure> {
    let files = taken(|_| true);
    if files.is_empty() {
        return Ok(());
    }
    let storage = Storage::from_environment()?;
    // Before any download, which a wrong output would make useless.
    for (location, _, _) in files.iter().filter(|(_, _, role)| *role == Role::Output) {
        storage.check_writable(location)?;
    }
    for (location, local, role) in files {
        let most_bytes = match role {
            Role::Output | Role::LocalOutput => continue,
            Role::Asset => Limits::default().file_bytes,
            Role::Recording => MOST_RECORDING_BYTES,
        };
        let mut options = File::options();
        htex_base::files::private::only_user(&mut options);
        // `create_new` follows no link. The folder is new, so nothing is there.
        let file = options.write(true).create_new(true).open(&local).writing(&local)?;
        storage.download(&location, file, most_bytes)?;
    }
    Ok(())
}

/// Uploads the outputs of a command that has succeeded. If that fails, the local copy is kept.
pub(crate) fn put() -> Result<(), Failure> {
    let outputs = taken(|role| role == Role::Output);
    if outputs.is_empty() {
        return Ok(());
    }
    let storage = Storage::from_environment()?;
    for (location, local, _) in outputs {
        let written = storage.write_file(&location, &local);
        written.map_err(|error| kept(&local, error))?;
    }
    Ok(())
}

/// Returns the error for an output, whose local copy is kept after the command.
fn kept(copy: &Path, error: StorageError) -> Failure {
    keep();
    Failure::Other(format!("{error}; the result is kept in {}", copy.display()))
}
