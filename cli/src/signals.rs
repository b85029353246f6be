//! What Ctrl-C, a terminal that hangs up, and a request to end do.

use std::sync::atomic::{AtomicU8, AtomicUsize, Ordering};

use crate::failure::Failure;
use crate::output::tell;

/// What an interrupted program answers by convention.
const INTERRUPTED: i32 = 130;

/// Ends the program at once, files that are being written removed.
const ENDS: u8 = 0;
/// Is asked for by [`interrupted`]: what plays goes to zero first.
const IS_ASKED_FOR: u8 = 1;
/// Nothing: only the end of its pipe ends a guardian.
const IGNORED: u8 = 2;

static MEANING: AtomicU8 = AtomicU8::new(ENDS);
static SIGNALS: AtomicUsize = AtomicUsize::new(0);

/// From now on signals end the program, and leave no unfinished file.
pub(crate) fn handle() -> Result<(), Failure> {
    let handler = || match MEANING.load(Ordering::Relaxed) {
        ENDS => {
            htex_format::remove_unfinished();
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
    ctrlc::set_handler(handler)
        .map_err(|error| Failure::Other(format!("cannot catch Ctrl-C: {error}")))
}

/// From now on a signal is answered by [`interrupted`]. The way to zero is never cut short: a second signal says that it
/// is being gone, and each further one what may be standing.
pub(crate) fn ask() {
    MEANING.store(IS_ASKED_FOR, Ordering::Relaxed);
}

/// From now on signals do nothing.
pub(crate) fn ignore() {
    MEANING.store(IGNORED, Ordering::Relaxed);
}

/// Whether the user wants an end.
pub(crate) fn interrupted() -> bool {
    SIGNALS.load(Ordering::Relaxed) > 0
}
