//! The user's folders, as named by the environment.

use htex_base::native::folders::relative;

use crate::failure::Failure;
use crate::output::warn;

/// Refuses a relative path in htex's own variables. In variables that other programs read as well,
/// it only warns, because the XDG base directory specification says to ignore a relative path.
pub(crate) fn check() -> Result<(), Failure> {
    let shown = |variable: &str, path: &std::path::Path| {
        format!("{variable} is {}, which is no absolute path", crate::shown::shown(path))
    };
    let mut ignored = Vec::new();
    for (variable, path) in relative() {
        let words = shown(variable, &path);
        if variable.starts_with("HTEX_") {
            let words = format!("{words}; give one that begins with / (on Windows with a drive)");
            return Err(Failure::Usage(words));
        }
        ignored.push(format!("{words}; it is ignored, and the usual folder is used"));
    }
    warn(&ignored);
    Ok(())
}
