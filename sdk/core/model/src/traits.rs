//! The traits that a model written in Rust implements, and the arguments of their methods.

use alloc::vec::Vec;

use htex_dsp::Band;
use htex_dsp::grid::level_rms;

use crate::{Error, FitCondition, Numbers, StaticDescriptor, Values};

/// Input of [`Model::fit`]: the spectrum of a texture, the recorded signal, the fit options and the
/// condition.
#[derive(Debug, Clone, Copy)]
pub struct FitInput<'a> {
    /// Band of the texture, hertz. The fitted shape has unit RMS in this band.
    pub band: Band,
    /// Frequencies of the texture spectrum, hertz, ascending: the multiples of 5 Hz in the band.
    pub frequency_hz: &'a [f64],
    /// Magnitude at each frequency, in the unit of the asset's quantity; finite and not negative.
    pub magnitude: &'a [f64],
    /// The recorded signal, band-limited, in the unit of `magnitude`. The segments of the recording
    /// are joined to one signal by overlap-add. May be empty.
    pub signal: &'a [f64],
    /// Sample rate of `signal`, hertz.
    pub signal_rate_hz: f64,
    /// The value of each fit option, in the descriptor's order. Every value lies in the range of
    /// its option.
    pub options: &'a [f64],
    /// Speed and force of the recording. Both are unknown if the model does not have the extension
    /// `htex.motion/1`. The speed or the force is also unknown if the host itself does not know it.
    pub condition: FitCondition,
}

impl FitInput<'_> {
    /// Returns the RMS of the spectrum in the band, in the unit of `magnitude`.
    pub fn level_rms(&self) -> f64 {
        level_rms(self.magnitude)
    }
}

/// Result of [`Model::fit`]: the parameters and the level.
///
/// ```
/// let fit = htex_model::Fit { parameters: vec![2.0, 5.0], level_rms: 0.01 };
/// let softer = htex_model::Fit { level_rms: 0.5 * fit.level_rms, ..fit };
/// assert_eq!(softer.level_rms, 0.005);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The parameters as one flat array: a scalar is one number; a list is its length followed by
    /// its numbers.
    pub parameters: Vec<f64>,
    /// RMS of the fitted spectrum in the band, in the unit of [`FitInput::magnitude`]. The fitted
    /// spectrum is the shape that [`Model::magnitude`] computes, multiplied by this level.
    pub level_rms: f64,
}

