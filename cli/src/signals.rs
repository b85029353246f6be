//! Handles Ctrl-C, a closed terminal, and a request to end.
//!
//! At any time, a signal has one of three meanings. It ends the program and removes unfinished
//! files; it makes a player ramp its output to zero; or it is ignored, in a guardian.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU8, AtomicUsize, Ordering};

use crate::failure::{Failure, Result};
use crate::located;
use crate::output::tell;

/// Exit status of an interrupted program, as is customary.
// 128 plus the number of SIGINT.
const INTERRUPTED: i32 = 130;

/// End the program at once and remove unfinished files.
const ENDS: u8 = 0;
/// Set the flag that [`interrupted`] returns, so that playback can go to zero first.
const IS_ASKED_FOR: u8 = 1;
/// Ignore the signal: only the end of its pipe ends a guardian.
const IGNORED: u8 = 2;

static MEANING: AtomicU8 = AtomicU8::new(ENDS);
static SIGNALS: AtomicUsize = AtomicUsize::new(0);
/// The result of installing the handler.
static HANDLED: OnceLock<Result<(), String>> = OnceLock::new();

/// From now on, signals end the program and remove unfinished files.
pub(crate) fn handle() -> Result<()> {
    MEANING.store(ENDS, Ordering::Relaxed);
    SIGNALS.store(0, Ordering::Relaxed);
    let handled = HANDLED.get_or_init(install).clone();
    handled.map_err(|error| Failure::Other(format!("cannot catch Ctrl-C: {error}")))
}

/// Installs the handler once per process.
fn install() -> Result<(), String> {
    // Runs in a thread of `ctrlc`, not in the signal handler itself, so it may lock and delete
    // files.
    let handler = || match MEANING.load(Ordering::Relaxed) {
        ENDS => {
            htex_format::remove_unfinished();
            located::remove_copies();
            std::process::exit(INTERRUPTED);
        }
        IGNORED => {}
        _ => match SIGNALS.fetch_add(1, Ordering::Relaxed) {
            0 => {}
            1 => tell!("htex: the output is going to zero; please wait"),
            _ => tell!(
                "htex: the device has not said that its output is at zero: up to its limit may be standing there; switch \
                 the amplifier off before you end this program by force"
            ),
        },
    };
    ctrlc::set_handler(handler).map_err(|error| error.to_string())
}

/// From now on, a signal sets [`interrupted`]. The ramp to zero is never cut short. After a second
/// signal, the program prints that the ramp is running. After each further signal, it prints which
/// voltage may remain.
pub(crate) fn ask() {
    MEANING.store(IS_ASKED_FOR, Ordering::Relaxed);
}

/// From now on, signals are ignored.
pub(crate) fn ignore() {
    MEANING.store(IGNORED, Ordering::Relaxed);
}

/// Whether a signal has asked the program to end.
pub(crate) fn interrupted() -> bool {
    SIGNALS.load(Ordering::Relaxed) > 0
}
