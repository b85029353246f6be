//! Passes errors from a sound card's thread to the thread that plays or records.

use std::sync::{Arc, Mutex, PoisonError};

use cpal::ErrorKind;
use htex_device::DeviceError;

/// The last error of a card's thread, if any.
#[derive(Debug, Clone, Default)]
pub(crate) struct Failure(Arc<Mutex<Option<String>>>);

impl Failure {
    /// Returns the error and keeps it.
    pub(crate) fn peek(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns the error and removes it.
    pub(crate) fn remove(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Handles errors of the card's thread. Calls `xrun` if a buffer ran empty or full. Ignores errors
/// after which the card continues. Stores all other errors.
pub(crate) fn reporter(
    failure: Failure,
    mut xrun: impl FnMut() + Send + 'static,
) -> impl FnMut(cpal::Error) + Send + 'static {
    move |error| match error.kind() {
        ErrorKind::Xrun => xrun(),
        ErrorKind::DeviceChanged | ErrorKind::RealtimeDenied => {}
        _ => {
            let mut failure = failure.0.lock().unwrap_or_else(PoisonError::into_inner);
            *failure = Some(error.to_string());
        }
    }
}

pub(crate) fn failed(name: &str, what: String) -> DeviceError {
    DeviceError::Failed { device: name.to_owned(), what }
}
