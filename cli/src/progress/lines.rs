//! Progress as lines.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use htex_base::finding::plain;

use super::{BETWEEN, is_quiet};
use crate::output::tell;

/// Returns the progress over steps.
pub(crate) fn bar(steps: u64) -> Lines {
    let state = State { steps, done: 0, message: String::new(), last: Instant::now() };
    Lines(Mutex::new(state))
}

/// Prints the progress when it changes, unless the last line was printed a short time ago.
pub(crate) struct Lines(Mutex<State>);

struct State {
    steps: u64,
    done: u64,
    message: String,
    last: Instant,
}

impl Lines {
    pub(crate) fn set_length(&self, steps: u64) {
        self.change(|state| state.steps = steps);
    }

    pub(crate) fn set_message(&self, message: String) {
        self.change(|state| state.message = message);
    }

    pub(crate) fn set_position(&self, done: u64) {
        self.change(|state| state.done = done);
    }

    pub(crate) fn inc(&self, more: u64) {
        self.change(|state| state.done += more);
    }

    pub(crate) fn finish_and_clear(&self) {}

    fn change(&self, change: impl FnOnce(&mut State)) {
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut state);
        if !is_quiet() && state.last.elapsed() >= BETWEEN {
            state.last = Instant::now();
            let State { steps, done, message, .. } = &*state;
            tell!("{}", plain(format!("{done}/{steps} {message}").trim_end()));
        }
    }
}
