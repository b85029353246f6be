//! Settings of a recording session, and their allowed values.

use std::path::PathBuf;

use htex_author::Exploration;
use htex_format::Quantity;

use crate::error::LabError;
use crate::record::coverage::Requirements;
use crate::record::files::{self, Format};

/// Longest take, seconds.
pub(crate) const LONGEST_S: f64 = 3600.0;

/// Settings of a recording session.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// Folder for the takes. It is created if it does not exist.
    pub folder: PathBuf,
    /// Name of the takes. The file name of each take contains this name.
    pub name: String,
    /// Length of a take, seconds; at most an hour.
    pub seconds: f64,
    /// Length of the countdown before each take, seconds. During this time the finger can start to
    /// follow the target.
    pub countdown_s: f64,
    /// When to measure the forces without a finger on the surface. The session computes their means
    /// over one second, and subtracts these means from the forces of the takes.
    pub tare: Tare,
    /// Quantity of the texture's signal.
    pub quantity: Quantity,
    /// Target speed and normal force.
    pub target: Exploration,
    /// Allowed relative difference from the target. It applies to the mean, the minimum and the
    /// maximum of the speed and of the force. In the paper (`docs/paper.md`), it is 0.1.
    pub tolerance: f64,
    /// Requirements that a take must meet to be accepted.
    pub required: Requirements,
    /// Largest number of takes that a session tries until one of them keeps to its target.
    pub attempts: u32,
    pub format: Format,
    /// Name and version of the program, for the JSON next to a recording.
    pub tool: String,
    /// The source as the user named it, for the JSON.
    pub source: String,
    /// The map of channels as the user gave it, for the JSON.
    pub map: Option<String>,
}

/// When the forces without a finger are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tare {
    #[default]
    Never,
    /// Before the first take.
    Once,
    /// Before each take. From the second take on, the user first gets time to lift the finger. This
    /// time is as long as the countdown.
    Each,
}

/// Returns an error if a value is out of range. `rate_hz` is the sample rate of the source.
pub(crate) fn check(setup: &Setup, rate_hz: f64) -> Result<(), LabError> {
    files::check_name(&setup.name)?;
    let refuse = |what, value: f64, allowed| {
        let value = value.to_string();
        Err(LabError::Setup { what, value, allowed })
    };
    let frames = setup.seconds * rate_hz;
    if !(setup.seconds <= LONGEST_S && frames.round() >= 2.0) {
        return refuse(
            "the length of a take",
            setup.seconds,
            "it is at least two samples and at most 3600 s",
        );
    }
    if !(0.0..=LONGEST_S).contains(&setup.countdown_s) {
        return refuse("the countdown", setup.countdown_s, "0 to 3600 s are allowed");
    }
    if !(setup.tolerance > 0.0 && setup.tolerance < 1.0) {
        return refuse(
            "the tolerance",
            setup.tolerance,
            "it is above 0 and below 1, as in 0.1 for 10 %",
        );
    }
    if !(0.0..=1.0).contains(&setup.required.on_target) {
        return refuse(
            "the share on target",
            setup.required.on_target,
            "it is 0 to 1, as in 0.5 for half of a take",
        );
    }
    let targets =
        [("the target speed", setup.target.speed_mm_s), ("the target force", setup.target.force_n)];
    for (what, target) in targets {
        if let Some(target) = target.filter(|target| !(*target > 0.0 && *target <= 1e4)) {
            return refuse(what, target, "it is above 0 and at most 10,000");
        }
    }
    setup.format.check(rate_hz)?;
    match setup.attempts {
        0 => refuse("the number of takes", 0.0, "at least one is needed"),
        _ => Ok(()),
    }
}
