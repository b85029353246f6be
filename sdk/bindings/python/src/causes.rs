//! Exceptions from models written in Python. The host passes on only their texts; the exception
//! that is finally raised gets the original as its cause.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use htex_model::{Error, Status};
use pyo3::exceptions::PyException;
use pyo3::prelude::*;

/// Number of exceptions that are stored. An exception is dropped when it becomes a cause, or after
/// this many others.
const MOST: usize = 16;
/// Largest length of an exception's text, characters.
const LONGEST: usize = 500;

/// Texts and exceptions, the latest first.
static RAISED: Mutex<VecDeque<(String, PyErr)>> = Mutex::new(VecDeque::new());

/// Stores an exception and returns its text in one line.
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

/// Stores the exception of a call, and makes the model's error from it.
pub(crate) fn failed(py: Python<'_>, error: PyErr) -> Error {
    Error::new(Status::Failed, keep(py, error))
}

/// Sets the stored exception whose text is part of this one's as its cause. An interrupt is
/// returned itself.
pub(crate) fn attach(error: PyErr) -> PyErr {
    Python::attach(|py| {
        let text = error.to_string();
        // Without the interpreter, which the thread that holds the lock may be waiting for.
        let cause = py.detach(|| {
            let mut raised = RAISED.lock().unwrap_or_else(PoisonError::into_inner);
            let at = raised.iter().position(|(kept, _)| text.contains(kept))?;
            raised.remove(at)
        });
        match cause {
            // `KeyboardInterrupt` and `SystemExit` must end the program as they would have without
            // us.
            Some((_, cause)) if !cause.is_instance_of::<PyException>(py) => cause,
            Some((_, cause)) => {
                error.set_cause(py, Some(cause));
                error
            }
            None => error,
        }
    })
}
