//! Measures how much of a take is usable: the share of time during which the finger slides on its
//! target (the requested speed and force), and the number of sweeps.
//!
//! A sweep is one stroke of the finger over the surface. The spectrum of a take uses only the
//! middles of its sweeps. The finger may be on target in all these middles even if it is lifted for
//! most of the take. For example, in one take of 10 s the finger was lifted after 3.2 s, but in the
//! middles of its three sweeps it kept to the target.

use htex_author::recording::Sums;
use htex_author::{Recording, Segments, sliding};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::record::guide::Guidance;

/// A take is judged by moving averages. This is half their length, seconds. The whole length is 50
/// ms.
const HALF_MEAN_S: f64 = 0.025;
/// Lowest speed at which the finger counts as moving on its target, as a fraction of the target
/// speed. A hand turns between strokes, and within a stroke it minimises jerk (T. Flash, N. Hogan
/// 1985, Journal of Neuroscience 5). Therefore, its speed rises and falls all the time. At most
/// 0.31 of such a stroke is within 10 % of a target speed, but 0.57 of it is above half the target
/// speed.
const LOWEST_SPEED: f64 = 0.5;
/// Relative difference that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// Requirements that a take must meet to be accepted, in addition to keeping to its target.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Requirements {
    /// Smallest share of the take in which the finger slides on its target, 0 to 1
    /// ([`Coverage::on_target`]). If this is 0, there is no requirement.
    #[schemars(range(min = 0, max = 1))]
    pub on_target: f64,
    /// Smallest number of complete sweeps. With 0, there is no requirement.
    pub sweeps: u32,
}

impl Requirements {
    /// No requirements.
    pub const NOTHING: Self = Self { on_target: 0.0, sweeps: 0 };
    /// Default of [`Self::on_target`]. Simulated takes were used to choose this value. They lasted
    /// 10 s, had strokes of 83 mm, and were made on five surfaces with four seeds for each surface.
    /// Complete takes had shares of 0.65 (at 240 mm/s) to 0.95 (at 20 mm/s). Takes in which the
    /// finger was lifted for the second half had shares of at most 0.47.
    pub const USUAL_ON_TARGET: f64 = 0.5;

    /// Returns the default of [`Self::sweeps`]. The result is half the number of strokes that the
    /// target on the screen makes in a take of this length (seconds). Two strokes do not count,
    /// because the ends of the take can cut off the first and the last sweep of the finger. Without
    /// a target speed the result is 0, because the screen then shows no strokes.
    #[must_use]
    pub fn usual_sweeps(guidance: &Guidance, seconds: f64) -> u32 {
        let strokes = guidance.turns(seconds).unwrap_or(0);
        // With fewer than two strokes the number is negative, and the requirement is 0 sweeps.
        u32::try_from((strokes - 2) / 2).unwrap_or(0)
    }
}

/// A target and its tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Target {
    pub(crate) value: f64,
    /// Allowed relative difference.
    pub(crate) tolerance: f64,
}

impl Target {
    /// Returns the lowest and the highest allowed value.
    pub(crate) fn range(self) -> [f64; 2] {
        let allowed = self.tolerance * self.value.abs();
        [self.value - allowed, self.value + allowed]
    }

    /// Returns the range of speeds at which the finger counts as moving, anywhere in a sweep.
    fn moving(self) -> [f64; 2] {
        let [_, high] = self.range();
        [LOWEST_SPEED * self.value.abs(), high]
    }

    /// Returns whether a number is within the tolerance. NaN is not.
    pub(crate) fn is_met(self, value: f64) -> bool {
        (value - self.value).abs() <= self.tolerance * self.value.abs() * (1.0 + ROUNDING)
    }
}

