//! Tables of checks.

use htex_device::Direction;

use crate::harness::{CheckError, CheckResult};

/// One check. `Case` is a loaded model or device with the checker's settings.
pub struct Check<Case> {
    /// Stable name, unique in its table.
    pub name: &'static str,
    /// The guarantee, in one sentence.
    pub summary: &'static str,
    /// The test method with its tolerances; empty if the summary is sufficient.
    pub method: &'static str,
    /// The direction of devices (output or input) to which the check is limited. If empty, the
    /// check applies to both directions.
    pub only: &'static [Direction],
    /// Names of the checks that this check needs. The result of this check is meaningful only if
    /// the named checks do not fail.
    pub needs: &'static [&'static str],
    pub run: fn(&Case) -> CheckResult,
}

/// Defines `CHECKS`, a table of [`Check`]s in the order in which they run. A check must come after
/// the checks that it needs. A row has the form `"name" needs ["name", …] path::of::function:
/// "summary", "method";`. The method is optional. If a check applies only to devices of one
/// direction, its row begins with `"name" for Output needs …`.
#[macro_export]
macro_rules! checks {
    ($case:ty; $($name:literal $(for $direction:ident)? needs [$($need:literal),*] $run:path: $summary:literal $(, $method:literal)?;)*) => {
        /// All checks, in the order in which they run. A check comes after the checks that it
        /// needs.
        pub const CHECKS: &[$crate::harness::Check<$case>] = &[$($crate::harness::Check {
            name: $name,
            summary: $summary,
            method: concat!($($method)?),
            only: &[$($crate::device::Direction::$direction)?],
            needs: &[$($need),*],
            run: $run,
        }),*];
    };
}

pub(crate) fn find<'a, Case>(
    checks: &'a [Check<Case>],
    name: &str,
) -> Result<&'a Check<Case>, CheckError> {
    let found = checks.iter().find(|check| check.name == name);
    found.ok_or_else(|| CheckError::Unknown {
        name: name.to_owned(),
        known: checks.iter().map(|check| check.name).collect(),
    })
}

/// Returns the checks with these names and all checks that they need, in the table's order.
///
/// # Errors
/// When a name is not in the table.
pub(crate) fn select<'a, Case>(
    checks: &'a [Check<Case>],
    names: &[String],
) -> Result<Vec<&'a Check<Case>>, CheckError> {
    let mut chosen = Vec::new();
    let mut open: Vec<&str> = names.iter().map(String::as_str).collect();
    while let Some(name) = open.pop() {
        let check = find(checks, name)?;
        if !chosen.contains(&check.name) {
            chosen.push(check.name);
            open.extend(check.needs);
        }
    }
    let is_chosen = |check: &&Check<Case>| chosen.contains(&check.name);
    Ok(checks.iter().filter(is_chosen).collect())
}
