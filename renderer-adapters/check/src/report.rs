//! What all checks found.

use htex_check::{CheckReport, lines};
use serde::Serialize;

/// All checks of one device.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeviceReport {
    /// What was checked: a file or an id.
    pub device: String,
    /// Whether no check failed, crashed or timed out.
    pub ok: bool,
    /// Each check, in the order of the table.
    pub checks: Vec<CheckReport>,
}

impl DeviceReport {
    pub(crate) fn new(device: &str, checks: Vec<CheckReport>) -> Self {
        Self {
            device: device.to_owned(),
            ok: !checks.iter().any(|check| check.finding.outcome.is_bad()),
            checks,
        }
    }

    /// Names of the checks that failed, crashed or timed out.
    pub fn bad(&self) -> Vec<&'static str> {
        let bad = self.checks.iter().filter(|c| c.finding.outcome.is_bad());
        bad.map(|check| check.check).collect()
    }

    /// The report as a person reads it.
    pub fn to_text(&self) -> String {
        let mut text = format!("{}\n{}", self.device, lines(&self.checks));
        if let Some(first) = self.bad().first() {
            let device = &self.device;
            text +=
                &format!("again, in one process: htex device check {device} --reproduce {first}\n");
        }
        text
    }
}
