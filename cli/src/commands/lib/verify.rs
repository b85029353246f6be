use std::path::{Path, PathBuf};

use clap::Args;
use htex_base::finding::Report;

use crate::commands::validate::show_reports;
use crate::failure::{Result, for_file};
use crate::located;

/// Check the index and every texture of one or more libraries; exit status 1 if a library is
/// invalid.
///
/// Each finding has a stable code (`htex explain CODE`).
#[derive(Args)]
pub(crate) struct Verify {
    /// The libraries to check
    #[arg(required = true, value_parser = located::RECORDING)]
    libraries: Vec<PathBuf>,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Verify {
    pub(crate) fn run(self) -> Result {
        let reports = self.libraries.iter().map(|path| Ok((path.as_path(), check(path)?)));
        show_reports(reports, self.json)
    }
}

/// Validates a library.
pub(crate) fn check(path: &Path) -> Result<Report> {
    htex_format::library::validate(path).map_err(for_file(path))
}
