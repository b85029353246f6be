//! Methods of synthesis that need less computation per sample than a model's voice: loops and
//! filtered noise.
//!
//! These methods work with every model.

use std::fmt;
use std::str::FromStr;

use htex_dsp::fir::Fir;
use htex_dsp::grid::Band;
use htex_dsp::noise::GaussianNoise;
use htex_dsp::resample::Resampler;
use htex_dsp::seam::Loop;
use htex_dsp::shaped_noise::economical_rate_hz;

use crate::{HostError, LoadedModel, Stream, decimal};

/// Default duration of a loop, seconds.
const LOOP_S: f64 = 2.0;
/// Default number of taps of a filter.
const TAPS: usize = 511;
const LOOP_RANGE_S: (f64, f64) = (0.1, 60.0);
const TAPS_RANGE: (usize, usize) = (15, 4095);
/// Maximum number of samples in a loop (256 MiB).
const MOST_SAMPLES: f64 = 6.7e7;
/// Duration of a loop's cross-fade, seconds. In a short loop, the cross-fade takes a quarter of the
/// loop instead.
const FADE_S: f64 = 0.1;
/// A loop leaves out the first samples of a voice and its resampler. This is their duration,
/// seconds.
const RUN_IN_S: f64 = 0.1;

/// A method of synthesis. Its text form is `streamed`, `loop:SECONDS` or `filter:TAPS`. The number
/// is optional: `loop` and `filter` have defaults.
///
/// ```
/// use htex_host::Synthesis;
/// assert_eq!("loop:1.5".parse(), Ok(Synthesis::Loop { seconds: 1.5 }));
/// assert_eq!("filter".parse(), Ok(Synthesis::Filter { taps: 511 }));
/// assert!("loop:0".parse::<Synthesis>().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Synthesis {
    /// The model's voice renders all samples. The samples do not repeat, and the spectrum follows
    /// the motion.
    #[default]
    Streamed,
    /// A part of the voice, 0.1 to 60 s long, which is rendered once and repeated with a
    /// constant-power cross-fade. A loop needs the least computation per sample, and four bytes of
    /// memory per sample. The spectrum does not change with time. It is the spectrum of the
    /// repeated part, which differs a little from the spectrum of the model.
    Loop {
        /// Length of the loop, seconds.
        seconds: f64,
    },
    /// White noise through a linear-phase filter with the model's magnitude. The filter has 15 to
    /// 4095 taps. The noise and the filter run at a lower sample rate than the output, as the noise
    /// of most models does. This rate is the output's sample rate divided by an integer, and is as
    /// low as the band allows. The filter's frequency resolution is four times this lower rate,
    /// divided by the number of taps. The spectrum does not change with time.
    Filter {
        /// Number of coefficients of the filter.
        taps: usize,
    },
}

impl fmt::Display for Synthesis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Streamed => f.write_str("streamed"),
            Self::Loop { seconds } => write!(f, "loop:{seconds}"),
            Self::Filter { taps } => write!(f, "filter:{taps}"),
        }
    }
}

impl FromStr for Synthesis {
    type Err = HostError;

    fn from_str(text: &str) -> Result<Self, HostError> {
        let (way, number) = match text.split_once(':') {
            Some((way, number)) => (way, Some(number)),
            None => (text, None),
        };
        let synthesis = match (way, number) {
            ("streamed", None) => Some(Self::Streamed),
            ("loop", None) => Some(Self::Loop { seconds: LOOP_S }),
            ("loop", Some(s)) => decimal(s).map(|seconds| Self::Loop { seconds }),
            ("filter", None) => Some(Self::Filter { taps: TAPS }),
            ("filter", Some(n)) => n.parse().ok().map(|taps| Self::Filter { taps }),
            _ => None,
        };
        let wrong = || HostError::Synthesis { text: text.chars().take(40).collect() };
        synthesis.filter(Self::is_possible).ok_or_else(wrong)
    }
}

impl Synthesis {
    fn is_possible(&self) -> bool {
        match self {
            Self::Streamed => true,
            Self::Loop { seconds } => (LOOP_RANGE_S.0..=LOOP_RANGE_S.1).contains(seconds),
            Self::Filter { taps } => (TAPS_RANGE.0..=TAPS_RANGE.1).contains(taps),
        }
    }
}

/// A sound with unit RMS and a constant spectrum: a loop, or filtered noise.
///
/// ```
/// use htex_host::{Band, Registry, StillSound, Synthesis};
/// let registry = Registry::builtin();
/// let (filter, model) = (Synthesis::Filter { taps: 255 }, registry.find("sbeta")?);
/// let mut block = [0.0; 256];
/// if let Some(mut sound) = StillSound::new(filter, model, &[2.0, 5.0], Band::TACTILE, 20_000.0, 1)? {
///     sound.render(&mut block);
/// }
/// assert!(block.iter().any(|x| *x != 0.0));
/// # Ok::<(), htex_host::HostError>(())
/// ```
#[derive(Debug)]
pub struct StillSound(Generator);

