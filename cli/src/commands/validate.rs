use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use htex_format::{Limits, Report, Severity, validate};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::recordings::RecordingArgs;
use crate::scenes::SceneArgs;

/// Check assets, scenes (*.json) and recordings; exit status 1 if one is not valid.
///
/// Each finding has a stable code (`htex explain CODE`), a severity and a JSON pointer into the
/// manifest, the scene or the recording. A file that is neither called *.htex or *.json nor begins as a
/// ZIP archive is looked at as a recording.
#[derive(Args)]
pub(crate) struct Validate {
    /// The assets, scenes and recordings
    #[arg(required = true)]
    files: Vec<PathBuf>,

    #[command(flatten)]
    reading: RecordingArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Validate {
    pub(crate) fn run(self) -> Result<ExitCode, Failure> {
        let mut all_valid = true;
        let mut answers: Vec<Value> = Vec::new();
        let kinds: Vec<Kind> = self.files.iter().map(|path| kind(path)).collect();
        if self.reading.is_given() && !kinds.contains(&Kind::Recording) {
            let sentence =
                "the options for reading recordings go with a recording, and none is given";
            return Err(Failure::Usage(sentence.to_owned()));
        }
        for (path, kind) in self.files.iter().zip(kinds) {
            let report = match kind {
                Kind::Asset => validate_asset(path),
                Kind::Scene => SceneArgs::validate(path),
                Kind::Recording => self.reading.validate(path),
            }?;
            let refused = self.reading.strict() && kind == Kind::Recording && !is_clean(&report);
            all_valid &= report.valid && !refused;
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

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Asset,
    Scene,
    Recording,
}

/// What a file is to be looked at as: by its name, else by its first bytes.
fn kind(path: &Path) -> Kind {
    let called = |name: &str| {
        path.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(name))
    };
    let mut first = [0; 2];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut first));
    match () {
        () if called("json") => Kind::Scene,
        () if called("htex") || read.is_ok() && first == *b"PK" => Kind::Asset,
        () => Kind::Recording,
    }
}

/// Whether nothing was found that `--strict` refuses.
fn is_clean(report: &Report) -> bool {
    report.findings.iter().all(|f| f.severity == Severity::Info)
}

/// Validates an asset; of one that is too large, no more is read than shows it.
fn validate_asset(path: &Path) -> Result<Report, Failure> {
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
