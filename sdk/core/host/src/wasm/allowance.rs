//! The time limit of a voice.

use std::time::Duration;

use super::fault::Fault;

/// Longest rendering time of samples, as a multiple of their duration.
const TIMES: f64 = 10.0;
/// The time at the start, which is also the maximum.
const FIRST: Duration = Duration::from_secs(1);

/// The time of one voice: one second, and ten times the duration of its samples. The rendering time
/// is therefore at most proportional to the duration of the samples.
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