/// How much of a take is usable. Each share is a fraction of the take's length, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// Share of time in which the finger slides on its target. Three conditions must hold. Each
    /// condition is evaluated on means over 50 ms. The friction is at least half its mean over the
    /// take. The speed is at least half the target speed, and exceeds the target speed by at most
    /// the tolerance. The force is within the tolerance of its target. If there is no target for
    /// the speed or the force, the condition for that quantity always holds.
    pub on_target: f64,
    /// Share of time in which the finger slides.
    pub sliding: f64,
    /// Share of time in which the speed meets its condition (see [`Self::on_target`]). Absent if
    /// there is no target speed, or if the speed was not measured.
    pub speed: Option<f64>,
    /// Share of time in which the normal force meets its condition (see [`Self::on_target`]).
    /// Absent if there is no target force, or if the force was not measured.
    pub force: Option<f64>,
    /// Number of complete sweeps.
    pub sweeps: usize,
    /// Start and end of the longest interval in which the finger is not on its target, seconds.
    /// Absent if the whole take is on target.
    pub longest_off_s: Option<[f64; 2]>,
}

impl Coverage {
    /// Measures the coverage of a recording. The targets are for speed (mm/s) and force (N).
    pub(crate) fn measure(
        recording: &Recording,
        segments: &Segments,
        [speed, force]: [Option<Target>; 2],
    ) -> Self {
        let half = (HALF_MEAN_S * recording.rate_hz).round() as usize;
        let slides = sliding(recording);
        let speed = within(recording.speed_mm_s.as_deref(), speed.map(Target::moving), half);
        let force = within(recording.normal_n.as_deref(), force.map(Target::range), half);
        let holds = |signal: &Option<Vec<bool>>, at: usize| signal.as_ref().is_none_or(|on| on[at]);
        let all = (0..slides.len()).map(|at| slides[at] && holds(&speed, at) && holds(&force, at));
        let all: Vec<bool> = all.collect();
        let longest = longest_off(&all);
        Self {
            on_target: share(&all),
            sliding: share(&slides),
            speed: speed.as_deref().map(share),
            force: force.as_deref().map(share),
            sweeps: segments.sweeps.len() - segments.cut_off,
            longest_off_s: longest.map(|ends| ends.map(|at| at as f64 / recording.rate_hz)),
        }
    }

    /// Returns which requirements the take does not meet, as phrases.
    pub(crate) fn lacks(&self, required: Requirements) -> Vec<String> {
        let share = (self.on_target < required.on_target).then(|| self.share_lacking(required));
        let sweeps = (self.sweeps < required.sweeps as usize).then(|| {
            format!("complete sweeps: {}, at least {} asked for", self.sweeps, required.sweeps)
        });
        share.into_iter().chain(sweeps).collect()
    }

    fn share_lacking(&self, required: Requirements) -> String {
        let percent = |share: f64| format!("{:.0} %", 100.0 * share);
        let mut parts = vec![format!("it slides in {}", percent(self.sliding))];
        let known = [("speed", self.speed), ("force", self.force)];
        parts.extend(known.into_iter().filter_map(|(what, share)| {
            share.map(|share| format!("its {what} is on target in {}", percent(share)))
        }));
        let longest = self.longest_off_s.map_or(String::new(), |[from, to]| {
            format!("; the longest time off is {from:.1} to {to:.1} s")
        });
        format!(
            "the finger slides on target in {} of the take, at least {} is asked for ({}{longest})",
            percent(self.on_target),
            percent(required.on_target),
            parts.join(", ")
        )
    }
}

/// Returns, for each sample, whether the mean over 50 ms around it is within a range. Returns
/// `None` if there is no range or if there are no values.
fn within(values: Option<&[f64]>, range: Option<[f64; 2]>, half: usize) -> Option<Vec<bool>> {
    let (values, [low, high]) = (values?, range?);
    let means = Sums::new(values.iter().copied());
    let is_within = |at| (low..=high).contains(&means.mean_around(at, half));
    Some((0..values.len()).map(is_within).collect())
}

fn share(on: &[bool]) -> f64 {
    on.iter().filter(|on| **on).count() as f64 / on.len().max(1) as f64
}

/// Returns the start of the longest stretch that is off target, and the sample after its end.
fn longest_off(on: &[bool]) -> Option<[usize; 2]> {
    let mut longest: Option<[usize; 2]> = None;
    let mut begin = 0;
    // The added element ends a stretch that lasts until the last sample.
    for (at, is_on) in on.iter().copied().chain([true]).enumerate() {
        if is_on {
            let is_longer = longest.is_none_or(|[from, to]| at - begin > to - from);
            if at > begin && is_longer {
                longest = Some([begin, at]);
            }
            begin = at + 1;
        }
    }
    longest
}
