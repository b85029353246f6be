//! A thread that polls the driver, so that the output goes to zero even if the writer hangs.

use std::io::Write;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{Builder, JoinHandle, sleep};
use std::time::{Duration, Instant};

use htex_device::DeviceError;

use crate::zero::{HANG, Shared};

/// Time between two looks at whether the thread has ended.
const LOOK: Duration = Duration::from_millis(1);

/// Prints on standard error, which may be closed.
pub(crate) fn say(error: &DeviceError) {
    let _ = writeln!(std::io::stderr(), "htex: {error}");
}

/// Ends when dropped.
pub(crate) struct Watchdog {
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Watchdog {
    /// Watches a session every `period`. If another thread has it for too long, zero is set without it.
    pub(crate) fn start(shared: &Arc<Shared>, period: Duration) -> std::io::Result<Self> {
        let (end, ended) = channel();
        let shared = Arc::clone(shared);
        let watch = move || {
            let mut told = false;
            while ended.recv_timeout(period) == Err(RecvTimeoutError::Timeout) {
                let mut session = match shared.lock() {
                    Ok(session) => session,
                    Err(error) => {
                        // The thread whose call hangs says nothing.
                        if !std::mem::replace(&mut told, true) {
                            say(&error);
                        }
                        continue;
                    }
                };
                let was_running = session.is_running();
                session.watch();
                // A writer that hangs makes no more calls: the warning about a remaining voltage is printed here.
                let danger = session.untold_danger();
                if let Some(error) = danger.filter(|_| was_running && !told) {
                    say(error);
                    told = true;
                }
            }
        };
        let thread = Builder::new()
            .name("htex-daq-watchdog".to_owned())
            .spawn(watch)?;
        Ok(Self {
            end: Some(end),
            thread: Some(thread),
        })
    }
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
