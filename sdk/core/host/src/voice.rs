//! A voice of a model.
//!
//! This module checks the samples of all models for NaN and infinity, so the loaders need no such
//! check. No NaN passes this check. Therefore, the WASM compiler need not canonicalise NaNs in
//! every operation.
//!
//! Each voice itself interpolates the parameters between conditions, in buffers that were allocated
//! with the voice. The voice of a WASM module interpolates in the voice's own instance. Therefore a
//! voice that follows a finger neither allocates nor locks.

use htex_model::{Motion, Status};

use crate::raw::{RawVoice, Together};
use crate::{HostError, LoadedModel};

/// A voice of a model: an endless stream of samples with unit RMS, at the model's sample rate.
///
/// ```
/// use htex_host::{Band, Registry};
/// let registry = Registry::builtin();
/// let (model, band) = (registry.find("sbeta")?, Band::TACTILE);
/// let rate_hz = model.voice_rate_hz(&[2.0, 5.0], band, 20_000.0)?;
/// let mut voice = model.voice(&[2.0, 5.0], band, rate_hz, 1)?;
/// let mut block = [0.0; 64];
/// voice.render(&mut block)?;
/// voice.retune(&[3.0, 5.0])?;
/// voice.render(&mut block)?;
/// # Ok::<(), htex_host::HostError>(())
/// ```
pub struct ModelVoice {
    model: LoadedModel,
    raw: Box<dyn RawVoice>,
}

impl std::fmt::Debug for ModelVoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ModelVoice").field("model", &self.model).finish_non_exhaustive()
    }
}

impl ModelVoice {
    pub(crate) fn new(model: LoadedModel, raw: Box<dyn RawVoice>) -> Self {
        Self { model, raw }
    }

    /// Fills `out` with the next samples. Does not allocate, lock or block if the model follows the
    /// ABI.
    ///
    /// # Errors
    /// Returns an error when the model fails. `out` is then filled with zeros.
    pub fn render(&mut self, out: &mut [f32]) -> Result<(), HostError> {
        let status = self.raw.render(out);
        self.done("voice_render", status)
            .and_then(|()| self.check_finite(out))
            .inspect_err(|_| out.fill(0.0))
    }

    pub(crate) fn raw_mut(&mut self) -> &mut dyn RawVoice {
        self.raw.as_mut()
    }

    /// Returns the data for rendering this voice and others in one call, or `None` if the model
    /// does not have `htex.voices/1`.
    pub(crate) fn together(&self) -> Option<Together> {
        self.raw.together()
    }

    /// Checks that all samples are finite. A NaN would stay in the state of every filter that
    /// processes the samples later.
    pub(crate) fn check_finite(&self, out: &[f32]) -> Result<(), HostError> {
        // The loop has no early return, so that the compiler vectorises it.
        if out.iter().fold(true, |finite, x| finite & x.is_finite()) {
            return Ok(());
        }
        Err(self.not_finite(out))
    }

    /// Makes the error. This is a separate function, so that the code of the check, which runs for
    /// every block, stays small.
    #[cold]
    fn not_finite(&self, out: &[f32]) -> HostError {
        let first = out.iter().position(|x| !x.is_finite()).unwrap_or_default();
        let what = format!("sample {first} of the block is {}", out[first]);
        self.model.broken("voice_render", what)
    }

    /// Switches to other parameters without a click.
    ///
    /// # Errors
    /// Returns an error when the model refuses the parameters. The voice then continues unchanged.
    pub fn retune(&mut self, parameters: &[f64]) -> Result<(), HostError> {
        let status = self.raw.retune(parameters);
        self.done("voice_retune", status)
    }

    /// Switches to parameters interpolated between several sets. `sets` contains the concatenated
    /// parameter sets. `buffer` receives the interpolated set, which has at most
    /// [`LoadedModel::most_parameters`] numbers. The voice interpolates in its own instance,
    /// without a lock, and without allocation if the model follows the ABI.
    ///
    /// # Errors
    /// Returns an error when the model cannot interpolate, or `buffer` is too short. The voice then
    /// continues unchanged.
    pub fn retune_mix(
        &mut self,
        sets: &[f64],
        weights: &[f64],
        buffer: &mut [f64],
    ) -> Result<(), HostError> {
        let len = self.raw.interpolate(sets, weights, buffer);
        self.check("interpolate", len)?;
        match buffer.get(..len as usize) {
            Some(mixed) => self.retune(mixed),
            None => {
                let what = format!("{len} parameters for a buffer of {}", buffer.len());
                Err(self.model.broken("interpolate", what))
            }
        }
    }

    /// Sets the motion of the finger at the next sample. Does nothing if the model does not follow
    /// the motion ([`LoadedModel::follows_motion`]). Does not allocate, lock or block if the model
    /// follows the ABI.
    ///
    /// # Errors
    /// Returns an error when a number is not finite or out of range, or the model refuses it. The
    /// voice then continues unchanged.
    pub fn set_motion(&mut self, motion: Motion) -> Result<(), HostError> {
        let call = "motion_1_set";
        let refused =
            |e: htex_model::Error| self.model.error(call, Status::InvalidArgument, e.message);
        motion.check().map_err(refused)?;
        self.set_any_motion(motion)
    }

    /// For checkers of models: sets the motion as [`Self::set_motion`] does, but does not check the
    /// numbers. With this function, a checker tests which numbers the model refuses.
    ///
    /// # Errors
    /// Returns the model's error.
    pub fn set_any_motion(&mut self, motion: Motion) -> Result<(), HostError> {
        let status = self.raw.set_motion(motion);
        self.done("motion_1_set", status)
    }

    /// For checkers of models: returns the size of this voice's separate WASM memory, bytes.
    /// Returns `None` for a native voice, which uses the memory of the process.
    pub fn memory_bytes(&self) -> Option<usize> {
        self.raw.memory_bytes()
    }

    /// For checkers of models: frees the voice inside the model. This value continues to exist and
    /// keeps the handle of the freed voice. With this function, a checker tests whether the model
    /// refuses a freed handle. Apps free a voice by dropping it.
    ///
    /// # Errors
    /// Returns the model's error. On a second call, the model must return the error for an unknown
    /// handle.
    pub fn free_and_keep_handle(&mut self) -> Result<(), HostError> {
        let status = self.raw.free();
        self.done("voice_free", status)
    }

    /// Checks an answer that is 0 or a status.
    pub(crate) fn done(&self, call: &'static str, answer: i64) -> Result<(), HostError> {
        self.check(call, answer)?;
        self.model.check_zero(call, answer)
    }

    /// Checks an answer that is a length or a status.
    fn check(&self, call: &'static str, answer: i64) -> Result<(), HostError> {
        if answer >= 0 {
            return Ok(());
        }
        Err(self.model.call_error(call, answer, |out| self.raw.last_error(out)))
    }
}
