//! The device or source under test, and how its checks run.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use crate::harness::{Check, Finding, Owner, Runner, UnknownCheck, run_all};
use htex_device::{AbiFault, Adapter, AdapterKind, DeviceError, Native, Setting, Settings};

use crate::device::report::{AdapterName, Report};

/// A kind of adapter that can be checked: for devices or for sources.
pub trait CheckedKind: CaseKind {
    /// The checks, in the order in which they run.
    const CHECKS: &'static [Check<Case<Self>>];
}

/// The part of a case that depends on its kind.
pub trait CaseKind: AdapterKind {
    /// The files that the checks write.
    type Files;

    /// Creates a place for these files.
    ///
    /// # Errors
    /// When it cannot be created.
    fn files() -> Result<Self::Files, DeviceError>;
}

/// The device or source under test.
#[derive(Clone)]
pub enum Subject<A: ?Sized = dyn Adapter> {
    /// A native library.
    Library(PathBuf),
    /// An adapter that is built into this program.
    Builtin(Arc<A>),
}

/// A loaded adapter and its settings.
pub struct Case<A: CaseKind + ?Sized> {
    pub(crate) adapter: Arc<A>,
    /// The same adapter, if it is a native library.
    native: Option<Native<A::Table>>,
    profile: Option<String>,
    given: BTreeMap<String, String>,
    pub(crate) files: A::Files,
}

/// Runs all checks of an adapter, given by its file or id, each check in its own process. `runner`
/// is a program that calls [`run_one`]. Its arguments are the ones it was given, which name the
/// adapter and its settings, followed by the name of the check.
pub fn check<A: CheckedKind + ?Sized>(adapter: &str, runner: &Runner) -> Report {
    let checks = run_all(A::CHECKS, runner, |command, name| {
        command.arg(name);
    });
    let subject = AdapterName { kind: A::WORD, name: adapter.to_owned() };
    Report::new(subject, checks)
}

/// Runs one check in this process. A crash ends the process.
///
/// # Errors
/// When no check has this name.
pub fn run_one<A: CheckedKind + ?Sized>(
    subject: &Subject<A>,
    name: &str,
    profile: Option<&str>,
    given: &BTreeMap<String, String>,
) -> Result<Finding, UnknownCheck> {
    let load = || Case::load(subject, profile, given);
    crate::harness::run_one(A::CHECKS, name, load, owner)
}

/// Returns the check to which a loading error belongs.
fn owner(error: &DeviceError) -> Owner {
    let DeviceError::Abi { fault, .. } = error else {
        return Owner::not_reached("exports");
    };
    match fault {
        AbiFault::Marker { .. } => Owner::reached("marker"),
        AbiFault::Descriptor(_) => Owner::reached("descriptor"),
        AbiFault::Symbol { symbol, .. } if symbol.ends_with("_abi_version") => {
            Owner::reached("marker")
        }
        AbiFault::Symbol { .. } => Owner::reached("exports"),
        // A file that cannot be loaded has no marker to check.
        _ => Owner::not_reached("exports"),
    }
}

impl<A: CaseKind + ?Sized> Case<A> {
    fn load(
        subject: &Subject<A>,
        profile: Option<&str>,
        given: &BTreeMap<String, String>,
    ) -> Result<Self, DeviceError> {
        let (adapter, native) = match subject {
            Subject::Builtin(adapter) => (adapter.clone(), None),
            Subject::Library(path) => {
                let native = Native::load(path)?;
                (A::of_native(native.clone()), Some(native))
            }
        };
        Ok(Self {
            adapter,
            native,
            profile: profile.map(str::to_owned),
            given: given.clone(),
            files: A::files()?,
        })
    }

    /// Returns the adapter's library. For a built-in adapter, the check is skipped.
    pub(crate) fn native(&self) -> Result<&Native<A::Table>, Finding> {
        let built_in = || Finding::skipped("it is built in and has no library");
        self.native.as_ref().ok_or_else(built_in)
    }

    pub(crate) fn profile(&self) -> Option<&str> {
        self.profile.as_deref()
    }

    /// Returns the given settings. `value` provides required settings that are missing.
    pub(crate) fn filled(
        &self,
        profile: Option<&str>,
        value: impl Fn(&Setting) -> Option<String>,
    ) -> Result<Settings, Finding> {
        let descriptor = self.adapter.about();
        let mut given = self.given.clone();
        let fixed = descriptor.profiles.iter().find(|p| Some(&p.name[..]) == profile);
        for setting in descriptor.settings.iter().filter(|s| s.default.is_none()) {
            let name = &setting.name;
            if given.contains_key(name) || fixed.is_some_and(|p| p.settings.contains_key(name)) {
                continue;
            }
            let missing = || Finding::skipped(format!("give `--set {name}=…`"));
            given.insert(name.clone(), value(setting).ok_or_else(missing)?);
        }
        Ok(Settings::resolve(descriptor, profile, &given)?)
    }

    /// Returns the first endpoint that belongs to this setting.
    pub(crate) fn first_endpoint(&self, setting: &str) -> Option<String> {
        // Errors of listing are the subject of another check.
        let all = self.adapter.connected().unwrap_or_default();
        let first = all.into_iter().find(|endpoint| endpoint.setting == setting);
        first.map(|endpoint| endpoint.name)
    }
}

/// Converts an error to a finding. If a driver or the hardware is missing, the check is skipped.
pub(crate) fn skip_missing(error: DeviceError) -> Finding {
    match error {
        DeviceError::Missing(what) => Finding::skipped(what),
        error => error.into(),
    }
}
