//! How the finger moved: speed and force while the texture was read.

use crate::segments::Segments;
use crate::sums::Sums;
use crate::{AuthorError, Recording};

/// Beyond this part of its target a speed or force is worth a warning (paper: such recordings were
/// discarded and repeated).
const TOLERANCE: f64 = 0.10;
/// Half the length of the average that speed and force are judged on, seconds: fast ripple is the
/// texture's, not the hand's.
const HALF_AVERAGE_S: f64 = 0.025;

/// An exploration condition; what was not recorded and not given is unknown.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Exploration {
    /// Scanning speed, mm/s.
    pub speed_mm_s: Option<f64>,
    /// Normal force, newtons.
    pub force_n: Option<f64>,
}

impl Exploration {
    /// Checks that what is known can be.
    ///
    /// # Errors
    /// When a speed or force is negative or not finite, or beyond 10 m/s or 100 N.
    pub fn check(&self) -> Result<(), AuthorError> {
        let bad = |value: Option<f64>, max: f64| value.filter(|v| !(0.0..=max).contains(v));
        if let Some(value) = bad(self.speed_mm_s, 1e4) {
            return Err(AuthorError::Condition {
                what: "scanning speed",
                value,
                allowed: "0 to 10,000 mm/s is allowed",
            });
        }
        match bad(self.force_n, 100.0) {
            None => Ok(()),
            Some(value) => Err(AuthorError::Condition {
                what: "normal force",
                value,
                allowed: "0 to 100 N is allowed",
            }),
        }
    }
}

/// Speed and force of a recording over its segments: what was given, else what was measured.
///
/// Measured values that leave their target (given, else their own mean) by more than 10 % give a
/// warning.
///
/// # Errors
/// With `strict`, instead of that warning. When a value is impossible.
pub fn exploration(
    recording: &Recording,
    segments: &Segments,
    given: Exploration,
    strict: bool,
    warnings: &mut Vec<String>,
) -> Result<Exploration, AuthorError> {
    given.check()?;
    let mut judge = |what: &str, unit: &str, values: Option<&Vec<f64>>, target: Option<f64>| {
        let Some(range) = values.and_then(|v| Range::over(v, recording.rate_hz, segments)) else {
            return Ok(target);
        };
        if let Some(complaint) = range.complaint(what, unit, target) {
            let complaint = format!("{}: {complaint}", recording.source);
            if strict {
                return Err(AuthorError::OffTarget(complaint));
            }
            warnings.push(complaint);
        }
        Ok(target.or(Some(range.mean)))
    };
    let force_n = judge(
        "normal force",
        "N",
        recording.normal_n.as_ref(),
        given.force_n,
    )?;
    let speed = recording.speed_mm_s.as_ref();
    let found = Exploration {
        speed_mm_s: judge("scanning speed", "mm/s", speed, given.speed_mm_s)?,
        force_n,
    };
    found.check()?;
    Ok(found)
}

struct Range {
    mean: f64,
    min: f64,
    max: f64,
}

impl Range {
    fn over(values: &[f64], rate_hz: f64, segments: &Segments) -> Option<Self> {
        let sums = Sums::of(values.iter().copied());
        let half = (HALF_AVERAGE_S * rate_hz).round() as usize;
        let all: Vec<f64> = segments
            .starts
            .iter()
            .map(|&start| start..start + segments.len)
            .filter(|part| part.end <= values.len())
            .flatten()
            .map(|at| sums.mean_around(at, half))
            .collect();
        (!all.is_empty()).then(|| Self {
            mean: all.iter().sum::<f64>() / all.len() as f64,
            min: all.iter().copied().fold(f64::INFINITY, f64::min),
            max: all.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        })
    }

    fn complaint(&self, what: &str, unit: &str, target: Option<f64>) -> Option<String> {
        let aim = target.unwrap_or(self.mean);
        let off = |value: f64| (value - aim).abs() > TOLERANCE * aim.abs();
        if ![self.mean, self.min, self.max].into_iter().any(off) {
            return None;
        }
        let name = if target.is_some() {
            "its target"
        } else {
            "its mean"
        };
        Some(format!(
            "{what} leaves {name} of {aim:.4} {unit} by more than 10 %: mean {:.4}, from {:.4} to \
             {:.4} {unit}",
            self.mean, self.min, self.max
        ))
    }
}
