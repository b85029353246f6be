use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use htex_format::{Limits, Report, Severity, validate};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::scenes::SceneArgs;

/// Check assets and scenes (*.json) against their formats; exit status 1 if one is not valid.
///
/// Each finding has a stable code (`htex explain CODE`), a severity and a JSON pointer into the
/// manifest or the scene.
#[derive(Args)]
pub(crate) struct Validate {
    /// The assets and scenes
    #[arg(required = true)]
    assets: Vec<PathBuf>,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Validate {
    pub(crate) fn run(self) -> Result<ExitCode, Failure> {
        let mut all_valid = true;
        let mut answers: Vec<Value> = Vec::new();
        for path in &self.assets {
            let report = validate_file(path)?;
            all_valid &= report.valid;
            if self.json {
                answers.push(json!({
                    "file": path.display().to_string(),
                    "valid": report.valid,
                    "findings": report.findings,
                }));
            } else {
                print(&text(path, &report))?;
            }
        }
        if self.json {
            print_json(&answers)?;
        }
        Ok(if all_valid {
            ExitCode::SUCCESS
        } else {
            ExitCode::FAILURE
        })
    }
}

/// Validates a file; of one that is too large, no more is read than shows it.
fn validate_file(path: &Path) -> Result<Report, Failure> {
    if path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("json"))
    {
        return SceneArgs::validate(path);
    }
    let limits = Limits::default();
    let mut bytes = Vec::new();
    let read =
        File::open(path).and_then(|file| file.take(limits.file_bytes + 1).read_to_end(&mut bytes));
    match read {
        Ok(_) => Ok(validate(&bytes, &limits)),
        Err(error) => Err(Failure::Other(format!("{}: {error}", path.display()))),
    }
}

fn text(path: &Path, report: &Report) -> String {
    let verdict = if report.valid { "valid" } else { "NOT VALID" };
    let mut text = format!("{}: {verdict}\n", path.display());
    for finding in &report.findings {
        let severity = match finding.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Info => "info",
        };
        let place = if finding.pointer.is_empty() {
            ""
        } else {
            " at "
        };
        text += &format!(
            "  {severity} {}{place}{}: {}\n",
            finding.code,
            htex_format::plain(&finding.pointer),
            finding.message
        );
    }
    text
}
