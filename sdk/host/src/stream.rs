//! A voice with a resampler.

use htex_dsp::grid::Band;
use htex_dsp::resample::Resampler;

use crate::{HostError, LoadedModel, ModelVoice};

/// Samples of unit RMS at a requested rate: a voice at its own rate, and a resampler if the rates
/// differ.
///
/// ```
/// use htex_host::{Band, Registry, Stream};
/// let registry = Registry::builtin();
/// let mut stream = Stream::new(registry.find("sbeta")?, &[2.0, 5.0], Band::TACTILE, 48_000.0, 1)?;
/// let mut block = [0.0; 480];
/// stream.render(&mut block)?;
/// # Ok::<(), htex_host::HostError>(())
/// ```
#[derive(Debug)]
pub struct Stream {
    voice: ModelVoice,
    resampler: Option<Resampler>,
    voice_rate_hz: f64,
}

impl Stream {
    /// Makes a voice of `model`, and a resampler to `rate_hz` if needed.
    ///
    /// # Errors
    /// When the model refuses the parameters or the rate, or its own rate cannot be converted to `rate_hz`.
    pub fn new(
        model: &LoadedModel,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, HostError> {
        let voice_rate_hz = model.voice_rate_hz(parameters, band, rate_hz)?;
        Ok(Self {
            voice: model.voice(parameters, band, voice_rate_hz, seed)?,
            resampler: Resampler::new(voice_rate_hz, rate_hz, band.high_hz)?,
            voice_rate_hz,
        })
    }

    /// Returns the rate at which the model renders, hertz.
    pub fn voice_rate_hz(&self) -> f64 {
        self.voice_rate_hz
    }

    /// Fills `out` with the next samples. Does not allocate.
    ///
    /// # Errors
    /// When the model fails; the samples that it did not render are zero.
    pub fn render(&mut self, out: &mut [f32]) -> Result<(), HostError> {
        let Some(resampler) = &mut self.resampler else {
            return self.voice.render(out);
        };
        let mut result = Ok(());
        resampler.process(out, &mut |block| {
            if let Err(error) = self.voice.render(block) {
                result = Err(error);
            }
        });
        result
    }

    /// Changes to other parameters without a click.
    ///
    /// # Errors
    /// When the model refuses the parameters; the stream then continues unchanged.
    pub fn retune(&mut self, parameters: &[f64]) -> Result<(), HostError> {
        self.voice.retune(parameters)
    }
}
