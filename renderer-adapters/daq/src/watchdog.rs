//! A thread that polls the driver, so that the output goes to zero even if the writer hangs.

use std::io::Write;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{Builder, JoinHandle};
use std::time::Duration;

use htex_device::DeviceError;

use crate::session::Session;

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
    /// Watches a session every `period`.
    pub(crate) fn start(session: &Arc<Mutex<Session>>, period: Duration) -> std::io::Result<Self> {
        let (end, ended) = channel();
        let session = Arc::clone(session);
        let watch = move || {
            let mut told = false;
            while ended.recv_timeout(period) == Err(RecvTimeoutError::Timeout) {
                let mut session = session.lock().unwrap_or_else(PoisonError::into_inner);
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
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
