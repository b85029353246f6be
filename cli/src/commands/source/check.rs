use clap::Args;
use htex_device_check::source::{check, run_one};
use htex_device_check::{Finding, Runner};

use crate::checking::CheckArgs;
use crate::devices::SettingArgs;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::hints::with_quoted;
use crate::output::print_json;
use crate::sources::SourceArgs;

/// Check that a source keeps every promise of the source ABI; exit status 1 if it does not.
///
/// Each check runs in a process of its own, so that a crash or an endless loop ends only that check.
#[derive(Args)]
pub(crate) struct Check {
    #[command(flatten)]
    which: Which,

    #[command(flatten)]
    checking: CheckArgs,
}

/// Run one check and print its finding as JSON: what `check` starts.
#[derive(Args)]
pub(crate) struct CheckOne {
    #[command(flatten)]
    which: Which,
    name: String,
}

/// A source, and how it is set.
#[derive(Args)]
struct Which {
    /// The source, by short name, id or library file
    #[arg(value_name = "FILE|ID")]
    source: String,

    #[command(flatten)]
    sources: SourceArgs,

    #[command(flatten)]
    settings: SettingArgs,
}

impl Which {
    fn run_one(&self, name: &str) -> Result<Finding, Failure> {
        let subject = self.sources.subject(&self.source)?;
        let given = self.settings.given()?;
        run_one(&subject, name, self.settings.profile(), &given)
            .map_err(|error| Failure::Usage(error.to_string()))
    }
}

impl Check {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        if let Some(name) = &self.checking.reproduce {
            let finding = self.which.run_one(name)?;
            return self.checking.print_one(name, &finding, with_quoted);
        }
        // A wrong name is reported once, not by each check.
        self.which.sources.subject(&self.which.source)?;
        self.which.settings.given()?;
        let source = &self.which.source;
        let report = check(source, &self.runner()?);
        let again = |name: &str| format!("htex source check {source} --reproduce {name}");
        self.checking.print_report(&report, with_quoted, again)
    }

    fn runner(&self) -> Result<Runner, Failure> {
        let mut arguments = vec!["source".into(), "check-one".into()];
        arguments.extend(self.which.sources.again());
        arguments.extend(self.which.settings.again());
        arguments.push(self.which.source.clone().into());
        self.checking.runner(arguments)
    }
}

impl CheckOne {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        print_json(&self.which.run_one(&self.name)?)?;
        Ok(Exit::SUCCESS)
    }
}
