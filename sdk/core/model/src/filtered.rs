//! Shared code of models whose voice is white noise through a recursive filter.
//!
//! Such a model implements [`MovingFilter`] for its filter, and uses [`FilteredVoice`] as its
//! voice. This voice generates the noise, limits the output to the band, renders blocks of any
//! length, and changes parameters gradually.

use alloc::sync::Arc;

use htex_dsp::all_pole::{GROUP, Group};
use htex_dsp::band_limit::{PassedPower, band_limit};
use htex_dsp::grid::{Band, GRID_HZ};
use htex_dsp::noise::{GROUP as NOISE_GROUP, GaussianNoise};
use htex_dsp::pipeline::Pipeline;

use crate::{Error, Values, Voice, text};

/// Duration of a change of parameters, seconds.
const RAMP_S: f64 = 0.010;
/// A new voice discards output of this duration, seconds, so that the filter's transient has
/// decayed before the first sample. The next constant limits the number of these samples.
const SETTLE_S: f64 = 0.5;
const SETTLE_SAMPLES: f64 = 4096.0;
/// Number of groups of samples per step.
const BLOCK: usize = 32;

/// A group of output samples.
type GroupSamples = [f32; GROUP];

/// A filter whose coefficients move gradually from one parameter set to the next. The filter must
/// be stable after every step. All methods except [`new`](Self::new) run on the render thread and
/// must not allocate.
pub trait MovingFilter: Sized + Send + 'static {
    /// Index of the parameter field that contains the filter's sample rate in hertz.
    const RATE_FIELD: usize;

    /// Makes the filter that the parameters describe, and returns it with its level. The level is
    /// the RMS that white noise has after the filter and the band limits, if its magnitude before
    /// the filter is 1 in each bin.
    ///
    /// # Errors
    /// Returns an error if the filter is not stable, or has no finite energy in the band.
    fn new(parameters: &Values<'_>, band: Band, passed: &PassedPower)
    -> Result<(Self, f64), Error>;

    /// Sets the target: this filter becomes the target filter after `steps` calls of
    /// [`step`](Self::step). Returns the level of the target filter, computed as in
    /// [`new`](Self::new).
    ///
    /// # Errors
    /// Returns an error if the target is not stable, or has no finite energy in the band. The
    /// filter then continues unchanged.
    fn set_target(
        &mut self,
        parameters: &Values<'_>,
        passed: &PassedPower,
        steps: u32,
    ) -> Result<f64, Error>;

    /// Moves the coefficients by one step towards the target. If `is_last` is true, the
    /// coefficients reach the target.
    fn step(&mut self, is_last: bool);

    /// Filters one sample.
    fn tick(&mut self, x: f64) -> f64;

    /// Filters groups of samples in place.
    fn process(&mut self, block: &mut [Group]);

    /// Does the same as [`Voice::render_together`]. Override this function if the filter processes
    /// several voices faster in one call than in separate calls.
    fn render_together(voices: &mut [&mut FilteredVoice<Self>], frames: usize, out: &mut [f32]) {
        let rows = out.chunks_exact_mut(frames.max(1));
        for (voice, row) in voices.iter_mut().zip(rows) {
            voice.render(row);
        }
    }
}

/// The voice of a model with a [`MovingFilter`]: an endless stream of filtered noise of unit RMS.
pub struct FilteredVoice<F> {
    /// The noise before the filter.
    pub noise: GaussianNoise,
    /// The filter.
    pub filter: F,
    /// The filters that run after `filter` and limit the output to the band.
    pub edges: Pipeline,
    rate_hz: f64,
    /// The part of the power that passes `edges`.
    passed: Arc<PassedPower>,
    gain: f64,
    target_gain: f64,
    gain_step: f64,
    ramp_len: u32,
    ramp_left: u32,
    /// The last group of samples. The caller has already received the first `taken` samples of this
    /// group.
    ready: GroupSamples,
    taken: usize,
}

