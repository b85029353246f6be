//! Clocks of a session.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use htex_lab::study::{Clock, utc};

pub(super) struct WallClock;

impl Clock for WallClock {
    fn now_ms(&self) -> u64 {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        since.map_or(0, |since| since.as_millis() as u64)
    }

    fn pass(&mut self, time: Duration) {
        std::thread::sleep(time);
    }

    fn played(&mut self, _: Duration) {}

    fn date(&self) -> Option<String> {
        Some(utc(self.now_ms()))
    }

    fn go_on_at(&mut self, _: u64) {}
}

/// A simulated clock, which does not wait: its times depend on what was done alone.
#[derive(Default)]
pub(super) struct FastClock {
    now: Duration,
}

impl Clock for FastClock {
    fn now_ms(&self) -> u64 {
        self.now.as_millis() as u64
    }

    fn pass(&mut self, time: Duration) {
        self.now += time;
    }

    fn played(&mut self, time: Duration) {
        self.now += time;
    }

    fn date(&self) -> Option<String> {
        None
    }

    fn go_on_at(&mut self, ms: u64) {
        self.now = Duration::from_millis(ms);
    }
}
