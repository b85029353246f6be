//! Exceptions of models that are written in Python. The host passes their texts on; the exception
//! that is raised for one gets the original as its cause.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use htex_model::{Error, Status};
use pyo3::exceptions::PyException;
use pyo3::prelude::*;

/// Exceptions that are kept. One is dropped when it becomes a cause, or after this many others.
const MOST: usize = 16;
/// Most characters of an exception's text.
const LONGEST: usize = 500;

/// Texts and exceptions, the latest first.
static RAISED: Mutex<VecDeque<(String, PyErr)>> = Mutex::new(VecDeque::new());

/// Keeps an exception; returns its text, in one line.
fn keep(py: Python<'_>, error: PyErr) -> String {
    let text = error.to_string();
    let one_line = |c: char| if c.is_control() { ' ' } else { c };
    let text: String = text.chars().take(LONGEST).map(one_line).collect();
    // An exception is dropped after the lock is released: it may run code of Python.
    let old = py.detach(|| {
        let mut raised = RAISED.lock().unwrap_or_else(PoisonError::into_inner);
        raised.push_front((text.clone(), error));
        (raised.len() > MOST).then(|| raised.pop_back())
    });
    drop(old);
    text
}

/// Keeps the exception of a call, and makes the model's error of it.
pub(crate) fn failed(py: Python<'_>, error: PyErr) -> Error {
    Error::new(Status::Failed, keep(py, error))
}

/// Sets the kept exception whose text is part of this one's as its cause. An interrupt is returned
/// itself.
pub(crate) fn attach(error: PyErr) -> PyErr {
    Python::attach(|py| {
        let text = error.to_string();
        let cause = py.detach(|| {
            let mut raised = RAISED.lock().unwrap_or_else(PoisonError::into_inner);
            let at = raised.iter().position(|(kept, _)| text.contains(kept))?;
            raised.remove(at)
        });
        match cause {
            Some((_, cause)) if !cause.is_instance_of::<PyException>(py) => cause,
            Some((_, cause)) => {
                error.set_cause(py, Some(cause));
                error
            }
            None => error,
        }
    })
}
