//! Runs work in several threads.

use std::panic::resume_unwind;
use std::sync::Mutex;
use std::thread::scope;

/// Calls a function with each item, in `jobs` threads at the same time.
pub(crate) fn at_a_time<T: Send, R: Send>(
    jobs: usize,
    items: Vec<T>,
    call: impl Fn(T) -> R + Sync,
) -> Vec<R> {
    let waiting = Mutex::new(items.into_iter());
    // `next` releases the lock before `call` runs.
    let next = || waiting.lock().ok()?.next();
    let work = || std::iter::from_fn(next).map(&call).collect::<Vec<R>>();
    scope(|scope| {
        let workers: Vec<_> = (0..jobs).map(|_| scope.spawn(work)).collect();
        let joined = workers.into_iter().map(|worker| worker.join());
        joined.flat_map(|done| done.unwrap_or_else(|panic| resume_unwind(panic))).collect()
    })
}
