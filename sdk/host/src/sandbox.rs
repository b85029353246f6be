//! What modules run in: the limits of each, and what several share.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::{WasmLimits, WasmTotal};

/// The part of passing time that comes back.
const COMES_BACK: f64 = 0.1;

/// The limits of modules, and the budget that they share. A clone shares it too.
#[derive(Debug, Clone)]
pub(crate) struct Sandbox {
    pub(crate) limits: WasmLimits,
    pub(crate) budget: Arc<Budget>,
}

impl Sandbox {
    /// A sandbox with a budget of its own.
    pub(crate) fn new(limits: &WasmLimits) -> Self {
        Self {
            limits: limits.clone(),
            budget: Arc::new(Budget::new("all modules", limits.all, None)),
        }
    }

    /// The sandbox of one asset: within the budget of this one.
    pub(crate) fn of_asset(&self) -> Self {
        let outer = Some(Arc::clone(&self.budget));
        Self {
            limits: self.limits.clone(),
            budget: Arc::new(Budget::new(
                "the modules of this asset",
                self.limits.asset,
                outer,
            )),
        }
    }
}

/// What several modules have together.
#[derive(Debug)]
pub(crate) struct Budget {
    /// Whose it is, for messages.
    whose: &'static str,
    total: WasmTotal,
    memory_bytes: AtomicUsize,
    instances: AtomicUsize,
    time: Mutex<Time>,
    outer: Option<Arc<Self>>,
}

/// Time that is left, as it was at an instant.
#[derive(Debug)]
struct Time {
    left: Duration,
    at: Instant,
}

impl Budget {
    fn new(whose: &'static str, total: WasmTotal, outer: Option<Arc<Self>>) -> Self {
        Self {
            whose,
            total,
            memory_bytes: AtomicUsize::new(0),
            instances: AtomicUsize::new(0),
            time: Mutex::new(Time {
                left: total.time,
                at: Instant::now(),
            }),
            outer,
        }
    }

    /// This budget and those around it.
    fn all(&self) -> impl Iterator<Item = &Self> {
        std::iter::successors(Some(self), |budget| budget.outer.as_deref())
    }

    /// Takes memory, or none and says whose limit that would break.
    pub(crate) fn take_memory(&self, bytes: usize) -> Result<(), String> {
        self.take(bytes, |b| (&b.memory_bytes, b.total.memory_bytes))
            .map_err(|b| {
                format!(
                    "{} may have {} bytes of memory together",
                    b.whose, b.total.memory_bytes
                )
            })
    }

    pub(crate) fn give_memory(&self, bytes: usize) {
        for budget in self.all() {
            budget.memory_bytes.fetch_sub(bytes, Ordering::Relaxed);
        }
    }

    /// Takes the place of an instance, or none and says whose limit that would break.
    pub(crate) fn take_instance(&self) -> Result<(), String> {
        self.take(1, |b| (&b.instances, b.total.instances))
            .map_err(|b| {
                format!(
                    "{} may have {} instances at a time, one a model and one a voice; free some voices",
                    b.whose, b.total.instances
                )
            })
    }

    pub(crate) fn give_instance(&self) {
        for budget in self.all() {
            budget.instances.fetch_sub(1, Ordering::Relaxed);
        }
    }

    /// Adds to a count of this budget and of those around it, or to none; answers the one that has not enough.
    fn take(&self, n: usize, count: impl Fn(&Self) -> (&AtomicUsize, usize)) -> Result<(), &Self> {
        for (taken, budget) in self.all().enumerate() {
            let (used, most) = count(budget);
            let add = |used: usize| used.checked_add(n).filter(|sum| *sum <= most);
            if used
                .fetch_update(Ordering::Relaxed, Ordering::Relaxed, add)
                .is_err()
            {
                for other in self.all().take(taken) {
                    count(other).0.fetch_sub(n, Ordering::Relaxed);
                }
                return Err(budget);
            }
        }
        Ok(())
    }

    /// The time that is left, or whose is used up.
    pub(crate) fn time_left(&self) -> Result<Duration, String> {
        let mut least = Duration::MAX;
        for budget in self.all() {
            let left = budget.update(Duration::ZERO);
            // What comes back while one is refused is not given to the next at once.
            if left < budget.total.time / 100 {
                return Err(format!(
                    "{} have used up the {} ms that they have together",
                    budget.whose,
                    budget.total.time.as_millis()
                ));
            }
            least = least.min(left);
        }
        Ok(least)
    }

    pub(crate) fn spend(&self, time: Duration) {
        for budget in self.all() {
            budget.update(time);
        }
    }

    /// Adds what has come back, takes what was spent, and answers what is left.
    fn update(&self, spent: Duration) -> Duration {
        let mut time = self.time.lock().unwrap_or_else(PoisonError::into_inner);
        let now = Instant::now();
        let back = now.saturating_duration_since(time.at).mul_f64(COMES_BACK);
        time.left = (time.left + back)
            .min(self.total.time)
            .saturating_sub(spent);
        time.at = now;
        time.left
    }
}
