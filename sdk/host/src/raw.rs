//! The flat calls of the model ABI over slices: what a loader provides.

use htex_model::abi::ModelTable;
use htex_model::voices_1::VoicesRenderFn;
use htex_model::{Band, FitCondition, Motion};

/// Arguments of a fit, as they cross the ABI.
pub(crate) struct RawFit<'a> {
    pub(crate) band: Band,
    pub(crate) frequency_hz: &'a [f64],
    pub(crate) magnitude: &'a [f64],
    pub(crate) signal: &'a [f64],
    pub(crate) signal_rate_hz: f64,
    pub(crate) options: &'a [f64],
    /// For models that follow the motion.
    pub(crate) condition: FitCondition,
}

/// One model's functions, wherever they live. Answers are those of `htex_model::abi`: a length or
/// a status.
pub(crate) trait RawModel: Send + Sync {
    fn abi_version(&self) -> u32;
    fn descriptor(&self, out: &mut [u8]) -> i64;
    fn last_error(&self, out: &mut [u8]) -> i64;
    fn fit(&self, call: &RawFit<'_>, parameters: &mut [f64], level_rms: &mut f64) -> i64;
    fn magnitude(
        &self,
        parameters: &[f64],
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> i64;
    fn interpolate(&self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64;
    fn extension(&self, id: &[u8]) -> i64;
    /// Whether the model has the extension `htex.motion/1`.
    fn follows_motion(&self) -> bool;
    fn voice_rate(&self, parameters: &[f64], band: Band, wanted_hz: f64) -> f64;
    /// Makes a voice, or answers a status.
    fn voice_new(
        &self,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Box<dyn RawVoice>, i64>;
}

/// One voice of a model; freed when it is dropped.
pub(crate) trait RawVoice: Send {
    fn render(&mut self, out: &mut [f32]) -> i64;
    fn retune(&mut self, parameters: &[f64]) -> i64;
    /// Tells the motion at the next sample; does nothing where the model has no `htex.motion/1`.
    fn set_motion(&mut self, motion: Motion) -> i64;
    /// The model's `interpolate`, in this voice's thread: without a lock.
    fn interpolate(&mut self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64;
    /// Asks the model to free the voice. The handle is kept: calls after this one reach the model,
    /// which answers `BadHandle`, and dropping frees nothing again.
    fn free(&mut self) -> i64;
    /// What it takes to render this voice in one call with others of its model, if the model can.
    fn together(&self) -> Option<Together> {
        None
    }
    /// Bytes of the memory that the voice has to itself; `None` outside a sandbox.
    fn memory_bytes(&self) -> Option<usize> {
        None
    }
    fn last_error(&self, out: &mut [u8]) -> i64;
}

/// A voice's part in a call that renders several.
pub(crate) struct Together {
    pub(crate) render: VoicesRenderFn,
    /// Of the model, by whose place in memory it is known.
    pub(crate) table: &'static ModelTable,
    pub(crate) handle: i64,
}
