//! Progress of long work on standard error: a bar on a terminal, and a line every ten seconds
//! elsewhere. A program that is built without the feature `terminal` always prints lines.

#[cfg(feature = "terminal")]
mod bars;
#[cfg(not(feature = "terminal"))]
mod lines;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::time::Duration;

use htex_base::finding::plain;

use crate::output::tell;

#[cfg(feature = "terminal")]
pub(crate) use bars::bar;
#[cfg(feature = "build")]
pub(crate) use bars::byte_bar;
#[cfg(not(feature = "terminal"))]
pub(crate) use lines::bar;

/// Time between two lines where there is no terminal.
const BETWEEN: Duration = Duration::from_secs(10);
/// Time after which a command that waits for a server says so.
const SILENT: Duration = Duration::from_secs(2);

/// Whether `--quiet` was given.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Sets whether only results and errors are printed.
pub(crate) fn set_quiet(is_quiet: bool) {
    QUIET.store(is_quiet, Ordering::Relaxed);
}

pub(crate) fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Says after two seconds what the command waits for. If it is dropped before, it says nothing.
pub(crate) struct Waiting {
    // This field is dropped first, and its drop ends the thread.
    _ended: Sender<()>,
}

impl Waiting {
    /// Begins to wait for a file at a URI.
    pub(crate) fn for_file(uri: String, longest: Duration) -> Option<Self> {
        if is_quiet() {
            return None;
        }
        let (sender, receiver) = mpsc::channel::<()>();
        std::thread::spawn(move || {
            if receiver.recv_timeout(SILENT) == Err(RecvTimeoutError::Timeout) {
                tell!("note: waiting for {}, at most {} s", plain(&uri), longest.as_secs());
            }
        });
        Some(Self { _ended: sender })
    }
}