/// A texture model: describes a spectrum by a few parameters, and renders it.
///
/// To add a model to htex, implement this trait for the model, and [`Voice`] for the object that
/// renders its samples. Then call [`export_model!`](crate::export_model), which generates the C
/// functions of the ABI.
///
/// # How a host uses a model
///
/// All methods are pure functions: they have no `self`, and their results depend only on their
/// arguments. A host calls them in these situations:
///
/// * **Authoring.** The host calls [`fit`](Self::fit) once for each recorded condition (speed and
///   normal force), and stores the parameters in the asset.
/// * **Plots and error measures.** The host calls [`magnitude`](Self::magnitude), which computes
///   the spectrum without rendering.
/// * **Opening a voice.** The host calls [`voice_rate_hz`](Self::voice_rate_hz) and then
///   [`voice`](Self::voice), with the rate that the first call returned. The host resamples the
///   voice's output to the host's sample rate, and multiplies it by the level.
/// * **Following a finger.** The host calls [`interpolate`](Self::interpolate) to get parameters
///   between two recorded conditions, and passes them to [`Voice::retune`].
///
/// The functions that the macro generates check every argument before they call these methods. So
/// parameters and options are in the ranges of the descriptor, bands are valid, rates are from 1 Hz
/// to 10 MHz, and weights are from 0 to 1 and sum to one. An implementation need not repeat these
/// checks. A panic becomes the status [`Panicked`](crate::Status::Panicked) in a native library,
/// and ends the instance of a WASM module.
///
/// # Threads
///
/// A host may call all methods from any thread and from several threads at the same time. A host
/// may call [`interpolate`](Self::interpolate) on the render thread, so this method must not
/// allocate or wait. A host never calls [`fit`](Self::fit), [`magnitude`](Self::magnitude) or
/// [`voice`](Self::voice) on the render thread, so these three methods may allocate and may be
/// slow.
///
/// # Example
///
/// Flat noise between two frequencies, with all methods of both traits:
///
/// ```
/// use std::ops::RangeInclusive;
///
/// use htex_dsp::grid::curve_level_rms;
/// use htex_dsp::shaped_noise::{ShapedNoise, economical_rate_hz};
/// use htex_model::{
///     Band, Error, Fit, FitInput, Model, Numbers, StaticDescriptor, StaticField, Values, Voice,
///     mix,
/// };
///
/// struct Plateau;
///
/// struct PlateauVoice {
///     noise: ShapedNoise,
///     band: Band,
/// }
///
/// /// The two frequencies, and the RMS of the curve that is 1 between them.
/// fn plateau(values: &Values<'_>, band: Band) -> Result<(RangeInclusive<f64>, f64), Error> {
///     let edges = values.scalar(0)..=values.scalar(1);
///     let level = curve_level_rms(band, |hz| f64::from(edges.contains(&hz)));
///     if level > 0.0 {
///         return Ok((edges, level));
///     }
///     Err(Error::parameters("no bin of the band lies between `low_hz` and `high_hz`"))
/// }
///
/// impl Model for Plateau {
///     type Voice = PlateauVoice;
///
///     const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
///         "org.example.plateau",
///         "Plateau",
///         "1.0.0",
///         "Flat noise between two frequencies.",
///     )
///     .fields(&[
///         StaticField::scalar("low_hz", "Hz", (0.0, 2_000.0), "Lowest frequency."),
///         StaticField::scalar("high_hz", "Hz", (0.0, 2_000.0), "Highest frequency."),
///     ]);
///
///     /// Finds the two frequencies between which 90 % of the power lies.
///     fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
///         let power = || input.magnitude.iter().map(|m| m * m);
///         let total: f64 = power().sum();
///         if total == 0.0 {
///             return Err(Error::cannot_fit("the spectrum is zero"));
///         }
///         let below = |part: f64| {
///             let mut sum = 0.0;
///             let bin = power().position(|p| {
///                 sum += p;
///                 sum >= part * total
///             });
///             input.frequency_hz[bin.unwrap_or(input.frequency_hz.len() - 1)]
///         };
///         Ok(Fit { parameters: vec![below(0.05), below(0.95)], level_rms: (total / 3.0).sqrt() })
///     }
///
///     fn magnitude(
///         parameters: &Values<'_>,
///         band: Band,
///         frequency_hz: &[f64],
///         magnitude: &mut [f64],
///     ) -> Result<(), Error> {
///         let (edges, level) = plateau(parameters, band)?;
///         for (m, hz) in magnitude.iter_mut().zip(frequency_hz) {
///             *m = if band.contains(*hz) && edges.contains(hz) { 1.0 / level } else { 0.0 };
///         }
///         Ok(())
///     }
///
///     fn interpolate(
///         sets: &[Values<'_>],
///         weights: &[f64],
///         out: &mut Numbers<'_>,
///     ) -> Result<(), Error> {
///         mix::linear(sets, weights, out)
///     }
///
///     fn voice_rate_hz(_: &Values<'_>, band: Band, wanted_hz: f64) -> f64 {
///         economical_rate_hz(wanted_hz, band)
///     }
///
///     fn voice(
///         parameters: &Values<'_>,
///         band: Band,
///         rate_hz: f64,
///         seed: u64,
///     ) -> Result<PlateauVoice, Error> {
///         let (edges, _) = plateau(parameters, band)?;
///         let mut noise = ShapedNoise::new(rate_hz, band, seed);
///         noise.start(|_, hz| f64::from(edges.contains(&hz)));
///         Ok(PlateauVoice { noise, band })
///     }
/// }
///
/// impl Voice for PlateauVoice {
///     fn render(&mut self, out: &mut [f32]) {
///         self.noise.render(out);
///     }
///
///     fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
///         let (edges, _) = plateau(parameters, self.band)?;
///         self.noise.retune(|_, hz| f64::from(edges.contains(&hz)));
///         Ok(())
///     }
/// }
///
/// let values = Values::read(&Plateau::DESCRIPTOR, &[80.0, 250.0])?;
/// let rate_hz = Plateau::voice_rate_hz(&values, Band::TACTILE, 20_000.0);
/// let mut voice = Plateau::voice(&values, Band::TACTILE, rate_hz, 1)?;
/// let mut block = [0.0; 64];
/// voice.render(&mut block);
/// assert!(block.iter().any(|x| *x != 0.0));
/// # Ok::<(), Error>(())
/// ```
///
/// # Limits
///
/// * The descriptor has 1 to 32 fields, and a parameter set has at most 65,536 numbers, including
///   the lengths of lists.
/// * A voice has to render the same samples on every machine. The math functions of the platform
///   differ between machines: use `libm` or `htex_dsp` instead. Do not use fused multiply-add.
/// * `htex plugin check FILE` checks a built plugin: the ranges, the level and spectrum of the
///   sound, clicks, memory allocation and more.
///
/// # Known doubts
///
/// * At steep flanks of the spectrum, the sound and [`magnitude`](Self::magnitude) can differ by
///   one bin (5 Hz). The reason is that the window function blurs steep flanks when a spectrum is
///   measured. A model may choose whether its voice plays the blurred spectrum or the spectrum
///   before the blur.
/// * A host may replace [`Fit::level_rms`], e.g. by the RMS of the recording. A model whose
///   parameters determine the level declares [`StaticDescriptor::keeping_level`], and hosts then
///   leave the level unchanged.
pub trait Model: 'static {
    /// The voice that renders the samples of one texture.
    type Voice: Voice;

    /// Id, version, parameter fields and fit options, as hosts see them.
    const DESCRIPTOR: StaticDescriptor;

    /// Finds the parameters that describe a spectrum. The same input gives the same result.
    ///
    /// # Errors
    /// Returns [`crate::Status::CannotFit`] if the model cannot describe the spectrum, e.g. a
    /// spectrum that is zero everywhere.
    fn fit(input: &FitInput<'_>) -> Result<Fit, Error>;

    /// Writes the magnitude of the shape at each frequency in `frequency_hz`. The shape has unit
    /// RMS on the 5 Hz grid in the band, and is zero outside the band. The value at a frequency
    /// must not depend on the other frequencies of the call.
    ///
    /// # Errors
    /// Returns an error if the parameters describe no spectrum in this band.
    fn magnitude(
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error>;

    /// Interpolates parameter sets. Weights are not negative and sum to one; a set with weight 1 is
    /// returned unchanged. Most models call [`mix::linear`](crate::mix::linear). A host may pass up
    /// to eight sets on the render thread: `[render thread, no allocation, no lock, no I/O]`
    ///
    /// # Errors
    /// Returns an error if the sets cannot be interpolated, e.g. because their lists have different
    /// lengths.
    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error>;

    /// Returns the sample rate of a voice, hertz. `wanted_hz` is the host's own rate, to which the
    /// host resamples the voice's output. A model whose output contains only frequencies in the
    /// band can return a lower rate, which saves computing time.
    fn voice_rate_hz(_parameters: &Values<'_>, _band: Band, wanted_hz: f64) -> f64 {
        wanted_hz
    }

    /// Makes a voice that renders the shape at unit RMS. `rate_hz` is the voice's sample rate,
    /// which [`Self::voice_rate_hz`] returned. `seed` selects the voice's random numbers.
    ///
    /// # Errors
    /// Returns an error if the model cannot make a voice of these parameters at this rate.
    fn voice(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self::Voice, Error>;
}

/// An endless stream of samples of one texture, made by [`Model::voice`].
///
/// The host renders block after block on its render thread, and may change the parameters between
/// two blocks. The host never makes two calls for the same voice at the same time, but may move a
/// voice to another thread. Several voices of one model may render at the same time, on different
/// threads.
///
/// # What a voice guarantees
///
/// * Samples are finite, and have unit RMS in the long run; the host multiplies them by the level.
/// * The same parameters, band, rate and seed give the same samples, for all block sizes, including
///   blocks of length 0.
/// * [`render`](Self::render) and [`retune`](Self::retune) do not allocate, lock, wait, or do input
///   or output. Allocate all buffers in [`Model::voice`].
/// * The voice sets decaying state, such as the memory of a filter, to zero before it becomes
///   subnormal. Arithmetic with subnormal numbers is slow on many processors.
///
/// # Limits
///
/// [`render`](Self::render) cannot fail. A voice that cannot continue must write zeros. If a voice
/// panics, the content of `out` is undefined.
///
/// The example in the documentation of [`Model`] implements this trait. Models that play noise with
/// a given spectrum implement [`ShapedModel`](crate::shaped::ShapedModel) instead. Models that play
/// noise through a filter use [`FilteredVoice`](crate::filtered::FilteredVoice).
pub trait Voice: Send + 'static {
    /// Fills `out` with the next samples. `out` may have any length and any previous content.
    /// `[render thread, no allocation, no lock, no I/O]`
    fn render(&mut self, out: &mut [f32]);

    /// Fills `out` with the next `frames` samples of each voice, one voice after another. The
    /// samples must be bit-identical to the samples of [`Self::render`]. The default implementation
    /// calls `render` for each voice. Override it if the model renders several voices faster in one
    /// call. `[render thread, no allocation, no lock, no I/O]`
    fn render_together(voices: &mut [&mut Self], frames: usize, out: &mut [f32])
    where
        Self: Sized,
    {
        let rows = out.chunks_exact_mut(frames.max(1));
        for (voice, row) in voices.iter_mut().zip(rows) {
            voice.render(row);
        }
    }

    /// Changes the voice to other parameters. The change starts at the next sample, takes about 10
    /// ms, and makes no click. A host may call this function before every block. `[render thread,
    /// no allocation, no lock, no I/O]`
    ///
    /// # Errors
    /// Returns an error if the voice cannot change to these parameters. It then continues
    /// unchanged.
    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error>;
}
