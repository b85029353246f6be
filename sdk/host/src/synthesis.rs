//! Cheaper ways to play a spectrum than to stream a model's voice.

use std::fmt;
use std::str::FromStr;

use htex_dsp::fir::Fir;
use htex_dsp::grid::Band;
use htex_dsp::noise::GaussianNoise;
use htex_dsp::resample::Resampler;
use htex_dsp::seam::Loop;
use htex_dsp::shaped_noise::economical_rate_hz;

use crate::{HostError, LoadedModel, Stream};

/// Seconds of a loop, and taps of a filter, when none are said.
const LOOP_S: f64 = 2.0;
const TAPS: usize = 511;
const LOOP_RANGE_S: (f64, f64) = (0.1, 60.0);
const TAPS_RANGE: (usize, usize) = (15, 4095);
/// Most samples of a loop, 256 MiB.
const MOST_SAMPLES: f64 = 6.7e7;
/// Length of the cross-fade of a loop: at most a quarter of it.
const FADE_S: f64 = 0.1;
/// What a voice and its resampler play first is left out of a loop.
const RUN_IN_S: f64 = 0.1;

/// How samples are made of a model's parameters; as text `streamed`, `loop:SECONDS`,
/// `filter:TAPS`, where the number may be left out.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Synthesis {
    /// The model's voice: it never repeats, and its spectrum follows the motion.
    #[default]
    Streamed,
    /// So many seconds of the voice, 0.1 to 60, rendered once and played again and again over a
    /// cross-fade that keeps the power. The cheapest sample there is, for four bytes of memory a
    /// sample; the spectrum is that of one piece of noise, and stays.
    Loop {
        /// Length of a round, seconds.
        seconds: f64,
    },
    /// White noise through a linear-phase filter of the magnitude, of 15 to 4095 taps at the rate
    /// that models of noise work at. It resolves four times that rate over the taps, in hertz, and
    /// the spectrum stays.
    Filter {
        /// Coefficients of the filter.
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
            ("loop", Some(s)) => s.parse().ok().map(|seconds| Self::Loop { seconds }),
            ("filter", None) => Some(Self::Filter { taps: TAPS }),
            ("filter", Some(n)) => n.parse().ok().map(|taps| Self::Filter { taps }),
            _ => None,
        };
        let wrong = || HostError::Synthesis {
            text: text.chars().take(40).collect(),
        };
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

/// Samples of unit RMS whose spectrum stays as it was made: a loop, or filtered noise.
#[derive(Debug)]
pub struct StillSound(Way);

#[derive(Debug)]
enum Way {
    Loop(Loop),
    Filter(Box<FilteredNoise>),
}

impl StillSound {
    /// The sound of `model` at `rate_hz`; none when it is to be streamed.
    ///
    /// # Errors
    /// [`HostError::Synthesis`] for a length out of range, or when the model refuses the parameters
    /// or the rate, or cannot render.
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
                Way::Loop(looped(stream, seconds, rate_hz)?)
            }
            Synthesis::Filter { taps } => {
                let magnitude = |hz: &[f64]| model.magnitude(parameters, band, hz);
                let noise = FilteredNoise::new(taps, band, rate_hz, seed, magnitude)?;
                Way::Filter(Box::new(noise))
            }
        };
        Ok(Some(Self(way)))
    }

    /// Fills `out` with the next samples. Does not allocate.
    pub fn render(&mut self, out: &mut [f32]) {
        match &mut self.0 {
            Way::Loop(samples) => samples.render(out),
            Way::Filter(noise) => noise.render(out),
        }
    }

    /// Bytes of sound or coefficients that are kept while it plays.
    pub fn kept_bytes(&self) -> usize {
        size_of::<f32>()
            * match &self.0 {
                Way::Loop(samples) => samples.samples().len(),
                Way::Filter(noise) => noise.taps,
            }
    }
}

fn looped(mut stream: Stream, seconds: f64, rate_hz: f64) -> Result<Loop, HostError> {
    let fade_s = FADE_S.min(0.25 * seconds);
    let samples = |s: f64| (s * rate_hz).round() as usize;
    if (seconds + fade_s) * rate_hz > MOST_SAMPLES {
        let text = format!("loop:{seconds} at {rate_hz} Hz");
        return Err(HostError::Synthesis { text });
    }
    stream.render(&mut vec![0.0; samples(RUN_IN_S)])?;
    let mut piece = vec![0.0; samples(seconds) + samples(fade_s)];
    stream.render(&mut piece)?;
    Ok(Loop::new(piece, samples(fade_s)).with_rms(1.0))
}

/// White noise, a filter of the magnitude, and what brings it to the wanted rate.
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
        // The filter asks frequency by frequency; the model is asked once.
        let grid: Vec<f64> = (0..=(0.5 * noise_hz) as usize).map(|f| f as f64).collect();
        let curve = magnitude(&grid)?;
        let at = |hz: f64| {
            let (below, part) = (hz as usize, hz.fract());
            let value = |i: usize| curve.get(i).copied().unwrap_or(0.0);
            value(below) + part * (value(below + 1) - value(below))
        };
        let fir = Fir::with_magnitude(taps, noise_hz, at);
        // The power of filtered white noise is the energy of the filter's answer to one.
        let mut answer = vec![0.0f32; taps + 16];
        answer[0] = 1.0;
        fir.clone().process(&mut answer);
        let energy: f64 = answer.iter().map(|&x| f64::from(x) * f64::from(x)).sum();
        Ok(Self {
            noise: GaussianNoise::new(seed),
            gain: if energy > 0.0 {
                1.0 / energy.sqrt()
            } else {
                0.0
            } as f32,
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
