//! The traits of a model in Rust, and their arguments.

use alloc::vec::Vec;

use htex_dsp::Band;

use crate::{Error, FitCondition, Numbers, StaticDescriptor, Values};

/// Input of a fit.
#[derive(Debug, Clone, Copy)]
pub struct FitInput<'a> {
    /// Band of the texture, hertz; the fitted shape has unit RMS in it.
    pub band: Band,
    /// Frequencies of the texture spectrum, ascending, hertz (the 5 Hz grid in the band).
    pub frequency_hz: &'a [f64],
    /// Magnitudes at those frequencies, in the unit of the asset's quantity, finite and not
    /// negative.
    pub magnitude: &'a [f64],
    /// The recording's segments overlap-added to one signal, in the same unit, band-limited; may be
    /// empty.
    pub signal: &'a [f64],
    /// Rate of `signal`, hertz.
    pub signal_rate_hz: f64,
    /// One value for each of the descriptor's options, in range.
    pub options: &'a [f64],
    /// The motion at which the recording was made. Unknown for models without the extension
    /// `htex.motion/1`, and if the host does not know it.
    pub condition: FitCondition,
}

/// Result of a fit.
///
/// ```
/// let fit = htex_model::Fit { parameters: vec![2.0, 5.0], level_rms: 0.01 };
/// let softer = htex_model::Fit { level_rms: 0.5 * fit.level_rms, ..fit };
/// assert_eq!(softer.level_rms, 0.005);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The flat array of parameters.
    pub parameters: Vec<f64>,
    /// RMS of the fitted magnitude in the band, in the unit of [`FitInput::magnitude`]: shape ×
    /// level is the fitted spectrum.
    pub level_rms: f64,
}

/// A texture model: a pure description of a spectrum by a few parameters.
///
/// The macro's functions check every argument before they call these methods: parameters fit the
/// descriptor, options are in range, bands are valid, rates are finite and positive.
pub trait Model: 'static {
    /// Renders the samples of one texture.
    type Voice: Voice;

    /// Id, version, fields and options, as hosts see them.
    const DESCRIPTOR: StaticDescriptor;

    /// Finds the parameters of a spectrum.
    ///
    /// # Errors
    /// [`crate::Status::CannotFit`] when the model cannot describe the spectrum.
    fn fit(input: &FitInput<'_>) -> Result<Fit, Error>;

    /// Writes the shape's magnitude at `frequency_hz`, of unit RMS on the 5 Hz grid in the band;
    /// zero outside the band. Does not synthesise.
    ///
    /// # Errors
    /// When the parameters describe no spectrum.
    fn magnitude(
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error>;

    /// Interpolates parameter sets; weights are not negative and sum to one.
    /// `[render thread, no allocation, no lock, no I/O]`
    ///
    /// # Errors
    /// When the sets cannot be interpolated.
    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error>;

    /// Returns the rate at which a voice renders for a requested rate of `wanted_hz`; the host
    /// converts between them.
    fn voice_rate_hz(_parameters: &Values<'_>, _band: Band, wanted_hz: f64) -> f64 {
        wanted_hz
    }

    /// Makes a voice that renders the shape at unit RMS at `rate_hz`, a rate that
    /// [`Self::voice_rate_hz`] returned.
    ///
    /// # Errors
    /// When no voice can be made of these parameters at this rate.
    fn voice(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self::Voice, Error>;
}

/// An endless stream of samples. Equal parameters, rates and seeds give equal samples, for all
/// block sizes.
pub trait Voice: Send + 'static {
    /// Fills `out` with the next samples. `[render thread, no allocation, no lock, no I/O]`
    fn render(&mut self, out: &mut [f32]);

    /// Fills `out` with the next `frames` samples of each voice, one voice after another,
    /// bit-identical to [`Self::render`] of each. A model that renders several voices faster in one
    /// call than separately overrides this. `[render thread, no allocation, no lock, no I/O]`
    fn render_together(voices: &mut [&mut Self], frames: usize, out: &mut [f32])
    where
        Self: Sized,
    {
        let rows = out.chunks_exact_mut(frames.max(1));
        for (voice, row) in voices.iter_mut().zip(rows) {
            voice.render(row);
        }
    }

    /// Changes to other parameters without a click, beginning with the next sample.
    /// `[render thread, no allocation, no lock, no I/O]`
    ///
    /// # Errors
    /// When the voice cannot change to these parameters; it then continues unchanged.
    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error>;
}
