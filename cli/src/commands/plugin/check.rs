use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use htex_check::{Options, Runner, check, run_one};

use crate::checking::{exit_code, tell_one, this_program, timeout};
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
            return tell_one(name, &finding.map_err(Failure::Usage)?, self.json);
        }
        let report = check(&self.file, &self.options()?).map_err(Failure::Usage)?;
        if self.json {
            print_json(&report)?;
        } else {
            print(&report.to_text())?;
        }
        Ok(exit_code(!report.ok))
    }

    fn options(&self) -> Result<Options, Failure> {
        Ok(Options {
            runner: Runner {
                program: this_program()?,
                arguments: vec!["plugin".into(), "check-one".into()],
            },
            seed: self.seed,
            timeout: timeout(self.timeout)?,
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
