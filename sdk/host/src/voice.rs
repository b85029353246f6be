//! A voice of a model, freed when it is dropped.

use crate::{HostError, LoadedModel};

/// An endless stream of samples of unit RMS at the model's own rate.
#[derive(Debug)]
pub struct ModelVoice {
    model: LoadedModel,
    handle: i64,
}

impl ModelVoice {
    pub(crate) fn new(model: LoadedModel, handle: i64) -> Self {
        Self { model, handle }
    }

    /// Fills `out` with the next samples. Does not allocate, lock or block for a well-made model.
    ///
    /// # Errors
    /// When the model fails; `out` is then silent.
    pub fn render(&mut self, out: &mut [f32]) -> Result<(), HostError> {
        let answer = self.model.raw().voice_render(self.handle, out);
        self.model.check("voice_render", answer).map(|_| ()).inspect_err(|_| out.fill(0.0))
    }

    /// Changes to other parameters without a click.
    ///
    /// # Errors
    /// When the model refuses them; the voice then plays on as before.
    pub fn retune(&mut self, parameters: &[f64]) -> Result<(), HostError> {
        let answer = self.model.raw().voice_retune(self.handle, parameters);
        self.model.check("voice_retune", answer).map(|_| ())
    }
}

impl Drop for ModelVoice {
    fn drop(&mut self) {
        // The handle is live and ours; there is nobody to tell if a model cannot free it.
        self.model.raw().voice_free(self.handle);
    }
}
