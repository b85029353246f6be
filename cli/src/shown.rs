//! Paths in messages.

use std::path::Path;

use htex_base::finding::plain;

/// Returns a path with control characters escaped.
pub(crate) fn shown(path: &Path) -> String {
    plain(&path.display().to_string()).into_owned()
}
