//! The common part of `htex device check` and `htex source check`.

use std::ffi::OsString;

use htex_check::device::{CheckedKind, Finding, Subject, check, run_one};

use crate::checking::CheckArgs;
use crate::devices::SettingArgs;
use crate::failure::{Exit, Failure};
use crate::output::print_json;

/// A device or source to be checked.
pub(crate) struct Checked<'a, A: CheckedKind + ?Sized> {
    /// A short name, an id or a library file.
    pub(crate) name: &'a str,
    pub(crate) subject: Subject<A>,
    /// The arguments that say where to find it, for another run of this program.
    pub(crate) places: Vec<OsString>,
    pub(crate) settings: &'a SettingArgs,
}

impl<A: CheckedKind + ?Sized> Checked<'_, A> {
    /// Runs all checks, or a single one in this process.
    pub(crate) fn run(self, checking: &CheckArgs) -> Result<Exit, Failure> {
        if let Some(name) = &checking.reproduce {
            return checking.print_one(name, &self.run_one(name)?);
        }
        // A wrong setting is reported once, and not by each check. The same holds for a wrong name,
        // which names nothing to check.
        self.settings.given()?;
        let (kind, adapter) = (A::WORD, self.name);
        let mut arguments = vec![kind.into(), "check-one".into()];
        arguments.extend(self.places);
        arguments.extend(self.settings.again());
        arguments.push(adapter.into());
        let report = check::<A>(adapter, &checking.runner(arguments)?);
        let again = |name: &str| format!("htex {kind} check {adapter} --reproduce {name}");
        checking.print_report(&report, again)
    }

    /// Runs one check and prints its finding as JSON.
    pub(crate) fn print_one(&self, name: &str) -> Result<Exit, Failure> {
        print_json(&self.run_one(name)?)?;
        Ok(Exit::SUCCESS)
    }

    fn run_one(&self, name: &str) -> Result<Finding, Failure> {
        let (profile, given) = (self.settings.profile(), self.settings.given()?);
        run_one(&self.subject, name, profile, &given)
            .map_err(|error| Failure::Usage(error.to_string()))
    }
}