impl<F: MovingFilter> FilteredVoice<F> {
    /// Makes a voice whose samples have unit RMS.
    ///
    /// # Errors
    /// Returns an error if `rate_hz` is not the sample rate in the parameters, or if
    /// [`MovingFilter::new`] fails.
    pub fn new(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, Error> {
        if rate_hz != parameters.scalar(F::RATE_FIELD) {
            return Err(Error::argument(text![
                "the filter runs at its model rate of ",
                parameters.scalar(F::RATE_FIELD),
                " Hz, not at ",
                rate_hz,
                " Hz",
            ]));
        }
        let passed = PassedPower::shared(band, rate_hz);
        let (filter, level) = F::new(parameters, band, &passed)?;
        let gain = gain(rate_hz, level);
        let mut voice = Self {
            noise: GaussianNoise::new(seed),
            filter,
            edges: band_limit(band, rate_hz),
            rate_hz,
            passed,
            gain,
            target_gain: gain,
            gain_step: 0.0,
            ramp_len: rounded_up(RAMP_S * rate_hz).max(1),
            ramp_left: 0,
            ready: [0.0; GROUP],
            taken: GROUP,
        };
        let settle = rounded_up((SETTLE_S * rate_hz).min(SETTLE_SAMPLES)) as usize;
        // The number of samples is rounded up to whole groups of noise, so that the first block
        // begins at the start of a group.
        voice.render(&mut alloc::vec![0.0; settle.next_multiple_of(NOISE_GROUP)]);
        Ok(voice)
    }

    /// Returns the gain of the noise before the filter.
    pub fn gain(&self) -> f64 {
        self.gain
    }

    /// Returns how many samples of the last rendered group were already copied to the caller's
    /// blocks.
    pub fn taken(&self) -> usize {
        self.taken
    }

    /// Returns whether the parameters are constant, i.e. no gradual change is in progress.
    pub fn is_steady(&self) -> bool {
        self.ramp_left == 0
    }

    /// Renders the next samples in whole groups.
    fn groups(&mut self, out: &mut [GroupSamples]) {
        let changing = out.len().min((self.ramp_left as usize).div_ceil(GROUP));
        let (changing, steady) = out.split_at_mut(changing);
        for group in changing {
            *group = self.changing();
        }
        let mut block = [[0.0; GROUP]; BLOCK];
        for out in steady.chunks_mut(BLOCK) {
            let block = &mut block[..out.len()];
            // The output buffer is first used for the noise.
            self.noise.fill(out.as_flattened_mut());
            let noise = out.as_flattened().iter();
            for (x, noise) in block.as_flattened_mut().iter_mut().zip(noise) {
                *x = self.gain * f64::from(*noise);
            }
            self.filter.process(block);
            self.finish(block, out);
        }
    }

    /// Renders a group of samples while parameters change.
    fn changing(&mut self) -> GroupSamples {
        let mut out = [[0.0; GROUP]];
        self.noise.fill(out.as_flattened_mut());
        let [noise] = out;
        let group = noise.map(|x| {
            if self.ramp_left > 0 {
                self.ramp();
            }
            self.filter.tick(self.gain * f64::from(x))
        });
        self.finish(&mut [group], &mut out);
        out[0]
    }

    /// Limits the filter's output to the band, and stores it as output samples.
    fn finish(&mut self, block: &mut [Group], out: &mut [GroupSamples]) {
        self.edges.process(block.as_flattened_mut().as_chunks_mut().0);
        let out = out.as_flattened_mut().iter_mut();
        for (sample, x) in out.zip(block.as_flattened()) {
            *sample = *x as f32;
        }
    }

    /// Advances the ramp by one sample.
    fn ramp(&mut self) {
        self.ramp_left -= 1;
        // The last step sets the target itself, because the steps have rounding errors.
        let is_last = self.ramp_left == 0;
        self.filter.step(is_last);
        self.gain = if is_last { self.target_gain } else { self.gain + self.gain_step };
    }
}

impl<F: MovingFilter> Voice for FilteredVoice<F> {
    fn render(&mut self, out: &mut [f32]) {
        let kept = out.len().min(GROUP - self.taken);
        let (first, rest) = out.split_at_mut(kept);
        first.copy_from_slice(&self.ready[self.taken..self.taken + kept]);
        self.taken += kept;
        let (groups, last) = rest.as_chunks_mut();
        self.groups(groups);
        if !last.is_empty() {
            let mut group = [[0.0; GROUP]];
            self.groups(&mut group);
            [self.ready] = group;
            last.copy_from_slice(&self.ready[..last.len()]);
            self.taken = last.len();
        }
    }

    fn render_together(voices: &mut [&mut Self], frames: usize, out: &mut [f32]) {
        F::render_together(voices, frames, out);
    }

    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        if parameters.scalar(F::RATE_FIELD) != self.rate_hz {
            return Err(Error::argument(text![
                "a voice at ",
                self.rate_hz,
                " Hz accepts filters of this rate only",
            ]));
        }
        // The target is set before anything else changes, because if it is refused, the voice must
        // continue unchanged.
        let level = self.filter.set_target(parameters, &self.passed, self.ramp_len)?;
        self.target_gain = gain(self.rate_hz, level);
        self.ramp_left = self.ramp_len;
        self.gain_step = (self.target_gain - self.gain) * (1.0 / f64::from(self.ramp_len));
        Ok(())
    }
}

/// Rounds a number of samples up. Without `std`, `ceil` does not exist.
fn rounded_up(samples: f64) -> u32 {
    let whole = samples as u32;
    whole + u32::from(f64::from(whole) < samples)
}

/// Returns the gain by which the noise before the filter is multiplied, so that the samples have
/// unit RMS.
fn gain(rate_hz: f64, level: f64) -> f64 {
    // Noise of variance s² has the one-sided density 2 s² / rate. A measurement of it gives
    // magnitude² = 2 P ENBW.
    htex_dsp::root::sqrt(rate_hz / (4.0 * 1.5 * GRID_HZ)) / level
}

/// Checks a filter's level, by which the model divides magnitudes and samples.
///
/// # Errors
/// Returns an error if the level is not finite, or not above 0.
pub fn finite_level(level: f64) -> Result<f64, Error> {
    if level > 0.0 && level.is_finite() {
        return Ok(level);
    }
    Err(Error::parameters("the filter has no finite energy in the band"))
}

/// Makes the error of a filter that is not stable.
pub fn unstable() -> Error {
    Error::parameters("the filter is not stable: a pole lies on or outside the unit circle")
}
