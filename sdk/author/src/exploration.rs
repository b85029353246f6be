//! Exploration conditions: speed and normal force of the finger while the texture is recorded.

use htex_base::finding::Findings;

use crate::findings::{RECORDING_OFF_TARGET, RECORDING_UNSTEADY, quantile};
use crate::segments::Segments;
use crate::{AuthorError, Recording};
use htex_recording::Sums;

/// Allowed relative deviation of speed and force from their target (the paper discarded and
/// repeated recordings beyond it).
const TOLERANCE: f64 = 0.10;
/// Half the length of the moving average of speed and force that is compared with the target,
/// seconds. Faster changes come from the texture, not from the hand.
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
    /// When a speed or force is negative, not finite, or above 10 m/s or 100 N.
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

/// Lowest and highest speed and force over the segments that are read, averaged over 50 ms; `None`
/// if the signal is not known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    /// Range of the scanning speed, mm/s.
    pub speed_mm_s: Option<[f64; 2]>,
    /// Range of the normal force, newtons.
    pub force_n: Option<[f64; 2]>,
}

/// A motion signal that the recording contains: its name, unit, samples and target.
pub(crate) struct Known<'a> {
    what: &'static str,
    signal: &'static str,
    unit: &'static str,
    values: &'a [f64],
    target: Option<f64>,
    average: Sums,
    half: usize,
}

/// Returns the recording's speed and normal force, each if the recording contains it.
pub(crate) fn known(recording: &Recording, target: Exploration) -> [Option<Known<'_>>; 2] {
    let half = (HALF_AVERAGE_S * recording.rate_hz).round() as usize;
    let make = |what, signal, unit, values, target| Known {
        what,
        signal,
        unit,
        values,
        target,
        average: Sums::of(values.iter().copied()),
        half,
    };
    let speed = recording.speed_mm_s.as_deref();
    let force = recording.normal_n.as_deref();
    [
        speed.map(|values| make("scanning speed", "speed", "mm/s", values, target.speed_mm_s)),
        force.map(|values| make("normal force", "normal", "N", values, target.force_n)),
    ]
}

impl Known<'_> {
    /// Returns the lowest and the highest of the averages within a segment.
    fn range(&self, start: usize, len: usize) -> [f64; 2] {
        let averages = (start..start + len).map(|at| self.average.mean_around(at, self.half));
        averages.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        })
    }

    /// Returns the mean over a segment, if the averages stay within the fraction `part` of it.
    pub(crate) fn steady_mean(&self, start: usize, len: usize, part: f64) -> Option<f64> {
        let mean = self.average.mean(start, start + len);
        let [low, high] = self.range(start, len);
        let is_near = |value: f64| (value - mean).abs() <= part * mean.abs();
        (is_near(low) && is_near(high)).then_some(mean)
    }

    fn spread(&self, segments: &Segments) -> [f64; 2] {
        let ranges = segments.starts.iter().map(|&start| self.range(start, segments.len));
        ranges.fold([f64::INFINITY, f64::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// Returns the median over the samples of all segments; a few outliers do not change it.
    fn median(&self, segments: &Segments) -> Option<f64> {
        let (starts, len) = (&segments.starts, segments.len);
        quantile(0.5, starts.len() * len, |at| self.values[starts[at / len] + at % len])
    }

    fn keeps_to(&self, target: f64, [low, high]: [f64; 2]) -> bool {
        let near = |value: f64| (value - target).abs() <= TOLERANCE * target.abs();
        near(low) && near(high)
    }

    /// Whether a segment stays within the tolerance of the target, if there is one.
    fn is_on_target(&self, start: usize, len: usize) -> bool {
        self.target.is_none_or(|target| self.keeps_to(target, self.range(start, len)))
    }
}

/// Removes the segments in which the speed or force differs from its target by more than 10 %.
///
/// # Errors
/// When the target is out of range, or no segment remains.
pub(crate) fn keep_on_target(
    recording: &Recording,
    segments: &mut Segments,
    target: Exploration,
    findings: &mut Findings,
) -> Result<(), AuthorError> {
    target.check()?;
    if target == Exploration::default() {
        return Ok(());
    }
    let known = known(recording, target);
    // Messages compare the target with all segments, not with those that are left.
    let of_all = segments.clone();
    let is_on_target = |start: &usize| {
        let mut known = known.iter().flatten();
        known.all(|one| one.is_on_target(*start, of_all.len))
    };
    (segments.starts, segments.off_target) = of_all.starts.iter().partition(|s| is_on_target(s));
    let off = segments.off_target.len();
    if off == 0 {
        return Ok(());
    }
    let comparison: Vec<String> =
        known.iter().flatten().filter_map(|one| one.comparison(&of_all)).collect();
    let comparison = comparison.join("; ");
    if segments.starts.is_empty() {
        return Err(AuthorError::OffTarget {
            source_name: recording.source.clone(),
            segments: off,
            comparison,
        });
    }
    findings.add(
        RECORDING_OFF_TARGET,
        "",
        format!(
            "{off} of {} segments left out because they differ from their target by more than 10 %: {comparison}",
            of_all.starts.len()
        ),
    );
    Ok(())
}

/// Returns speed and force over the segments, and the range of the measured ones. Given values take
/// precedence; otherwise these are the medians of the measured signals. A deviation of more than 10
/// % from a median is a finding.
///
/// # Errors
/// When a value is out of range.
pub(crate) fn exploration(
    recording: &Recording,
    segments: &Segments,
    given: Exploration,
    findings: &mut Findings,
) -> Result<(Exploration, Spread), AuthorError> {
    let (mut found, mut spread) = (given, Spread::default());
    let [speed, force] = known(recording, given);
    if let Some(speed) = speed {
        spread.speed_mm_s = Some(speed.spread(segments));
        found.speed_mm_s = speed.value(segments, findings);
    }
    if let Some(force) = force {
        spread.force_n = Some(force.spread(segments));
        found.force_n = force.value(segments, findings);
    }
    found.check()?;
    Ok((found, spread))
}

impl Known<'_> {
    /// Returns the target, or else the median. Adds a finding if the motion is not steady about the
    /// median.
    fn value(&self, segments: &Segments, findings: &mut Findings) -> Option<f64> {
        if self.target.is_some() {
            return self.target;
        }
        let median = self.median(segments)?;
        let [low, high] = self.spread(segments);
        if !self.keeps_to(median, [low, high]) {
            let (what, unit) = (self.what, self.unit);
            findings.add(RECORDING_UNSTEADY, format!("/{}", self.signal), format!(
                "the {what} differs from its median of {median:.4} {unit} by more than 10 %: from {low:.4} to {high:.4} {unit}; \
                 choose a steady part, or give a target"
            ));
        }
        Some(median)
    }

    /// Describes a signal with a target: its median and range over the segments.
    fn comparison(&self, segments: &Segments) -> Option<String> {
        let (target, median) = (self.target?, self.median(segments)?);
        let ([low, high], unit) = (self.spread(segments), self.unit);
        Some(format!(
            "the {} is {median:.4} {unit} (median, from {low:.4} to {high:.4}) and its target is {target} {unit}",
            self.what
        ))
    }
}
