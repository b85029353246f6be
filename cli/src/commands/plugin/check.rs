use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Args;
use htex_check::{Finding, Options, Runner, check, run_one};

use crate::failure::Failure;
use crate::output::{print, print_json};

/// Check that a model keeps every promise of the model ABI; exit status 1 if it does not.
///
/// Each check runs in a process of its own, so that a crash or an endless loop is an answer too.
/// `spec/model-checks.md` explains them.
#[derive(Args)]
pub(crate) struct Check {
    /// The model: a native library or a WASM module
    file: PathBuf,

    /// Print JSON
    #[arg(long)]
    json: bool,

    /// Seed of the voices
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,

    /// How long one check may take, s
    #[arg(long, default_value_t = 60.0, value_name = "S")]
    timeout: f64,

    /// Checks to run, comma-separated, with those that they need [default: all]
    #[arg(long, value_delimiter = ',', value_name = "NAME,…")]
    only: Option<Vec<String>>,

    /// The same model as a file of the other kind [default: the one beside it, if there is one]
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,

    /// Run this one check in a single process, e.g. under a debugger
    #[arg(long, value_name = "NAME", conflicts_with_all = ["only", "timeout"])]
    reproduce: Option<String>,
}

/// Run one check and print its finding as JSON: what `check` starts.
#[derive(Args)]
pub(crate) struct CheckOne {
    file: PathBuf,
    name: String,
    #[arg(long)]
    seed: u64,
    #[arg(long)]
    against: Option<PathBuf>,
}

impl Check {
    pub(crate) fn run(self) -> Result<ExitCode, Failure> {
        if let Some(name) = &self.reproduce {
            let finding = run_one(&self.file, name, self.seed, self.against.as_deref());
            return self.tell_one(name, &finding.map_err(Failure::Usage)?);
        }
        let report = check(&self.file, &self.options()?).map_err(Failure::Usage)?;
        if self.json {
            print_json(&report)?;
        } else {
            print(&report.to_text())?;
        }
        Ok(exit_code(!report.ok))
    }

    fn tell_one(&self, name: &str, finding: &Finding) -> Result<ExitCode, Failure> {
        if self.json {
            print_json(finding)?;
        } else {
            let word = finding.outcome.word();
            print(&format!("{name}: {word}: {}\n", finding.message))?;
        }
        Ok(exit_code(finding.outcome.is_bad()))
    }

    fn options(&self) -> Result<Options, Failure> {
        let timeout = Duration::try_from_secs_f64(self.timeout)
            .ok()
            .filter(|timeout| !timeout.is_zero() && timeout.as_secs() < 1_000_000);
        let timeout = timeout.ok_or_else(|| {
            Failure::Usage(format!("--timeout {}: seconds, more than 0", self.timeout))
        })?;
        let program = std::env::current_exe()
            .map_err(|error| Failure::Other(format!("cannot find this program: {error}")))?;
        Ok(Options {
            runner: Runner {
                program,
                arguments: vec!["plugin".into(), "check-one".into()],
            },
            seed: self.seed,
            timeout,
            only: self.only.clone(),
            against: self.against.clone(),
        })
    }
}

impl CheckOne {
    pub(crate) fn run(self) -> Result<ExitCode, Failure> {
        let finding = run_one(&self.file, &self.name, self.seed, self.against.as_deref());
        print_json(&finding.map_err(Failure::Usage)?)?;
        Ok(ExitCode::SUCCESS)
    }
}

fn exit_code(bad: bool) -> ExitCode {
    if bad {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}
