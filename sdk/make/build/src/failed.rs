//! The report of a failed build: the error, together with the report of the earlier build. A
//! program that only reads reports, such as a page of continuous integration, then sees the error.
//! Because the earlier report is kept, the next build still knows which files in the folder come
//! from builds.

use std::path::Path;

use crate::BuildError;
use crate::assemble::{previous, put_report};
use crate::dist::Dist;
use crate::report::{REPORT, Report};
use crate::state::{STATE, StateFolder};

/// Writes an error, line by line, into the report in a folder of results. Returns whether the error
/// was written. Nothing is written if no build has ever begun in this folder, or while another
/// build is using the folder.
///
/// # Errors
/// Returns an error if the report cannot be written.
pub fn report_failure(output: &Path, program: &str, error: &[String]) -> Result<bool, BuildError> {
    let dist = Dist::new(output);
    // The folder may come from somebody else, so a link in it is not followed.
    let is_folder = |path: &Path| path.symlink_metadata().is_ok_and(|at| at.is_dir());
    if !dist.path_of(Path::new(STATE)).is_ok_and(|kept| is_folder(&kept)) {
        return Ok(false);
    }
    let _lock = match StateFolder::new(output)?.claim() {
        Err(BuildError::Locked { .. }) => return Ok(false),
        lock => lock?,
    };
    put_failure(&dist, program, error)?;
    Ok(true)
}

/// Writes the report like [`report_failure`]. The caller must hold the folder's lock.
pub(crate) fn put_failure(dist: &Dist, program: &str, error: &[String]) -> Result<(), BuildError> {
    let report = Report {
        report: REPORT.to_owned(),
        program: program.to_owned(),
        error: error.to_vec(),
        ..previous(dist).unwrap_or_default()
    };
    put_report(dist, &report)
}
