//! Traits for the calls of the model ABI. The calls take slices instead of pointers. Each loader of
//! models implements these traits.
//!
//! The code that uses models calls only these traits, so it does not depend on the loader.
//! [`crate::table`] implements the traits for built-in models and native libraries, `wasm` for
//! modules, and [`crate::runtime`] for models that are objects.

use htex_model::abi::{ABI_MAJOR, ABI_MARKER, ModelTable};
use htex_model::voices_1::VoicesRenderFn;
use htex_model::{Band, FitInput, Motion};

use crate::HostError;
use crate::probe::{ProbeArguments, Unusable};

/// The functions of one model. As in `htex_model::abi`, a returned number is a length or a status.
pub(crate) trait RawModel: Send + Sync {
    fn abi_version(&self) -> u32;
    fn descriptor(&self, out: &mut [u8]) -> i64;
    fn last_error(&self, out: &mut [u8]) -> i64;
    /// Fits the model. Only a model that follows the motion uses `input.condition`.
    #[cfg_attr(not(feature = "fit"), allow(dead_code))]
    fn fit(&self, input: &FitInput<'_>, parameters: &mut [f64], level_rms: &mut f64) -> i64;
    fn magnitude(
        &self,
        parameters: &[f64],
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> i64;
    fn interpolate(&self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64;
    fn extension(&self, id: &[u8]) -> i64;
    /// Returns whether the model has the extension `htex.motion/1`.
    fn follows_motion(&self) -> bool;
    /// For checkers: returns the model's answers to calls with unusable arrays.
    fn unusable_arrays(&self, _: &ProbeArguments<'_>) -> Option<Vec<Unusable>> {
        None
    }
    /// For checkers: renders two equal voices, one after the other, in one instance of a module.
    fn two_voices(
        &self,
        _parameters: &[f64],
        _band: Band,
        _rate_hz: f64,
        _seed: u64,
        _out: &mut [Vec<f32>; 2],
    ) -> Option<i64> {
        None
    }
    fn voice_rate(&self, parameters: &[f64], band: Band, wanted_hz: f64) -> f64;
    /// Creates a voice. The error is a status code.
    fn voice_new(
        &self,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Box<dyn RawVoice>, i64>;
}

/// One voice of a model, freed when it is dropped.
pub(crate) trait RawVoice: Send {
    fn render(&mut self, out: &mut [f32]) -> i64;
    fn retune(&mut self, parameters: &[f64]) -> i64;
    /// Sets the motion at the next sample; does nothing for a model without `htex.motion/1`.
    fn set_motion(&mut self, motion: Motion) -> i64;
    /// Calls the model's `interpolate` in the thread that uses this voice, without a lock.
    fn interpolate(&mut self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64;
    /// Frees the voice in the model but keeps the handle. Later calls reach the model, which
    /// returns `BadHandle`. Dropping does not free the voice again.
    fn free(&mut self) -> i64;
    /// Returns the data for rendering this voice and others in one call, or `None` if the model
    /// does not have `htex.voices/1`.
    fn together(&self) -> Option<Together> {
        None
    }
    /// Returns the size of the voice's separate memory, bytes. Returns `None` if the voice does not
    /// run in a sandbox.
    fn memory_bytes(&self) -> Option<usize> {
        None
    }
    fn last_error(&self, out: &mut [u8]) -> i64;
}

/// A voice's data for a call that renders several voices.
pub(crate) struct Together {
    pub(crate) render: VoicesRenderFn,
    /// The model's table, whose address identifies the model.
    pub(crate) table: &'static ModelTable,
    pub(crate) handle: i64,
}

/// Checks that a model has this ABI's major version.
pub(crate) fn check_marker(origin: &str, marker: u32) -> Result<(), HostError> {
    // The lowest byte is the minor version, which changes only when optional exports are added.
    if marker >> 8 == ABI_MARKER >> 8 {
        return Ok(());
    }
    Err(HostError::Broken {
        model: origin.to_owned(),
        call: "htex_model_abi_version",
        what: format!("its marker is {marker:#x}; this host loads models of ABI {ABI_MAJOR}.x"),
    })
}
