//! Computing time of a thread, which other programs on the machine do not lengthen.

use std::time::{Duration, Instant};

/// A clock of this thread's computing time. If the system does not provide one, it measures elapsed
/// time.
pub struct Busy {
    computed: Option<Duration>,
    start: Instant,
}

impl Busy {
    pub fn start() -> Self {
        Self { computed: computed(), start: Instant::now() }
    }

    pub fn elapsed(&self) -> Duration {
        match (self.computed, computed()) {
            (Some(start), Some(now)) => now - start,
            _ => self.start.elapsed(),
        }
    }
}

fn computed() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds = text.split(' ').next()?.parse().ok()?;
    Some(Duration::from_nanos(nanoseconds))
}
