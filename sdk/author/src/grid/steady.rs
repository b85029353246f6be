//! The steady windows of a recording.

use htex_base::finding::{Finding, Notice};
use htex_dsp::Band;
use htex_format::Quantity;

use super::paths::Window;
use crate::exploration::{Known, known};
use crate::findings::recording_findings;
use crate::reading::{refuse, sentences};
use crate::segments::SegmentChoice;
use crate::spectrum::{Trend, spectra_of};
use crate::{AuthorError, Exploration, SpectrumOptions, Take};

/// Lowest mean speed at which the finger counts as sliding in a window, mm/s.
const SLOWEST_MM_S: f64 = 1.0;
/// Largest relative deviation of speed and force from their mean within a window: the paper's
/// tolerance for a condition.
const STEADY: f64 = 0.10;

/// The steady windows of one recording.
pub(super) struct Steady {
    pub(super) quantity: Quantity,
    pub(super) band: Band,
    pub(super) windows: Vec<Window>,
    /// Number of windows in the recording.
    pub(super) looked_at: usize,
    pub(super) warnings: Vec<Notice>,
    pub(super) notes: Vec<Notice>,
    pub(super) findings: Vec<Finding>,
}

/// Finds the half-overlapping windows of 0.2 s in which speed and force stay within 10 % of their
/// means, and checks the recording as a plain fit does. A linear trend is removed from each window,
/// because in a free motion the friction itself rises and falls with the force.
pub(super) fn read_steady(
    index: usize,
    take: &Take,
    options: &SpectrumOptions,
    strict: bool,
) -> Result<Steady, AuthorError> {
    let recording = &take.recording;
    take.given.check()?;
    let axes = motion_axes(take)?;
    let (mut steady, mut looked_at) = (Vec::new(), 0);
    let windows = options.clone().with_segments(SegmentChoice::Windows);
    let part = spectra_of(recording, &windows, Trend::Linear, |segments| {
        looked_at = segments.starts.len();
        let len = segments.len;
        segments.starts.retain(|&start| {
            let motion = steady_motion(&axes, start, len);
            steady.extend(motion.map(|motion| Window { take: index, start, len, motion }));
            motion.is_some()
        });
        if segments.starts.is_empty() && looked_at > 0 {
            return Err(AuthorError::NothingSteady {
                source_name: recording.source.clone(),
                windows: looked_at,
            });
        }
        Ok(())
    })?;
    let findings: Vec<Finding> = recording_findings(recording);
    if strict {
        refuse(&recording.source, &findings)?;
    }
    let of_part = part.warnings.iter().cloned().map(Notice::from);
    let noticed = recording.warnings.iter().cloned().chain(of_part);
    let of = |info: bool| sentences(&recording.source, &findings, info);
    Ok(Steady {
        quantity: part.quantity,
        band: part.band,
        looked_at,
        warnings: noticed.chain(of(false)).collect(),
        notes: of(true).collect(),
        findings,
        windows: steady,
    })
}

/// Where a speed or a force comes from.
enum MotionAxis<'a> {
    Measured(Known<'a>),
    Given(f64),
}

impl<'a> MotionAxis<'a> {
    /// Returns the given value, or else the measured signal.
    fn of(given: Option<f64>, measured: Option<Known<'a>>) -> Option<Self> {
        given.map(MotionAxis::Given).or(measured.map(MotionAxis::Measured))
    }
}

/// Returns where speed and force come from.
fn motion_axes(take: &Take) -> Result<[MotionAxis<'_>; 2], AuthorError> {
    let [speed, force] = known(&take.recording, Exploration::default());
    let missing = |what, columns| AuthorError::NoMotion {
        source_name: take.recording.source.clone(),
        what,
        columns,
    };
    Ok([
        MotionAxis::of(take.given.speed_mm_s, speed)
            .ok_or_else(|| missing("speed", "a speed, or a position x and y"))?,
        MotionAxis::of(take.given.force_n, force)
            .ok_or_else(|| missing("normal force", "a normal force"))?,
    ])
}

/// Returns the logarithms of the mean speed and force over a window, if both are steady.
fn steady_motion(axes: &[MotionAxis<'_>; 2], start: usize, len: usize) -> Option<[f64; 2]> {
    let [speed, force] = axes.each_ref().map(|axis| match axis {
        MotionAxis::Given(value) => Some(*value),
        MotionAxis::Measured(known) => known.steady_mean(start, len, STEADY),
    });
    let (speed, force) = (speed?, force?);
    // The logarithms need both above 0.
    (speed >= SLOWEST_MM_S && force > 0.0).then(|| [libm::log(speed), libm::log(force)])
}
