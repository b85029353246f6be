//! A voice of a model.

use htex_model::{Motion, Status};

use crate::raw::{RawVoice, Together};
use crate::{HostError, LoadedModel};

/// An endless stream of samples of unit RMS at the model's own rate.
pub struct ModelVoice {
    model: LoadedModel,
    raw: Box<dyn RawVoice>,
}

impl std::fmt::Debug for ModelVoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ModelVoice")
            .field("model", &self.model)
            .finish_non_exhaustive()
    }
}

impl ModelVoice {
    pub(crate) fn new(model: LoadedModel, raw: Box<dyn RawVoice>) -> Self {
        Self { model, raw }
    }

    /// Fills `out` with the next samples. Does not allocate, lock or block for a well-made model.
    ///
    /// # Errors
    /// When the model fails; `out` is then silent.
    pub fn render(&mut self, out: &mut [f32]) -> Result<(), HostError> {
        let answer = self.raw.render(out);
        self.check("voice_render", answer)
            .and_then(|()| self.check_finite(out))
            .inspect_err(|_| out.fill(0.0))
    }

    /// What it takes to render it in one call with others of its model, if the model can.
    pub(crate) fn together(&self) -> Option<Together> {
        self.raw.together()
    }

    /// A sample that is no number would stay in every filter behind this voice.
    pub(crate) fn check_finite(&self, out: &[f32]) -> Result<(), HostError> {
        // No early end: the loop is then one of vectors.
        if out.iter().fold(true, |finite, x| finite & x.is_finite()) {
            return Ok(());
        }
        let first = out.iter().position(|x| !x.is_finite()).unwrap_or_default();
        let what = format!("sample {first} of the block is {}", out[first]);
        Err(self.model.broken("voice_render", what))
    }

    /// Changes to other parameters without a click.
    ///
    /// # Errors
    /// When the model refuses them; the voice then plays on as before.
    pub fn retune(&mut self, parameters: &[f64]) -> Result<(), HostError> {
        let answer = self.raw.retune(parameters);
        self.check("voice_retune", answer)
    }

    /// Changes to parameters between several sets, which stand one behind the other; `room` is for
    /// the mix, [`LoadedModel::most_parameters`] at most. Mixing is this voice's own: no lock, and
    /// no allocation for a well-made model.
    ///
    /// # Errors
    /// When the model cannot mix, or there is no room; the voice then plays on as before.
    pub fn retune_mix(
        &mut self,
        sets: &[f64],
        weights: &[f64],
        room: &mut [f64],
    ) -> Result<(), HostError> {
        let answer = self.raw.interpolate(sets, weights, room);
        self.check("interpolate", answer)?;
        match room.get(..answer as usize) {
            Some(mixed) => self.retune(mixed),
            None => {
                let what = format!("{answer} parameters where {} fit", room.len());
                Err(self.model.broken("interpolate", what))
            }
        }
    }

    /// Tells the motion at the next sample to a voice whose model follows it ([`LoadedModel::follows_motion`]); does
    /// nothing to others. Does not allocate, lock or block for a well-made model.
    ///
    /// # Errors
    /// When a number is not finite or beyond its range, or the model refuses it; the voice then plays on as before.
    pub fn set_motion(&mut self, motion: Motion) -> Result<(), HostError> {
        let call = "motion_1_set";
        let refused =
            |e: htex_model::Error| self.model.error(call, Status::InvalidArgument, e.message);
        motion.check().map_err(refused)?;
        self.set_any_motion(motion)
    }

    /// For checkers of models: as [`Self::set_motion`], of any numbers, so that the model shows what it refuses.
    ///
    /// # Errors
    /// What the model returns.
    pub fn set_any_motion(&mut self, motion: Motion) -> Result<(), HostError> {
        let answer = self.raw.set_motion(motion);
        self.check("motion_1_set", answer)
    }

    /// For checkers of models: size of the WASM memory that this voice has to itself, bytes; `None` for a native
    /// voice, which shares the process's.
    pub fn memory_bytes(&self) -> Option<usize> {
        self.raw.memory_bytes()
    }

    /// For checkers of models: frees the voice early and keeps its handle, so that later calls show
    /// whether the model refuses a handle that was freed. An app drops the voice instead.
    ///
    /// # Errors
    /// What the model answers; that the handle is unknown, when called a second time.
    pub fn free_and_keep_handle(&mut self) -> Result<(), HostError> {
        let answer = self.raw.free();
        self.check("voice_free", answer)
    }

    pub(crate) fn check(&self, call: &'static str, answer: i64) -> Result<(), HostError> {
        if answer >= 0 {
            return Ok(());
        }
        Err(self
            .model
            .told(call, answer, |out| self.raw.last_error(out)))
    }
}
