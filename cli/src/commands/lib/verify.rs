use std::path::{Path, PathBuf};

use clap::Args;
use htex_base::finding::Report;
use htex_format::library::Library;

use crate::commands::validate::show_reports;
use crate::failure::{Failure, Result, for_file};
use crate::findings_format::FindingsFormat;
use crate::located;
use crate::output::shown;

/// Check the index and every texture of one or more libraries; exit status 1 if a library is
/// invalid.
///
/// Each finding has a stable code (`htex explain CODE`).
#[derive(Args)]
pub(crate) struct Verify {
    /// The libraries to check
    #[arg(required = true, value_parser = located::RECORDING)]
    libraries: Vec<PathBuf>,

    /// Expected BLAKE3 hash of the library, as `htex lib info` prints it. If you have this hash
    /// from a place that you trust, it shows that the library is the published one
    #[arg(long, value_name = "HEX")]
    blake3: Option<String>,

    /// Print findings for continuous integration
    #[arg(long, value_enum, value_name = "FORMAT", conflicts_with = "json")]
    format: Option<FindingsFormat>,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Verify {
    pub(crate) fn run(self) -> Result {
        if let Some(expected) = self.blake3.as_deref().map(blake3).transpose()? {
            let [library] = &self.libraries[..] else {
                return Err(Failure::usage("--blake3 is of one library; name one"));
            };
            let opened = Library::open(library).map_err(for_file(library))?;
            let found = opened.index().blake3();
            if found != expected {
                return Err(Failure::Other(format!(
                    "{}: it has the BLAKE3 {}, so it is another library; get it again from a place that you trust",
                    shown(library),
                    blake3::Hash::from_bytes(found)
                )));
            }
        }
        let reports = self.libraries.iter().map(|path| Ok((path.as_path(), check(path)?)));
        show_reports(reports, self.json, self.format)
    }
}

fn blake3(text: &str) -> Result<[u8; 32]> {
    let hash = blake3::Hash::from_hex(text.trim());
    hash.map(|hash| *hash.as_bytes()).map_err(|_| {
        let problem = "give the 64 hexadecimal digits that `htex lib info` prints";
        Failure::Usage(format!("--blake3 {text}: {problem}"))
    })
}

/// Validates a library.
pub(crate) fn check(path: &Path) -> Result<Report> {
    htex_format::library::validate(path).map_err(for_file(path))
}
