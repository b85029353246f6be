use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use htex_base::files::FileError;
use htex_check::model::{CheckError, Options, Report, Settings, check, run_one};

use crate::checking::CheckArgs;
use crate::failure::{Exit, Failure, Result};
use crate::output::{command_line, print_json};

/// Check a model against the rules of the model ABI; exit status 1 if the model breaks a rule.
///
/// Each check runs in its own process, so that a crash or an endless loop ends only that check.
/// `spec/model-checks.md` explains the checks.
#[derive(Args)]
pub(crate) struct Check {
    /// The model: a native library or a WASM module
    file: PathBuf,

    #[command(flatten)]
    checking: CheckArgs,

    /// Seed of the model's random numbers, of random parameters, and of the first sequence of calls
    /// in the check `fuzz`
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,

    /// Run the check `fuzz` for this many seconds. The check makes random sequences of calls
    /// [default: 16 sequences]
    #[arg(long, value_name = "SECONDS", value_parser = fuzz_time)]
    fuzz: Option<Duration>,

    /// Names of checks to run, comma-separated. If a check depends on other checks, these also run
    /// [default: all]
    #[arg(long, value_delimiter = ',', value_name = "NAME,…", conflicts_with = "reproduce")]
    only: Option<Vec<String>>,

    /// Compare the model with this file: an older version of it, whose assets it must still play
    /// (check `successor`), or the same version as a native library or as a WASM module (check
    /// `twin`) [default: a file of the other kind next to the model, if there is one]
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
}

/// Run one check and print its finding as JSON (internal; `check` starts it).
#[derive(Args)]
pub(crate) struct CheckOne {
    file: PathBuf,
    name: String,
    #[arg(long)]
    seed: u64,
    #[arg(long)]
    against: Option<PathBuf>,
    #[arg(long, value_parser = fuzz_time)]
    fuzz: Option<Duration>,
}

/// Parses a duration of at most a week.
fn fuzz_time(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| "seconds are a number")?;
    if (0.0..=604_800.0).contains(&seconds) {
        Ok(Duration::from_secs_f64(seconds))
    } else {
        Err("0 to 604800 seconds".to_owned())
    }
}

/// Converts an error: to a reading error if a file cannot be read, otherwise to a usage error, e.g.
/// for an unknown check.
fn failed(error: CheckError) -> Failure {
    match error {
        CheckError::File { path, error } => FileError::reading(path, error).into(),
        other => Failure::Usage(other.to_string()),
    }
}

/// Returns the seed with which the check failed. If the check played sequences, this is the seed of
/// the failed sequence, else the seed of the run.
fn seed_of(report: &Report, name: &str) -> u64 {
    let failed = report.checks.iter().find(|check| check.check == name);
    let own = failed.and_then(|check| check.finding.numbers.get("seed"));
    own.map_or(report.subject.seed, |seed| *seed as u64)
}

impl Check {
    pub(crate) fn run(self) -> Result {
        let file = &self.file;
        if let Some(name) = &self.checking.reproduce {
            let settings =
                Settings { seed: self.seed, against: self.against.as_deref(), fuzz: self.fuzz };
            let finding = run_one(file, name, settings).map_err(failed)?;
            return self.checking.print_one(name, &finding);
        }
        let report = check(file, &self.options()?).map_err(failed)?;
        let again = |name: &str| {
            let seed = seed_of(&report, name).to_string();
            let mut arguments: Vec<OsString> = vec![file.into()];
            arguments.extend(["--reproduce", name, "--seed", &seed].map(OsString::from));
            if let Some(other) = &self.against {
                arguments.extend(["--against".into(), other.into()]);
            }
            format!("htex plugin check {}", command_line(&arguments))
        };
        self.checking.print_report(&report, again)
    }

    fn options(&self) -> Result<Options> {
        Ok(Options {
            runner: self.checking.runner(["plugin".into(), "check-one".into()])?,
            seed: self.seed,
            only: self.only.clone(),
            against: self.against.clone(),
            fuzz: self.fuzz,
        })
    }
}

impl CheckOne {
    pub(crate) fn run(self) -> Result {
        let settings =
            Settings { seed: self.seed, against: self.against.as_deref(), fuzz: self.fuzz };
        print_json(&run_one(&self.file, &self.name, settings).map_err(failed)?)?;
        Ok(Exit::SUCCESS)
    }
}
