//! The voice: white noise through the zeros, then through the poles.
//!
//! When parameters change, the coefficients of the zeros and the reflection coefficients of the
//! poles move linearly to their new values. So every filter on the way is stable.

use alloc::boxed::Box;
use alloc::sync::Arc;

use htex_dsp::all_pole::{AllPole, GROUP, Group};
use htex_dsp::all_zero::AllZero;
use htex_dsp::band_limit::{PassedPower, band_limit};
use htex_dsp::grid::{Band, GRID_HZ};
use htex_dsp::noise::{GROUP as NOISE_GROUP, GaussianNoise};
use htex_dsp::pipeline::Pipeline;
use htex_model::{Error, Values, Voice, text};

use crate::filter::{Filter, unstable};
use crate::{MAX_ORDER, MODEL_RATE};

/// Duration of a change of parameters, seconds.
const RAMP_S: f64 = 0.010;
/// Duration that is rendered and discarded before the first sample, seconds, with a limit in
/// samples. After it the filter's transient has decayed.
const SETTLE_S: f64 = 0.5;
const SETTLE_SAMPLES: f64 = 4096.0;
/// Number of groups of samples per step.
const BLOCK: usize = 32;

/// An endless stream of filtered noise.
pub struct ArmaVoice {
    rate_hz: f64,
    /// How much power passes `edges`.
    passed: Arc<PassedPower>,
    noise: GaussianNoise,
    zeros: AllZero,
    poles: AllPole,
    edges: Pipeline,
    gain: f64,
    target: Box<Target>,
    /// Working memory in which the next target is made. It replaces the target if the parameters
    /// are valid.
    spare: Box<Target>,
    step: Step,
    ramp_len: u32,
    ramp_left: u32,
    /// Unused samples of the last group.
    ready: [f32; GROUP],
    taken: usize,
}

/// A filter, and the gain of the noise before it.
struct Target {
    filter: Filter,
    gain: f64,
}

/// What is added for each sample during a change: to the coefficients of the zeros, to the
/// reflection coefficients of the poles, and to the gain.
struct Step {
    zeros: [f64; MAX_ORDER],
    reflection: [f64; MAX_ORDER],
    gain: f64,
}

impl ArmaVoice {
    pub(crate) fn new(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, Error> {
        if rate_hz != parameters.scalar(MODEL_RATE) {
            return Err(Error::argument(text![
                "the filter runs at its model rate of ",
                parameters.scalar(MODEL_RATE),
                " Hz, not at ",
                rate_hz,
                " Hz",
            ]));
        }
        let filter = Filter::new(parameters)?;
        // Checked without the band's edges, because a filter without energy in the band may have
        // some just outside it.
        filter.level(band)?;
        let passed = PassedPower::shared(band, rate_hz);
        let gain = gain(&filter, rate_hz, &passed)?;
        let mut voice = Self {
            rate_hz,
            passed,
            noise: GaussianNoise::new(seed),
            zeros: AllZero::new(filter.zeros()).ok_or_else(unstable)?,
            poles: AllPole::with_max_order(filter.poles(), MAX_ORDER).ok_or_else(unstable)?,
            edges: band_limit(band, rate_hz),
            gain,
            target: Box::new(Target { filter, gain }),
            spare: Box::new(Target { filter: Filter::one(rate_hz), gain }),
            step: Step { zeros: [0.0; MAX_ORDER], reflection: [0.0; MAX_ORDER], gain: 0.0 },
            ramp_len: libm::ceil(RAMP_S * rate_hz).max(1.0) as u32,
            ramp_left: 0,
            ready: [0.0; GROUP],
            taken: GROUP,
        };
        let settle = libm::ceil((SETTLE_S * rate_hz).min(SETTLE_SAMPLES)) as usize;
        voice.render(&mut vec![0.0; settle.next_multiple_of(NOISE_GROUP)]);
        Ok(voice)
    }

    /// Renders the next samples in whole groups.
    fn groups(&mut self, out: &mut [Sounded]) {
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
            self.zeros.process(block.as_flattened_mut());
            self.poles.process(block);
            self.finish(block, out);
        }
    }

