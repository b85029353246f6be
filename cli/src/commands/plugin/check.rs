use std::path::PathBuf;

use clap::Args;
use htex_check::{Options, check, run_one};

use crate::checking::CheckArgs;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::of_file::OrFail;
use crate::output::print_json;

/// Check that a model keeps every promise of the model ABI; exit status 1 if it does not.
///
/// Each check runs in a process of its own, so that a crash or an endless loop ends only that check.
/// `spec/model-checks.md` explains them.
#[derive(Args)]
pub(crate) struct Check {
    /// The model: a native library or a WASM module
    file: PathBuf,

    #[command(flatten)]
    checking: CheckArgs,

    /// Seed of the voices
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,

    /// Checks to run, comma-separated, with those that they need [default: all]
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "NAME,…",
        conflicts_with = "reproduce"
    )]
    only: Option<Vec<String>>,

    /// The same model as a file of the other kind [default: the one beside it, if there is one]
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
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
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let Self { file, seed, .. } = &self;
        if let Some(name) = &self.checking.reproduce {
            let finding = run_one(file, name, *seed, self.against.as_deref()).or_usage()?;
            return self.checking.print_one(name, &finding, |text| text.into());
        }
        let report = check(file, &self.options()?).or_usage()?;
        let again = |name: &str| {
            let file = file.display();
            format!("htex plugin check {file} --reproduce {name} --seed {seed}")
        };
        self.checking
            .print_report(&report, |text| text.into(), again)
    }

    fn options(&self) -> Result<Options, Failure> {
        Ok(Options {
            runner: self
                .checking
                .runner(["plugin".into(), "check-one".into()])?,
            seed: self.seed,
            only: self.only.clone(),
            against: self.against.clone(),
        })
    }
}

impl CheckOne {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let finding = run_one(&self.file, &self.name, self.seed, self.against.as_deref());
        print_json(&finding.or_usage()?)?;
        Ok(Exit::SUCCESS)
    }
}
