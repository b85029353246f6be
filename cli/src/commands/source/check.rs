use clap::Args;
use htex_device::SourceAdapter;

use crate::adapter_checks::Checked;
use crate::checking::CheckArgs;
use crate::devices::SettingArgs;
use crate::failure::{Exit, Failure};
use crate::sources::SourceArgs;

/// Check that a source keeps every promise of the source ABI; exit status 1 if it does not.
///
/// Each check runs in its own process, so that a crash or an endless loop ends only that check.
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
    fn checked(&self) -> Result<Checked<'_, dyn SourceAdapter>, Failure> {
        Ok(Checked {
            name: &self.source,
            subject: self.sources.subject(&self.source)?,
            places: self.sources.again(),
            settings: &self.settings,
        })
    }
}

impl Check {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        self.which.checked()?.run(&self.checking)
    }
}

impl CheckOne {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        self.which.checked()?.print_one(&self.name)
    }
}
