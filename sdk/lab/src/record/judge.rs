//! Judges whether a take kept to its target.

use std::error::Error;

use htex_author::recording::RecordingError;
use htex_author::{
    Exploration, Recording, SegmentedTake, SpectrumOptions, Take, segment_take, velocity,
};
use serde::{Deserialize, Serialize};

use crate::record::coverage::{Coverage, Target};
use crate::record::data::{TakeData, TakeHeader, texture_axes};

/// At the start and at the end of a take, the tracker need not cover this time, seconds.
const UNTRACKED_S: f64 = 0.25;
/// A position is interpolated between two rows of a tracker only if they are at most this time
/// apart, seconds.
const GAP_S: f64 = 0.2;

/// A quantity measured over the sweeps of a take.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeanRange {
    /// Mean over all segments.
    pub mean: f64,
    /// Lowest mean over 50 ms.
    pub min: f64,
    /// Highest mean over 50 ms.
    pub max: f64,
}

/// The judgement of a take.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Verdict {
    /// Whether the take kept to its target and meets all requirements.
    pub kept: bool,
    /// Why the take was rejected, as phrases.
    pub reasons: Vec<String>,
    /// Scanning speed, mm/s.
    pub speed_mm_s: Option<MeanRange>,
    /// Normal force, newtons.
    pub force_n: Option<MeanRange>,
    /// How much of the take is usable. Absent if no texture can be read from the take.
    pub coverage: Option<Coverage>,
    /// Number of 0.2 s segments that a fit of the take would use.
    pub segments: usize,
    /// Problems of the signals, such as clipping. Each entry is a sentence with the code of the
    /// problem.
    pub findings: Vec<String>,
}

/// Judges a take. The mean, minimum and maximum of speed and normal force must be within the
/// tolerance of their targets. These three values are measured over the middles of the sweeps,
/// which `htex fit` also uses.
///
/// Minimum and maximum are the lowest and the highest mean over 50 ms, as in
/// [`htex_author::Spread`], because faster changes belong to the texture. Only the middles of
/// sweeps count, because the finger turns between sweeps. The take must also meet the requirements
/// in its header ([`crate::record::Requirements`]).
#[must_use]
pub fn judge(data: &TakeData) -> Verdict {
    let header = &data.header;
    let mut verdict = Verdict::default();
    match reading(data) {
        Ok((reading, recording)) => {
            measure(&mut verdict, &reading, &recording);
            let [speed, force] = targets(header);
            let targets = [
                ("speed", "mm/s", speed, verdict.speed_mm_s),
                ("force", "N", force, verdict.force_n),
            ];
            for (what, unit, target, measured) in targets {
                let Some(target) = target else { continue };
                let reason = match measured {
                    None => {
                        Some(format!("the {what} is not known: the tracker has sent no position"))
                    }
                    Some(measured) => differs(what, unit, target, measured),
                };
                verdict.reasons.extend(reason);
            }
            let coverage = Coverage::measure(&recording, &reading.spectra.segments, [speed, force]);
            verdict.reasons.extend(coverage.lacks(header.required));
            verdict.coverage = Some(coverage);
            if header.target_speed_mm_s.is_some() {
                verdict.reasons.extend(untracked(data));
            }
        }
        Err(error) => {
            let problem = error.to_string();
            verdict.findings.push(problem.clone());
            // Without a target, a take is kept even if no texture can be read from it.
            if header.target_speed_mm_s.is_some() || header.target_force_n.is_some() {
                verdict.reasons.push(problem);
            }
        }
    }
    verdict.kept = verdict.reasons.is_empty();
    verdict
}

/// Returns the targets for speed (mm/s) and force (N).
fn targets(header: &TakeHeader) -> [Option<Target>; 2] {
    let tolerance = header.tolerance;
    [header.target_speed_mm_s, header.target_force_n]
        .map(|target| target.map(|value| Target { value, tolerance }))
}

fn reading(data: &TakeData) -> Result<(SegmentedTake, Recording), Box<dyn Error>> {
    let recording = recording(data)?;
    let take = Take { recording, given: Exploration::default() };
    let reading = segment_take(&take, &SpectrumOptions::default(), false)?;
    Ok((reading, take.recording))
}

/// Converts the take to a recording. Uses the tracker's speed if there is a tracker.
fn recording(data: &TakeData) -> Result<Recording, RecordingError> {
    let signal = |role: &str| data.header.signal(role).map(|at| data.signals[at].clone());
    let axes =
        texture_axes(&data.header.signals).iter().map(|at| data.signals[*at].clone()).collect();
    let (name, rate_hz) = (data.header.name.as_str(), data.header.rate_hz);
    let mut recording = Recording::from_axes(data.header.quantity, name, rate_hz, axes)?;
    if let Some(normal) = signal("normal") {
        recording = recording.with_normal(normal)?;
    }
    match speed(data) {
        Some(speed) => recording.with_speed(speed),
        None => Ok(recording),
    }
}

