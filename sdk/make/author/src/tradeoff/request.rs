//! Request for a sweep: models and options.

use std::path::PathBuf;

use htex_format::ErrorMeasure;
use htex_host::LoadedModel;

use crate::AuthorError;
use crate::tradeoff::{ErrorAxis, Subject};

/// A model, loaded in one or more ways: `built in`, `native`, `wasm`. The first way is measured
/// with all knobs, the others with the default settings.
#[derive(Debug, Clone)]
pub struct Model {
    /// Ways of loading, each with its name and the model loaded in this way; at least one.
    pub ways: Vec<(String, LoadedModel)>,
}

/// Options of a sweep.
#[derive(Debug, Clone)]
pub struct Request {
    pub models: Vec<Model>,
    /// Whether to vary only one knob at a time, with three values each, and to time fewer runs.
    pub quick: bool,
    /// The error for fronts and knees. By default it is the held-out error. If a recording is too
    /// short to hold anything out, it is the third-octave error of the fit.
    pub error: Option<ErrorAxis>,
    /// The file of the running program or library. A journal that another build of the program
    /// wrote is not continued.
    pub program: PathBuf,
}

impl Request {
    /// Returns the error by which subjects are judged.
    ///
    /// # Errors
    /// When the held-out error is requested and nothing can be held out of a subject.
    pub(crate) fn error_of(&self, subjects: &[Subject]) -> Result<ErrorAxis, AuthorError> {
        let check = || subjects.iter().try_for_each(Subject::check_held_out);
        match self.error {
            Some(ErrorAxis::HeldOut) => check().map(|()| ErrorAxis::HeldOut),
            Some(fitted) => Ok(fitted),
            None if check().is_ok() => Ok(ErrorAxis::HeldOut),
            None => Ok(ErrorAxis::Fitted(ErrorMeasure::ThirdOctave)),
        }
    }
}
