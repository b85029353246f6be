//! Downloads of what a command reads by URI, and uploads of what it writes.

use std::fs::File;
use std::path::Path;

use htex_files::AtFile;
use htex_format::Limits;
use htex_storage::{Storage, StorageError};

use crate::failure::Failure;
use crate::located::{Role, keep, taken};

/// Most bytes of a recording that is downloaded. Those of its numbers that are kept are bounded by
/// `--most-numbers`.
const MOST_RECORDING_BYTES: u64 = 16 << 30;

/// Downloads what is read, and checks that what will be written can be, as far as that is known
/// without a request.
#[allow(clippy::disallowed_methods, reason = "a new temporary folder of this user")]
pub(crate) fn fetch() -> Result<(), Failure> {
    let files = taken(|_| true);
    if files.is_empty() {
        return Ok(());
    }
    let storage = Storage::from_environment()?;
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
        htex_files::private::only_user(&mut options);
        let file = options.write(true).create_new(true).open(&local).writing(&local)?;
        storage.download(&location, file, most_bytes)?;
    }
    Ok(())
}

/// Writes the outputs of a command that has succeeded. What cannot be written stays in its local
/// copy.
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

/// The error of an output, whose local copy outlives the command.
fn kept(copy: &Path, error: StorageError) -> Failure {
    keep();
    Failure::Other(format!("{error}; the result is kept in {}", copy.display()))
}
