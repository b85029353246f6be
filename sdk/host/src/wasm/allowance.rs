//! The time that a voice may take.

use std::time::Duration;

/// How many times as long as they last samples may take to render.
const TIMES: f64 = 10.0;
/// What a voice has at its start, and at most.
const FIRST: Duration = Duration::from_secs(1);

/// The time of one voice: a second, and ten times as long as what it renders lasts. So whatever a module does, rendering
/// takes a time proportional to what is rendered.
#[derive(Debug)]
pub(super) struct Allowance {
    left: Duration,
    per_sample_s: f64,
}

impl Allowance {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self {
            left: FIRST,
            per_sample_s: TIMES / rate_hz.max(1.0),
        }
    }

    pub(super) fn earn(&mut self, samples: usize) {
        let earned = Duration::from_secs_f64(samples as f64 * self.per_sample_s);
        self.left = (self.left + earned).min(FIRST);
    }

    pub(super) fn spend(&mut self, time: Duration) {
        self.left = self.left.saturating_sub(time);
    }

    pub(super) fn left(&self) -> Result<Duration, String> {
        match self.left.is_zero() {
            false => Ok(self.left),
            true => Err(format!(
                "the voice takes more than {TIMES} times as long as what it renders lasts"
            )),
        }
    }
}
