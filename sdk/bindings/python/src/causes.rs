//! Stores exceptions from models that are written in Python. The host passes on only the text of an
//! exception. So the package raises a new exception to the user, and sets the stored exception as
//! its cause.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use htex_model::{Error, Status};
use pyo3::exceptions::PyException;
use pyo3::prelude::*;

/// Largest number of stored exceptions. An exception is dropped when it becomes a cause, or when
/// this many newer ones were stored.
const MOST: usize = 16;
/// Largest length of an exception's text, characters.
const LONGEST: usize = 500;

/// The stored exceptions with their texts, the latest first.
static RAISED: Mutex<VecDeque<(String, PyErr)>> = Mutex::new(VecDeque::new());

/// Stores an exception and returns its text as one line.
fn keep(py: Python<'_>, error: PyErr) -> String {
    let text = error.to_string();
    let one_line = |c: char| if c.is_control() { ' ' } else { c };
    let text: String = text.chars().take(LONGEST).map(one_line).collect();
    // The old exception is dropped after the lock is released, because dropping it may run Python
    // code.
    let old = py.detach(|| {
        let mut raised = RAISED.lock().unwrap_or_else(PoisonError::into_inner);
        raised.push_front((text.clone(), error));
        (raised.len() > MOST).then(|| raised.pop_back())
    });
    drop(old);
    text
}

/// Stores the exception that a call raised, and makes a model error from it.
pub(crate) fn failed(py: Python<'_>, error: PyErr) -> Error {
    Error::new(Status::Failed, keep(py, error))
}

/// Finds the stored exception whose text is contained in the text of `error`, and sets it as the
/// cause of `error`. If the stored exception is an interrupt, returns the interrupt instead.
pub(crate) fn attach(error: PyErr) -> PyErr {
    Python::attach(|py| {
        let text = error.to_string();
        // Releases the interpreter, because the thread that holds the lock may be waiting for it.
        let cause = py.detach(|| {
            let mut raised = RAISED.lock().unwrap_or_else(PoisonError::into_inner);
            let at = raised.iter().position(|(kept, _)| text.contains(kept))?;
            raised.remove(at)
        });
        match cause {
            // `KeyboardInterrupt` and `SystemExit` must end the program as they would without htex.
            Some((_, cause)) if !cause.is_instance_of::<PyException>(py) => cause,
            Some((_, cause)) => {
                error.set_cause(py, Some(cause));
                error
            }
            None => error,
        }
    })
}
