//! A thread that asks the driver how it is, so that a device whose writer hangs goes to zero too.

use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{Builder, JoinHandle};
use std::time::Duration;

use crate::session::Session;

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
            while ended.recv_timeout(period) == Err(RecvTimeoutError::Timeout) {
                session
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .watch();
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
