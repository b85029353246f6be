//! The steady windows of a recording.

use htex_base::finding::{Finding, Notice};
use htex_dsp::Band;

use super::paths::Window;
use crate::exploration::{MotionSignal, motion_signals};
use crate::findings::recording_findings;
use crate::segments::{SegmentChoice, choose_segments};
use crate::spectrum::CheckedBand;
use crate::take::notices;
use crate::{AuthorError, Exploration, SetupResponse, Take};

/// Lowest mean speed at which the finger counts as sliding in a window, mm/s.
const SLOWEST_MM_S: f64 = 1.0;
/// Largest relative deviation of speed and force from their mean within a window: the paper's
/// tolerance for a condition.
const STEADY: f64 = 0.10;

/// The steady windows of one recording.
pub(super) struct SteadyWindows {
    pub(super) band: Band,
    pub(super) windows: Vec<Window>,
    /// Number of windows in the recording.
    pub(super) looked_at: usize,
    /// Warnings and notes.
    pub(super) notices: [Vec<Notice>; 2],
    pub(super) findings: Vec<Finding>,
}

/// Cuts a recording into half-overlapping windows of 0.2 s, and finds the windows in which speed
/// and force stay within 10 % of their means. Also checks the recording, as a fit without a grid
/// does.
pub(super) fn read_steady(
    index: usize,
    take: &Take,
    response: Option<&SetupResponse>,
    strict: bool,
) -> Result<SteadyWindows, AuthorError> {
    let recording = &take.recording;
    take.given.check()?;
    let axes = motion_axes(take)?;
    let mut segments = choose_segments(recording, SegmentChoice::Windows);
    let (looked_at, len) = (segments.starts.len(), segments.len);
    let mut windows = Vec::new();
    segments.starts.retain(|&start| {
        let motion = steady_motion(&axes, start, len);
        windows.extend(motion.map(|motion| Window { take: index, start, len, motion }));
        motion.is_some()
    });
    if segments.starts.is_empty() && looked_at > 0 {
        let source_name = recording.source.clone();
        return Err(AuthorError::NothingSteady { source_name, windows: looked_at });
    }
    let CheckedBand { band, warnings, .. } = CheckedBand::new(recording, &segments, response)?;
    let findings = recording_findings(recording);
    let notices = notices(recording, &warnings, &findings, strict)?;
    Ok(SteadyWindows { band, windows, looked_at, notices, findings })
}

/// Where a speed or a force comes from.
enum MotionAxis<'a> {
    Measured(MotionSignal<'a>),
    Given(f64),
}

/// Returns where speed and force come from: the given value, or else the measured signal.
fn motion_axes(take: &Take) -> Result<[MotionAxis<'_>; 2], AuthorError> {
    let [speed, force] = motion_signals(&take.recording, Exploration::default());
    let axis = |given: Option<f64>, measured: Option<_>, what, columns| {
        let axis = given.map(MotionAxis::Given).or(measured.map(MotionAxis::Measured));
        axis.ok_or_else(|| {
            let source_name = take.recording.source.clone();
            AuthorError::NoMotion { source_name, what, columns }
        })
    };
    Ok([
        axis(take.given.speed_mm_s, speed, "speed", "a speed, or a position x and y")?,
        axis(take.given.force_n, force, "normal force", "a normal force")?,
    ])
}

/// Returns the logarithms of the mean speed and force over a window, if both are steady.
fn steady_motion(axes: &[MotionAxis<'_>; 2], start: usize, len: usize) -> Option<[f64; 2]> {
    let [speed, force] = axes.each_ref().map(|axis| match axis {
        MotionAxis::Given(value) => Some(*value),
        MotionAxis::Measured(signal) => signal.steady_mean(start, len, STEADY),
    });
    let (speed, force) = (speed?, force?);
    // Speed and force must be above 0, because their logarithms are computed.
    (speed >= SLOWEST_MM_S && force > 0.0).then(|| [libm::log(speed), libm::log(force)])
}