/// Returns the finger's speed at each sample, mm/s. It comes from the tracker if there is one,
/// otherwise from the source.
fn speed(data: &TakeData) -> Option<Vec<f64>> {
    let at_s: Vec<f64> = (0..data.frames()).map(|i| i as f64 / data.header.rate_hz).collect();
    let tracked = |role: &str| {
        let at = data.header.tracker.iter().position(|(own, _)| own == role)?;
        Some(&data.tracker[at + 1][..])
    };
    let own = |role: &str| data.header.signal(role).map(|at| &data.signals[at][..]);
    let (time_s, speed, position) = match data.tracker.first() {
        // A speed needs two rows.
        Some(time_s) if time_s.len() < 2 => return None,
        Some(time_s) => (time_s, tracked("speed"), [tracked("x"), tracked("y")]),
        None => (&at_s, own("speed"), [own("x"), own("y")]),
    };
    if let Some(speed) = speed {
        return Some(at_s.iter().map(|t| interpolated(time_s, speed, *t).abs()).collect());
    }
    let first_s = *time_s.first()?;
    let from_first: Vec<f64> = time_s.iter().map(|t| t - first_s).collect();
    let axes = position.iter().flatten();
    let velocities: Vec<Vec<f64>> =
        axes.map(|axis| velocity(&from_first, axis, at_s.iter().map(|t| t - first_s))).collect();
    let first = velocities.first()?;
    Some(match velocities.get(1) {
        None => first.iter().map(|v| v.abs()).collect(),
        Some(second) => first.iter().zip(second).map(|(a, b)| libm::hypot(*a, *b)).collect(),
    })
}

/// Interpolates linearly between rows of ascending times. Before the first row and after the last
/// row, returns the value of that row.
fn interpolated(time_s: &[f64], values: &[f64], at_s: f64) -> f64 {
    let after = time_s.partition_point(|t| *t <= at_s);
    match (after.checked_sub(1), after < values.len()) {
        (None, _) => values[0],
        (Some(before), false) => values[before],
        (Some(before), true) => {
            let part = (at_s - time_s[before]) / (time_s[after] - time_s[before]);
            values[before] + part * (values[after] - values[before])
        }
    }
}

fn measure(verdict: &mut Verdict, reading: &SegmentedTake, recording: &Recording) {
    let stretches = reading.spectra.segments.stretches();
    let mean = |values: &[f64]| {
        let (mut sum, mut count) = (0.0, 0);
        for stretch in &stretches {
            sum += values[stretch.clone()].iter().sum::<f64>();
            count += stretch.len();
        }
        sum / count.max(1) as f64
    };
    let measured = |range: Option<[f64; 2]>, values: Option<&Vec<f64>>| {
        let ([min, max], values) = (range?, values?);
        let mean = mean(values);
        Some(MeanRange { mean, min, max })
    };
    verdict.speed_mm_s = measured(reading.spread.speed_mm_s, recording.speed_mm_s.as_ref());
    verdict.force_n = measured(reading.spread.force_n, recording.normal_n.as_ref());
    verdict.segments = reading.spectra.segments.starts.len();
    let findings = reading.findings.iter();
    verdict.findings = findings.map(|f| format!("{}: {}", f.code, f.message)).collect();
}

/// Returns a phrase if a quantity differs from its target by more than the tolerance.
fn differs(what: &str, unit: &str, target: Target, measured: MeanRange) -> Option<String> {
    let MeanRange { mean, min, max } = measured;
    let values = [("mean", mean), ("minimum", min), ("maximum", max)];
    let wrong = values.iter().filter(|(_, value)| !target.is_met(*value));
    let wrong: Vec<String> = wrong.map(|(name, value)| format!("{name} {value:.4}")).collect();
    (!wrong.is_empty()).then(|| {
        let [low, high] = target.range();
        format!("{what}: {} {unit}, allowed is {low:.4} to {high:.4} {unit}", wrong.join(", "))
    })
}

/// Returns a phrase if a part of the take is not covered by the tracker.
fn untracked(data: &TakeData) -> Option<String> {
    let time_s = data.tracker.first()?;
    let end_s = data.recorded_s();
    let (first_s, last_s) = (*time_s.first()?, *time_s.last()?);
    if first_s > UNTRACKED_S || last_s < end_s - UNTRACKED_S {
        return Some(format!("the tracker covers {first_s:.2} to {last_s:.2} s of {end_s:.2} s"));
    }
    let gap = time_s.windows(2).find(|pair| pair[1] - pair[0] > GAP_S)?;
    Some(format!("the tracker has sent nothing from {:.2} to {:.2} s", gap[0], gap[1]))
}