#[derive(Debug)]
enum Generator {
    Loop(Loop),
    Filter(Box<FilteredNoise>),
}

impl StillSound {
    /// Creates a sound with the parameters of `model`, at the sample rate `rate_hz`. Returns `None`
    /// for [`Synthesis::Streamed`].
    ///
    /// # Errors
    /// Returns [`HostError::Synthesis`] if the length of the loop or filter is out of range.
    /// Returns another error if the model refuses the parameters or the rate, or cannot render.
    pub fn new(
        synthesis: Synthesis,
        model: &LoadedModel,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Option<Self>, HostError> {
        if !synthesis.is_possible() {
            let text = synthesis.to_string();
            return Err(HostError::Synthesis { text });
        }
        let way = match synthesis {
            Synthesis::Streamed => return Ok(None),
            Synthesis::Loop { seconds } => {
                let stream = Stream::new(model, parameters, band, rate_hz, seed)?;
                Generator::Loop(looped(stream, seconds, rate_hz)?)
            }
            Synthesis::Filter { taps } => {
                let magnitude = |hz: &[f64]| model.magnitude(parameters, band, hz);
                let noise = FilteredNoise::new(taps, band, rate_hz, seed, magnitude)?;
                Generator::Filter(Box::new(noise))
            }
        };
        Ok(Some(Self(way)))
    }

    /// Fills `out` with the next samples. Does not allocate.
    pub fn render(&mut self, out: &mut [f32]) {
        match &mut self.0 {
            Generator::Loop(samples) => samples.render(out),
            Generator::Filter(noise) => noise.render(out),
        }
    }

    /// Returns the size of the stored samples or coefficients in memory, bytes.
    pub fn kept_bytes(&self) -> usize {
        size_of::<f32>()
            * match &self.0 {
                Generator::Loop(samples) => samples.samples().len(),
                Generator::Filter(noise) => noise.taps,
            }
    }
}

fn looped(mut stream: Stream, seconds: f64, rate_hz: f64) -> Result<Loop, HostError> {
    let fade_s = FADE_S.min(0.25 * seconds);
    let samples = |s: f64| (s * rate_hz).round() as usize;
    // Before any memory is allocated. Limiting the seconds does not limit the number of samples,
    // because the caller chooses the rate.
    if (seconds + fade_s) * rate_hz > MOST_SAMPLES {
        let text = format!("loop:{seconds} at {rate_hz} Hz");
        return Err(HostError::Synthesis { text });
    }
    stream.render(&mut vec![0.0; samples(RUN_IN_S)])?;
    let mut piece = vec![0.0; samples(seconds) + samples(fade_s)];
    stream.render(&mut piece)?;
    Ok(Loop::new(piece, samples(fade_s)).with_rms(1.0))
}

/// White noise, a filter with the model's magnitude, and a resampler to the requested rate.
#[derive(Debug)]
struct FilteredNoise {
    noise: GaussianNoise,
    gain: f32,
    fir: Fir,
    taps: usize,
    resampler: Option<Resampler>,
}

impl FilteredNoise {
    fn new(
        taps: usize,
        band: Band,
        rate_hz: f64,
        seed: u64,
        magnitude: impl Fn(&[f64]) -> Result<Vec<f64>, HostError>,
    ) -> Result<Self, HostError> {
        let noise_hz = economical_rate_hz(rate_hz, band);
        // The filter reads the curve one frequency at a time. Therefore, the model is called only
        // once here, for all frequencies.
        let grid: Vec<f64> = (0..=(0.5 * noise_hz) as usize).map(|f| f as f64).collect();
        let curve = magnitude(&grid)?;
        let at = |hz: f64| {
            let (below, part) = (hz as usize, hz.fract());
            let value = |i: usize| curve.get(i).copied().unwrap_or(0.0);
            value(below) + part * (value(below + 1) - value(below))
        };
        let fir = Fir::with_magnitude(taps, noise_hz, at);
        // The power of filtered white noise is the energy of the filter's impulse response.
        let mut response = vec![0.0f32; taps + 16];
        response[0] = 1.0;
        fir.clone().process(&mut response);
        let energy: f64 = response.iter().map(|&x| f64::from(x) * f64::from(x)).sum();
        Ok(Self {
            noise: GaussianNoise::new(seed),
            gain: if energy > 0.0 { 1.0 / energy.sqrt() } else { 0.0 } as f32,
            fir,
            taps,
            resampler: Resampler::new(noise_hz, rate_hz, band.high_hz)?,
        })
    }

    fn render(&mut self, out: &mut [f32]) {
        let (noise, fir, gain) = (&mut self.noise, &mut self.fir, self.gain);
        let mut make = |block: &mut [f32]| {
            noise.fill(block);
            block.iter_mut().for_each(|x| *x *= gain);
            fir.process(block);
        };
        match &mut self.resampler {
            Some(resampler) => resampler.process(out, &mut make),
            None => make(out),
        }
    }
}
