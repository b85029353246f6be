//! A thread that polls the driver, so that the output goes to zero even if the writer hangs.

use std::io::Write;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{Builder, JoinHandle, sleep};
use std::time::{Duration, Instant};

use htex_device::DeviceError;

use crate::zero::{HANG, Hung, Shared};

/// Time between two looks at whether the thread has ended.
const LOOK: Duration = Duration::from_millis(1);

/// Prints on standard error, which may be closed.
pub(crate) fn say(error: &DeviceError) {
    let _ = writeln!(std::io::stderr(), "htex: {error}");
}

/// What a watchdog does with the session.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Watches {
    /// Asks the driver whether the output still runs.
    Output,
    /// Sees that the session is free from time to time, without a call of the driver that may hang
    /// as well.
    Calls,
}

/// Ends when dropped.
pub(crate) struct Watchdog {
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Watchdog {
    /// Watches a session every `period`. If another thread has it for too long, zero is set without
    /// it.
    pub(crate) fn start(
        shared: &Arc<Shared>,
        period: Duration,
        watches: Watches,
    ) -> std::io::Result<Self> {
        let (end, ended) = channel();
        let shared = Arc::clone(shared);
        let watch = move || {
            let mut told = false;
            while ended.recv_timeout(period) == Err(RecvTimeoutError::Timeout) {
                let error = look(&shared, watches);
                // A thread whose call hangs, or a writer that makes no more calls, prints nothing.
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

/// Looks once; returns an error that nobody else may tell.
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
        // A call of the driver in it may hang.
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