    /// Renders a group of samples while parameters change.
    fn changing(&mut self) -> Sounded {
        let mut out = [[0.0; GROUP]];
        self.noise.fill(out.as_flattened_mut());
        let [noise] = out;
        let group = noise.map(|x| {
            if self.ramp_left > 0 {
                self.ramp();
            }
            let driven = self.zeros.tick(self.gain * f64::from(x));
            self.poles.tick(driven)
        });
        self.finish(&mut [group], &mut out);
        out[0]
    }

    /// Limits the filter's output to the band, and stores it as output samples.
    fn finish(&mut self, block: &mut [Group], out: &mut [Sounded]) {
        self.edges.process(block.as_flattened_mut().as_chunks_mut().0);
        let out = out.as_flattened_mut().iter_mut();
        for (sample, x) in out.zip(block.as_flattened()) {
            *sample = *x as f32;
        }
    }

    /// Advances the ramp by one sample.
    fn ramp(&mut self) {
        self.ramp_left -= 1;
        let (zeros, reflection) = (self.zeros.coefficients_mut(), self.poles.reflection_mut());
        if self.ramp_left == 0 {
            let Target { filter, gain } = &*self.target;
            let orders = [zeros.len(), reflection.len()];
            zeros.copy_from_slice(&filter.zeros_of_any_order()[..orders[0]]);
            reflection.copy_from_slice(&filter.reflection()[..orders[1]]);
            self.gain = *gain;
            return;
        }
        add(zeros, &self.step.zeros);
        add(reflection, &self.step.reflection);
        self.gain += self.step.gain;
    }
}

fn add(to: &mut [f64], step: &[f64; MAX_ORDER]) {
    to.iter_mut().zip(step).for_each(|(x, step)| *x += step);
}

/// A group of output samples.
type Sounded = [f32; GROUP];

impl Voice for ArmaVoice {
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

    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        if parameters.scalar(MODEL_RATE) != self.rate_hz {
            return Err(Error::argument(text![
                "a voice at ",
                self.rate_hz,
                " Hz accepts filters of this rate only",
            ]));
        }
        let next = &mut *self.spare;
        next.filter.set(parameters)?;
        next.gain = gain(&next.filter, self.rate_hz, &self.passed)?;
        core::mem::swap(&mut self.target, &mut self.spare);
        let Target { filter, gain } = &*self.target;
        self.zeros.raise_order(filter.zeros().len());
        self.poles.raise_order(filter.poles().len());
        self.ramp_left = self.ramp_len;
        let scale = 1.0 / f64::from(self.ramp_len);
        self.step.gain = (gain - self.gain) * scale;
        let zeros = (&*self.zeros.coefficients_mut(), filter.zeros_of_any_order());
        spread(&mut self.step.zeros, zeros, scale);
        let reflection = (&*self.poles.reflection_mut(), filter.reflection());
        spread(&mut self.step.reflection, reflection, scale);
        Ok(())
    }
}

/// Writes the steps per sample from the current coefficients to other coefficients.
fn spread(step: &mut [f64; MAX_ORDER], (now, to): (&[f64], &[f64; MAX_ORDER]), scale: f64) {
    for ((step, now), to) in step.iter_mut().zip(now).zip(to) {
        *step = (to - now) * scale;
    }
}

/// Returns the gain of the noise before the filter that gives samples of unit RMS.
fn gain(filter: &Filter, rate_hz: f64, passed: &PassedPower) -> Result<f64, Error> {
    // Noise of variance s² has one-sided density 2 s² / rate, read as magnitude² = 2 P ENBW.
    let level = filter.passed_level(passed)?;
    Ok(htex_dsp::root::sqrt(rate_hz / (4.0 * 1.5 * GRID_HZ)) / level)
}
