//! Exploration conditions: speed and normal force of the finger while the texture is recorded.

use htex_base::finding::Findings;

use crate::findings::{RECORDING_OFF_TARGET, RECORDING_UNSTEADY, quantile};
use crate::segments::Segments;
use crate::{AuthorError, Recording};
use htex_recording::Sums;

/// Allowed relative deviation of speed and force from their target. The paper discarded recordings
/// with a larger deviation and repeated them.
const TOLERANCE: f64 = 0.10;
/// A moving average of speed and force is compared with the target. This is half the length of the
/// average, seconds. Faster changes come from the texture, not from the hand.
const HALF_AVERAGE_S: f64 = 0.025;

/// Defines the findings of this module, for `spec/recording-findings.md`.
pub(crate) fn definition() -> String {
    format!(
        "- `RECORDING_OFF_TARGET` and `RECORDING_UNSTEADY`: speed and force are averaged over {} s. A segment is off its target if the average anywhere in it \
         differs from the target by more than {TOLERANCE} of that; if all are, the recording is unusable. Without a target the motion is unsteady if the average anywhere in the segments differs from the median of \
         the samples in the segments by more than {TOLERANCE} of that.\n",
        2.0 * HALF_AVERAGE_S
    )
}

/// An exploration condition: speed and force of the finger. An unknown value is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Exploration {
    /// Scanning speed, mm/s.
    pub speed_mm_s: Option<f64>,
    /// Normal force, newtons.
    pub force_n: Option<f64>,
}

impl Exploration {
    /// Largest allowed speed, mm/s.
    pub const MOST_SPEED_MM_S: f64 = 1e4;
    /// Largest allowed force, newtons.
    pub const MOST_FORCE_N: f64 = 100.0;

    /// Checks the ranges of the known values.
    ///
    /// # Errors
    /// Returns an error if a speed or force is negative, not finite, or above 10 m/s or 100 N.
    pub fn check(&self) -> Result<(), AuthorError> {
        let bad = |value: Option<f64>, max: f64| value.filter(|v| !(0.0..=max).contains(v));
        if let Some(value) = bad(self.speed_mm_s, Self::MOST_SPEED_MM_S) {
            return Err(AuthorError::Condition {
                what: "scanning speed",
                value,
                allowed: "0 to 10,000 mm/s is allowed",
            });
        }
        match bad(self.force_n, Self::MOST_FORCE_N) {
            None => Ok(()),
            Some(value) => Err(AuthorError::Condition {
                what: "normal force",
                value,
                allowed: "0 to 100 N is allowed",
            }),
        }
    }
}

/// Lowest and highest speed and force in the segments that are read, after a moving average of 50
/// ms. A range is `None` if the recording does not contain the signal from which the range is
/// computed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    /// Range of the scanning speed, mm/s.
    pub speed_mm_s: Option<[f64; 2]>,
    /// Range of the normal force, newtons.
    pub force_n: Option<[f64; 2]>,
}

/// A motion signal that the recording contains: its name, unit, samples and target.
pub(crate) struct MotionSignal<'a> {
    what: &'static str,
    signal: &'static str,
    unit: &'static str,
    values: &'a [f64],
    target: Option<f64>,
    average: Sums,
    half: usize,
}

/// Returns the recording's speed and normal force; `None` for a signal that it does not contain.
pub(crate) fn motion_signals(
    recording: &Recording,
    target: Exploration,
) -> [Option<MotionSignal<'_>>; 2] {
    let half = (HALF_AVERAGE_S * recording.rate_hz).round() as usize;
    let make = |what, signal, unit, values, target| MotionSignal {
        what,
        signal,
        unit,
        values,
        target,
        average: Sums::new(values.iter().copied()),
        half,
    };
    let (speed, force) = (recording.speed_mm_s.as_deref(), recording.normal_n.as_deref());
    [
        speed.map(|values| make("scanning speed", "speed", "mm/s", values, target.speed_mm_s)),
        force.map(|values| make("normal force", "normal", "N", values, target.force_n)),
    ]
}

