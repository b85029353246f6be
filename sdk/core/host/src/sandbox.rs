//! The sandbox of modules: the limits of each module, and the budget that several modules share.
//!
//! A registry has one budget. Each asset has its own budget within the registry's budget
//! ([`crate::Registry::of_asset`]). Voices do not use these budgets, so rendering takes no lock.
//! Each voice has a time allowance that grows with the samples it renders.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use crate::clock::Instant;
use crate::{WasmLimits, WasmTotal};

/// The time left in a budget grows by this fraction of the elapsed time.
const REFILL: f64 = 0.1;

/// The limits of modules and the budget that they share. A clone shares the budget.
#[derive(Debug, Clone)]
pub(crate) struct Sandbox {
    pub(crate) limits: WasmLimits,
    pub(crate) budget: Arc<Budget>,
}

impl Sandbox {
    /// Creates a sandbox with a new budget.
    pub(crate) fn new(limits: &WasmLimits) -> Self {
        Self {
            limits: limits.clone(),
            budget: Arc::new(Budget::new("all modules", limits.all, None)),
        }
    }

    /// Creates the sandbox of one asset. Its budget is part of this sandbox's budget.
    pub(crate) fn of_asset(&self) -> Self {
        let outer = Some(Arc::clone(&self.budget));
        Self {
            limits: self.limits.clone(),
            budget: Arc::new(Budget::new("the modules of this asset", self.limits.asset, outer)),
        }
    }
}

/// Error: a limit shared by several modules is exceeded.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum BudgetError {
    #[error("{owner} may have {bytes} bytes of memory together")]
    Memory { owner: &'static str, bytes: usize },
    #[error(
        "{owner} may have {instances} instances at a time, one per model and one per voice; free some voices"
    )]
    Instances { owner: &'static str, instances: usize },
    #[error("{owner} have used up the {ms} ms that they have together")]
    Time { owner: &'static str, ms: u128 },
}

/// The shared limits of several modules and their current use.
#[derive(Debug)]
pub(crate) struct Budget {
    /// What messages call the modules that share the budget.
    owner: &'static str,
    total: WasmTotal,
    memory_bytes: AtomicUsize,
    instances: AtomicUsize,
    time: Mutex<Time>,
    outer: Option<Arc<Self>>,
}

/// The time left in a budget, and the instant for which it was computed.
#[derive(Debug)]
struct Time {
    left: Duration,
    at: Instant,
}

impl Budget {
    fn new(owner: &'static str, total: WasmTotal, outer: Option<Arc<Self>>) -> Self {
        Self {
            owner,
            total,
            memory_bytes: AtomicUsize::new(0),
            instances: AtomicUsize::new(0),
            time: Mutex::new(Time { left: total.time, at: Instant::now() }),
            outer,
        }
    }

    /// Iterates over this budget and the budgets that contain it.
    fn all(&self) -> impl Iterator<Item = &Self> {
        std::iter::successors(Some(self), |budget| budget.outer.as_deref())
    }

    /// Reserves memory. On error, reserves nothing.
    pub(crate) fn take_memory(&self, bytes: usize) -> Result<(), BudgetError> {
        self.reserve(bytes, |b| (&b.memory_bytes, b.total.memory_bytes))
            .map_err(|b| BudgetError::Memory { owner: b.owner, bytes: b.total.memory_bytes })
    }

    pub(crate) fn give_memory(&self, bytes: usize) {
        for budget in self.all() {
            budget.memory_bytes.fetch_sub(bytes, Ordering::Relaxed);
        }
    }

    /// Counts one more instance. On error, counts nothing.
    pub(crate) fn take_instance(&self) -> Result<(), BudgetError> {
        self.reserve(1, |b| (&b.instances, b.total.instances))
            .map_err(|b| BudgetError::Instances { owner: b.owner, instances: b.total.instances })
    }

    pub(crate) fn give_instance(&self) {
        for budget in self.all() {
            budget.instances.fetch_sub(1, Ordering::Relaxed);
        }
    }

    /// Adds to a count of this budget and of the budgets that contain it. If a limit would be
    /// exceeded, adds nothing and returns the budget with this limit.
    fn reserve(
        &self,
        n: usize,
        count: impl Fn(&Self) -> (&AtomicUsize, usize),
    ) -> Result<(), &Self> {
        for (taken, budget) in self.all().enumerate() {
            let (used, most) = count(budget);
            let add = |used: usize| used.checked_add(n).filter(|sum| *sum <= most);
            // No other data depends on the counts, so `Relaxed` suffices.
            if used.fetch_update(Ordering::Relaxed, Ordering::Relaxed, add).is_err() {
                // An outer budget is full, so the number is subtracted again from the inner
                // budgets.
                for other in self.all().take(taken) {
                    count(other).0.fetch_sub(n, Ordering::Relaxed);
                }
                return Err(budget);
            }
        }
        Ok(())
    }

    /// Returns the time left. If the time of a budget is used up, the error names that budget.
    pub(crate) fn time_left(&self) -> Result<Duration, BudgetError> {
        let mut least = Duration::MAX;
        for budget in self.all() {
            let left = budget.update(Duration::ZERO);
            // After the time is used up, calls are refused until the time left has grown to a
            // hundredth of the total again.
            if left < budget.total.time / 100 {
                return Err(BudgetError::Time {
                    owner: budget.owner,
                    ms: budget.total.time.as_millis(),
                });
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

    /// Adds a fraction of the elapsed time to the time left, subtracts the time `spent`, and
    /// returns the time left.
    fn update(&self, spent: Duration) -> Duration {
        let mut time = self.time.lock().unwrap_or_else(PoisonError::into_inner);
        let now = Instant::now();
        let back = now.saturating_duration_since(time.at).mul_f64(REFILL);
        // The time left is limited before the spent time is subtracted. Otherwise, a long pause
        // would pay for the call after it.
        time.left = (time.left + back).min(self.total.time).saturating_sub(spent);
        time.at = now;
        time.left
    }
}
