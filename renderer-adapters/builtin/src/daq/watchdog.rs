//! A watchdog thread that polls the driver, and sets the output to zero if the thread that writes
//! hangs.

use std::io::Write;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{Builder, JoinHandle, sleep};
use std::time::{Duration, Instant};

use htex_device::DeviceError;

use crate::daq::zero::{HANG, Hung, Shared};

/// Polling interval while waiting for the thread to end.
const LOOK: Duration = Duration::from_millis(1);

/// Prints an error on standard error, which may be closed.
pub(crate) fn say(error: &DeviceError) {
    let _ = writeln!(std::io::stderr(), "htex: {error}");
}

/// What a watchdog checks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Watches {
    /// Asks the driver whether the output is still running.
    Output,
    /// Checks only that the session's lock becomes free from time to time. Does not call the
    /// driver, because such a call might also hang.
    Calls,
}

/// A running watchdog thread. Dropping it ends the thread.
pub(crate) struct Watchdog {
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Watchdog {
    /// Watches a session every `period`. If another thread holds the session for too long, the
    /// watchdog sets the output to zero without it.
    pub(crate) fn start(
        shared: &Arc<Shared>,
        period: Duration,
        watches: Watches,
    ) -> std::io::Result<Self> {
        let (end, ended) = channel();
        let shared = Arc::clone(shared);
        let watch = move || {
            let mut told = false;
            // Nothing is ever sent: the thread ends when the sender is dropped.
            while ended.recv_timeout(period) == Err(RecvTimeoutError::Timeout) {
                let error = look(&shared, watches);
                // The watchdog prints the error. The watchdog prints the error, because neither a
                // thread whose call hangs nor a writer that makes no more calls can report it.
                if let Some(error) = error.filter(|_| !told) {
                    say(&error);
                    told = true;
                }
            }
        };
        let thread = Builder::new().name("htex-daq-watchdog".to_owned()).spawn(watch)?;
        Ok(Self { end: Some(end), thread: Some(thread) })
    }
}

/// Checks once. Returns an error that perhaps no other thread can report.
fn look(shared: &Shared, watches: Watches) -> Option<DeviceError> {
    let mut session = match shared.lock() {
        Ok(session) => session,
        Err(Hung { error, is_first }) => return is_first.then_some(error),
    };
    if watches == Watches::Calls {
        return None;
    }
    let was_running = session.is_running();
    session.watch();
    let danger = session.untold_danger().cloned();
    danger.filter(|_| was_running)
}

impl Drop for Watchdog {
    fn drop(&mut self) {
        drop(self.end.take());
        // A driver call in the thread may hang.
        let Some(thread) = self.thread.take() else {
            return;
        };
        let since = Instant::now();
        while !thread.is_finished() && since.elapsed() < HANG {
            sleep(LOOK);
        }
        if thread.is_finished() {
            let _ = thread.join();
        }
    }
}
