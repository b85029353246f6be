//! Request for a sweep: models and options.

use std::path::PathBuf;

use htex_format::ErrorMeasure;
use htex_host::LoadedModel;

use crate::AuthorError;
use crate::tradeoff::{ErrorAxis, Subject};

/// A model, loaded in one or more ways: `built in`, `native`, `wasm`. The model that is loaded in
/// the first way is measured with all values of the knobs. In the other ways, the model is measured
/// only with the default settings.
#[derive(Debug, Clone)]
pub struct Model {
    /// Ways of loading, at least one. Each entry contains the name of the way, and the model that
    /// was loaded in this way.
    pub ways: Vec<(String, LoadedModel)>,
}

/// Options of a sweep.
#[derive(Debug, Clone)]
pub struct Request {
    pub models: Vec<Model>,
    /// Whether to measure less: only one knob is varied at a time, each knob has three values, and
    /// fewer runs are timed.
    pub quick: bool,
    /// The error from which Pareto fronts and their knees are computed. If `None`, the held-out
    /// error is used. If a recording is too short to hold out a part of it, the third-octave error
    /// of the fit is used instead.
    pub error: Option<ErrorAxis>,
    /// The file of the running program or library. A sweep does not continue a journal that another
    /// build of this program wrote.
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
