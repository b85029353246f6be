//! The clocks of a session.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use htex_lab::study::{Clock, utc};

/// A clock in milliseconds since 1970. It reads the system's clock once, when it is created, and
/// then continues with the monotonic clock. If it always read the system's clock, a change of that
/// clock during a session could make a response time negative, or a rest an hour long.
pub(super) struct WallClock {
    made_ms: u64,
    made: Instant,
}

impl WallClock {
    pub(super) fn new() -> Self {
        Self::made_at(system_ms())
    }

    fn made_at(made_ms: u64) -> Self {
        Self { made_ms, made: Instant::now() }
    }
}

fn system_ms() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_millis() as u64)
}

impl Clock for WallClock {
    fn now_ms(&self) -> u64 {
        self.made_ms.saturating_add(self.made.elapsed().as_millis() as u64)
    }

    fn pass(&mut self, time: Duration) {
        std::thread::sleep(time);
    }

    fn played(&mut self, _: Duration) {}

    fn date(&self) -> Option<String> {
        Some(utc(system_ms()))
    }

    /// Continues at `ms` or later, because the system's clock may have been set back since the last
    /// answer.
    fn go_on_at(&mut self, ms: u64) {
        let now = self.now_ms().max(ms);
        *self = Self::made_at(now);
    }
}

/// A simulated clock that does not wait. Its time advances only when the session waits or plays.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A session that was left at three o'clock continues correctly after the clock was set back to
    /// two.
    #[test]
    fn time_never_goes_back() {
        let hour_ms = 3_600_000;
        let mut clock = WallClock::made_at(2 * hour_ms);
        clock.go_on_at(3 * hour_ms);
        let first = clock.now_ms();
        clock.pass(Duration::from_millis(5));
        let passed = clock.now_ms() - first;
        assert!(first >= 3 * hour_ms && (5..60_000).contains(&passed), "{first}, {passed}");
        clock.go_on_at(hour_ms);
        assert!(clock.now_ms() >= first + 5);
        // The date comes from the system.
        assert!(clock.date().is_some_and(|date| !date.starts_with("1970")));
    }
}
