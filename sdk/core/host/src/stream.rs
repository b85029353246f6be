//! A source of samples with an optional resampler.

use htex_dsp::grid::Band;
use htex_dsp::resample::Resampler;

use crate::{HostError, LoadedModel, ModelVoice};

/// A stream of samples at a requested rate. A stream contains a source of samples, such as a voice.
/// If the rates of the source and the stream differ, the stream also contains a resampler.
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
pub struct Stream<S = ModelVoice> {
    source: S,
    source_rate_hz: f64,
    resampler: Option<Resampler>,
}

impl<S> Stream<S> {
    /// Creates a stream at `rate_hz` from a source. The source has samples at `source_rate_hz` and
    /// frequencies up to `top_hz`. `own_rate` is true if the source cannot render at any other rate
    /// ([`LoadedModel::has_own_rate`]).
    ///
    /// # Errors
    /// Returns an error if one rate cannot be converted to the other.
    pub fn from_source(
        source: S,
        source_rate_hz: f64,
        rate_hz: f64,
        top_hz: f64,
        own_rate: bool,
    ) -> Result<Self, HostError> {
        let resampler = if own_rate {
            Resampler::of_own_rate(source_rate_hz, rate_hz, top_hz)?
        } else {
            Resampler::new(source_rate_hz, rate_hz, top_hz)?
        };
        Ok(Self { resampler, source, source_rate_hz })
    }

    pub fn source(&self) -> &S {
        &self.source
    }

    pub fn source_mut(&mut self) -> &mut S {
        &mut self.source
    }

    /// Fills `out` with the next samples. `render` is a function that fills a block with samples of
    /// the source. This function does not allocate.
    ///
    /// # Errors
    /// The last error of `render`.
    pub fn render_by<E>(
        &mut self,
        out: &mut [f32],
        render: impl Fn(&mut S, &mut [f32]) -> Result<(), E>,
    ) -> Result<(), E> {
        let Some(resampler) = &mut self.resampler else {
            return render(&mut self.source, out);
        };
        let mut result = Ok(());
        resampler.process(out, &mut |block| {
            // The resampler cannot stop halfway, so an error is returned only at the end.
            if let Err(error) = render(&mut self.source, block) {
                result = Err(error);
            }
        });
        result
    }
}

impl Stream {
    /// Creates a voice of `model`, and a resampler to `rate_hz` if needed.
    ///
    /// # Errors
    /// Returns an error if the model refuses the parameters or the rate, or if its own rate cannot
    /// be converted to `rate_hz`.
    pub fn new(
        model: &LoadedModel,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, HostError> {
        let voice_rate_hz = model.voice_rate_hz(parameters, band, rate_hz)?;
        let voice = model.voice(parameters, band, voice_rate_hz, seed)?;
        let own_rate = model.has_own_rate(parameters, band, voice_rate_hz)?;
        Self::from_source(voice, voice_rate_hz, rate_hz, band.high_hz, own_rate)
    }

    /// Returns the sample rate of the model's voice, hertz.
    pub fn voice_rate_hz(&self) -> f64 {
        self.source_rate_hz
    }

    /// Fills `out` with the next samples. Does not allocate.
    ///
    /// # Errors
    /// When the model fails. After an error, the samples that the model did not render are zero.
    pub fn render(&mut self, out: &mut [f32]) -> Result<(), HostError> {
        self.render_by(out, ModelVoice::render)
    }

    /// Changes to other parameters without a click.
    ///
    /// # Errors
    /// Returns an error if the model refuses the parameters. The stream then continues unchanged.
    pub fn retune(&mut self, parameters: &[f64]) -> Result<(), HostError> {
        self.source.retune(parameters)
    }
}