impl MotionSignal<'_> {
    /// Returns the lowest and the highest of the averages within a segment.
    fn range(&self, start: usize, len: usize) -> [f64; 2] {
        let averages = (start..start + len).map(|at| self.average.mean_around(at, self.half));
        averages.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        })
    }

    /// Returns the mean over a segment, but only if no average differs from this mean by more than
    /// the fraction `part`.
    pub(crate) fn steady_mean(&self, start: usize, len: usize, part: f64) -> Option<f64> {
        let mean = self.average.mean(start, start + len);
        is_near(mean, part, self.range(start, len)).then_some(mean)
    }

    fn spread(&self, segments: &Segments) -> [f64; 2] {
        let ranges = segments.starts.iter().map(|&start| self.range(start, segments.len));
        ranges.fold([f64::INFINITY, f64::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// Returns the median over the samples of all segments. A few outliers do not change the
    /// median.
    fn median(&self, segments: &Segments) -> Option<f64> {
        let (starts, len) = (&segments.starts, segments.len);
        quantile(0.5, starts.len() * len, |at| self.values[starts[at / len] + at % len])
    }

    /// Returns whether a segment stays within the tolerance of the target. Without a target,
    /// returns true.
    fn is_on_target(&self, start: usize, len: usize) -> bool {
        self.target.is_none_or(|target| is_near(target, TOLERANCE, self.range(start, len)))
    }

    /// Returns the target, or else the median. If there is no target, and the motion differs from
    /// the median by more than 10 %, adds a finding.
    fn value(&self, segments: &Segments, findings: &mut Findings) -> Option<f64> {
        if self.target.is_some() {
            return self.target;
        }
        let median = self.median(segments)?;
        let [low, high] = self.spread(segments);
        if !is_near(median, TOLERANCE, [low, high]) {
            let (what, unit) = (self.what, self.unit);
            findings.add(RECORDING_UNSTEADY, format!("/{}", self.signal), format!(
                "the {what} differs from its median of {median:.4} {unit} by more than 10 %: from {low:.4} to {high:.4} {unit}; \
                 choose a steady part, or give a target"
            ));
        }
        Some(median)
    }

    /// If the signal has a target, returns a text that compares it with the signal's median and
    /// range over the segments.
    fn comparison(&self, segments: &Segments) -> Option<String> {
        let (target, median) = (self.target?, self.median(segments)?);
        let ([low, high], unit) = (self.spread(segments), self.unit);
        Some(format!(
            "the {} is {median:.4} {unit} (median, from {low:.4} to {high:.4}) and its target is {target} {unit}",
            self.what
        ))
    }
}

/// Whether a range stays within the fraction `part` of a value.
fn is_near(value: f64, part: f64, range: [f64; 2]) -> bool {
    range.iter().all(|end| (end - value).abs() <= part * value.abs())
}

/// The segments in which a recording is read, and the finger's motion in them.
pub(crate) struct SegmentMotion {
    pub(crate) segments: Segments,
    /// Speed and force: the targets, or else the medians of the measured signals.
    pub(crate) motion: Exploration,
    pub(crate) spread: Spread,
    /// The finding that some segments are left out, because they are off their target.
    pub(crate) off_target: Findings,
    /// The findings that the motion differs from its median by more than 10 %.
    pub(crate) unsteady: Findings,
}

impl SegmentMotion {
    /// Leaves out the segments in which the speed or force differs from its target by more than 10
    /// %. Measures the motion in the remaining segments.
    ///
    /// # Errors
    /// Returns an error if the target or a measured value is out of range, or if no segment
    /// remains.
    pub(crate) fn new(
        recording: &Recording,
        all: Segments,
        target: Exploration,
    ) -> Result<Self, AuthorError> {
        target.check()?;
        let signals = motion_signals(recording, target);
        let mut off_target = Findings::default();
        let segments = on_target(&recording.source, all, &signals, &mut off_target)?;
        let (mut motion, mut spread) = (target, Spread::default());
        let mut unsteady = Findings::default();
        let [speed, force] = signals;
        if let Some(speed) = speed {
            spread.speed_mm_s = Some(speed.spread(&segments));
            motion.speed_mm_s = speed.value(&segments, &mut unsteady);
        }
        if let Some(force) = force {
            spread.force_n = Some(force.spread(&segments));
            motion.force_n = force.value(&segments, &mut unsteady);
        }
        motion.check()?;
        Ok(Self { segments, motion, spread, off_target, unsteady })
    }
}

/// Leaves out the segments that are off their target.
fn on_target(
    source: &str,
    mut segments: Segments,
    signals: &[Option<MotionSignal<'_>>; 2],
    findings: &mut Findings,
) -> Result<Segments, AuthorError> {
    let signals = || signals.iter().flatten();
    let is_on_target =
        |start: &usize| signals().all(|signal| signal.is_on_target(*start, segments.len));
    let (kept, off): (Vec<usize>, Vec<usize>) =
        segments.starts.iter().copied().partition(is_on_target);
    if off.is_empty() {
        return Ok(segments);
    }
    // Messages compare the target with all segments, and not only with the remaining ones.
    let compared = signals().filter_map(|signal| signal.comparison(&segments));
    let comparison = compared.collect::<Vec<_>>().join("; ");
    if kept.is_empty() {
        return Err(AuthorError::OffTarget {
            source_name: source.to_owned(),
            segments: off.len(),
            comparison,
        });
    }
    findings.add(
        RECORDING_OFF_TARGET,
        "",
        format!(
            "{} of {} segments left out because they differ from their target by more than 10 %: {comparison}",
            off.len(),
            segments.starts.len()
        ),
    );
    (segments.starts, segments.off_target) = (kept, off);
    Ok(segments)
}
