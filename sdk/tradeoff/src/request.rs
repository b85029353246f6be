//! What to sweep.

use std::path::PathBuf;

use htex_format::ErrorMeasure;
use htex_host::LoadedModel;

use crate::{ErrorAxis, Subject, TradeoffError};

/// A model, loaded in one or more ways: `built in`, `native`, `wasm`. The first is measured
/// with all knobs, the others at their defaults.
#[derive(Debug, Clone)]
pub struct Model {
    /// Name of a way of loading, and the model loaded so; at least one.
    pub ways: Vec<(String, LoadedModel)>,
}

/// Options of a sweep.
#[derive(Debug, Clone)]
pub struct Request {
    pub models: Vec<Model>,
    /// Whether to vary one knob at a time with three values each, and to time fewer runs.
    pub quick: bool,
    /// The error of fronts and knees; by default the held-out one, and the third-octave error of
    /// what was fitted to if a recording is too short to hold anything out of it.
    pub error: Option<ErrorAxis>,
    /// The file of the program or library with this code: a journal of another build is not
    /// continued.
    pub program: PathBuf,
}

impl Request {
    /// Returns the error that subjects are graded by.
    ///
    /// # Errors
    /// When the held-out error is asked for and nothing can be held out of a subject.
    pub(crate) fn error_of(&self, subjects: &[Subject]) -> Result<ErrorAxis, TradeoffError> {
        let check = || subjects.iter().try_for_each(Subject::check_held_out);
        match self.error {
            Some(ErrorAxis::HeldOut) => check().map(|()| ErrorAxis::HeldOut),
            Some(fitted) => Ok(fitted),
            None if check().is_ok() => Ok(ErrorAxis::HeldOut),
            None => Ok(ErrorAxis::Fitted(ErrorMeasure::ThirdOctave)),
        }
    }
}
