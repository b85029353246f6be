//! The time limit of a voice.

use std::time::Duration;

use super::fault::Fault;

/// Largest rendering time, as a multiple of the duration of the rendered samples.
const TIMES: f64 = 10.0;
/// Time that a new voice has. It is also the largest time that a voice can save up.
const FIRST: Duration = Duration::from_secs(1);

/// The time left for one voice. A voice starts with one second, and each rendered sample adds ten
/// times its duration. As a result, in the long run rendering takes at most ten times the duration
/// of the samples.
#[derive(Debug)]
pub(super) struct Allowance {
    left: Duration,
    per_sample_s: f64,
}

impl Allowance {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self { left: FIRST, per_sample_s: TIMES / rate_hz.max(1.0) }
    }

    pub(super) fn earn(&mut self, samples: usize) {
        let earned = Duration::from_secs_f64(samples as f64 * self.per_sample_s);
        self.left = (self.left + earned).min(FIRST);
    }

    pub(super) fn spend(&mut self, time: Duration) {
        self.left = self.left.saturating_sub(time);
    }

    pub(super) fn left(&self) -> Result<Duration, Fault> {
        if self.left.is_zero() {
            return Err(Fault::VoiceTime { times: TIMES });
        }
        Ok(self.left)
    }
}
