//! Reads files that may be too large.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use htex_base::files::AtFile;
use htex_format::Limits;

use crate::failure::Failure;

/// Returns a file's bytes. If the file is larger than an asset may be, returns one byte more than
/// is allowed.
pub(crate) fn read_asset(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    // The reader refuses the additional byte with its own finding, so only it says what the limit
    // is.
    let most = Limits::default().file_bytes.saturating_add(1);
    File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes)).reading(path)?;
    Ok(bytes)
}
