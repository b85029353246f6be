//! The report of a build that failed: the error, beside what an earlier build left in the folder.
//! Who reads reports alone, such as a page of continuous integration, sees it, and the next build
//! still knows which files are its own.

use std::path::Path;

use crate::BuildError;
use crate::assemble::{previous, put_report};
use crate::dist::Dist;
use crate::kept::{KEPT, Kept};
use crate::report::{LibraryReport, REPORT, Report};

/// Writes an error, line by line, into the report of a folder in which a build has begun. Returns
/// whether it was written: it is not where none has begun, or while another one uses the folder.
///
/// # Errors
/// When the report cannot be written.
pub fn report_failure(output: &Path, program: &str, error: &[String]) -> Result<bool, BuildError> {
    let dist = Dist::new(output);
    let is_folder = |path: &Path| path.symlink_metadata().is_ok_and(|at| at.is_dir());
    if !dist.at(Path::new(KEPT)).is_ok_and(|kept| is_folder(&kept)) {
        return Ok(false);
    }
    let _lock = match Kept::new(output)?.claim() {
        Err(BuildError::Locked { .. }) => return Ok(false),
        lock => lock?,
    };
    put_failure(&dist, program, error)?;
    Ok(true)
}

/// The same, by who holds the folder's lock.
pub(crate) fn put_failure(dist: &Dist, program: &str, error: &[String]) -> Result<(), BuildError> {
    let report = Report {
        report: REPORT.to_owned(),
        program: program.to_owned(),
        error: error.to_vec(),
        ..previous(dist).unwrap_or_else(of_nothing)
    };
    put_report(dist, &report)
}

/// The report of a folder without a library.
fn of_nothing() -> Report {
    Report {
        report: String::new(),
        program: String::new(),
        error: Vec::new(),
        library: LibraryReport {
            name: String::new(),
            file: String::new(),
            bytes: 0,
            blake3: String::new(),
            textures: 0,
            left_out: 0,
        },
        removed: Vec::new(),
        felt_shares: Default::default(),
        findings: Default::default(),
        textures: Vec::new(),
    }
}
