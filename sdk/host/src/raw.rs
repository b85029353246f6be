//! The flat calls of the model ABI over slices: what a loader provides.

use htex_model::Band;

/// Arguments of a fit, as they cross the ABI.
pub(crate) struct RawFit<'a> {
    pub(crate) band: Band,
    pub(crate) frequency_hz: &'a [f64],
    pub(crate) magnitude: &'a [f64],
    pub(crate) signal: &'a [f64],
    pub(crate) signal_rate_hz: f64,
    pub(crate) options: &'a [f64],
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
    /// The model's `interpolate`, in this voice's thread: without a lock.
    fn interpolate(&mut self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64;
    /// Asks the model to free the voice. The handle is kept: calls after this one reach the model,
    /// which answers `BadHandle`, and dropping frees nothing again.
    fn free(&mut self) -> i64;
    fn last_error(&self, out: &mut [u8]) -> i64;
}
