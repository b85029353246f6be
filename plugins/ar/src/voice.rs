//! The voice: white noise through the all-pole filter.

use alloc::sync::Arc;

use htex_dsp::all_pole::{AllPole, GROUP, Group};
use htex_dsp::band_limit::{PassedPower, band_limit};
use htex_dsp::grid::{Band, GRID_HZ};
use htex_dsp::linear_prediction::step_down_in_place;
use htex_dsp::noise::{GROUP as NOISE_GROUP, GaussianNoise};
use htex_dsp::pipeline::Pipeline;
use htex_model::{Error, Values, Voice, text};

use crate::{COEFFICIENTS, Filter, MAX_ORDER, MODEL_RATE, finite_level, together, unstable};

/// Duration of a change of parameters, seconds.
const RAMP_S: f64 = 0.010;
/// Duration that is rendered and discarded before the first sample, seconds, with a limit in
/// samples. After it the filter's transient has decayed.
const SETTLE_S: f64 = 0.5;
const SETTLE_SAMPLES: f64 = 4096.0;
/// Number of groups of samples per step.
const BLOCK: usize = 32;

/// An endless stream of filtered noise.
pub struct AutoregressionVoice {
    rate_hz: f64,
    /// How much power passes `edges`.
    passed: Arc<PassedPower>,
    pub(crate) noise: GaussianNoise,
    pub(crate) filter: AllPole,
    pub(crate) edges: Pipeline,
    pub(crate) gain: f64,
    target: Target,
    step: Target,
    ramp_len: u32,
    pub(crate) ramp_left: u32,
    /// Unused samples of the last group.
    ready: [f32; GROUP],
    pub(crate) taken: usize,
}

/// Reflection coefficients and the gain of the noise.
#[derive(Clone, Copy)]
struct Target {
    reflection: [f64; MAX_ORDER],
    gain: f64,
}

impl AutoregressionVoice {
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
        // Checked without the band's edges, because a filter without energy in the band may have
        // some just outside it.
        Filter::new(parameters)?.level(band)?;
        let passed = PassedPower::shared(band, rate_hz);
        let target = Target::new(parameters, &passed)?;
        let mut voice = Self {
            rate_hz,
            passed,
            noise: GaussianNoise::new(seed),
            filter: AllPole::with_max_order(parameters.list(COEFFICIENTS), MAX_ORDER)
                .ok_or_else(unstable)?,
            edges: band_limit(band, rate_hz),
            gain: target.gain,
            target,
            step: target,
            ramp_len: libm::ceil(RAMP_S * rate_hz).max(1.0) as u32,
            ramp_left: 0,
            ready: [0.0; GROUP],
            taken: GROUP,
        };
        let settle = libm::ceil((SETTLE_S * rate_hz).min(SETTLE_SAMPLES)) as usize;
        // A whole number of groups of noise, so that the first block begins at the start of one.
        voice.render(&mut vec![0.0; settle.next_multiple_of(NOISE_GROUP)]);
        Ok(voice)
    }

    /// Renders the next samples in whole groups.
    fn groups(&mut self, out: &mut [[f32; GROUP]]) {
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
    fn changing(&mut self) -> [f32; GROUP] {
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
    fn finish(&mut self, block: &mut [Group], out: &mut [[f32; GROUP]]) {
        self.edges.process(block.as_flattened_mut().as_chunks_mut().0);
        let out = out.as_flattened_mut().iter_mut();
        for (sample, x) in out.zip(block.as_flattened()) {
            *sample = *x as f32;
        }
    }

    /// Advances the ramp by one sample.
    fn ramp(&mut self) {
        self.ramp_left -= 1;
        let done = self.ramp_left == 0;
        // Reflection coefficients between those of two stable filters are again inside (-1, 1). The
        // last step sets the target itself, because the steps have rounding errors.
        for (i, k) in self.filter.reflection_mut().iter_mut().enumerate() {
            *k = if done { self.target.reflection[i] } else { *k + self.step.reflection[i] };
        }
        self.gain = if done { self.target.gain } else { self.gain + self.step.gain };
    }
}

impl Voice for AutoregressionVoice {
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
        let mut rows = out.chunks_exact_mut(frames.max(1));
        let (fours, others) = voices.as_chunks_mut();
        for four in fours {
            if let [Some(a), Some(b), Some(c), Some(d)] = [(); 4].map(|()| rows.next()) {
                together::render(four, [a, b, c, d]);
            }
        }
        for (voice, row) in others.iter_mut().zip(rows) {
            voice.render(row);
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
        // Before anything else changes: if the parameters are refused, the voice must continue
        // unchanged.
        self.target = Target::new(parameters, &self.passed)?;
        self.filter.raise_order(parameters.list(COEFFICIENTS).len());
        self.ramp_left = self.ramp_len;
        let scale = 1.0 / f64::from(self.ramp_len);
        self.step.gain = (self.target.gain - self.gain) * scale;
        for (i, k) in self.filter.reflection_mut().iter().enumerate() {
            self.step.reflection[i] = (self.target.reflection[i] - k) * scale;
        }
        Ok(())
    }
}

impl Target {
    fn new(parameters: &Values<'_>, passed: &PassedPower) -> Result<Self, Error> {
        let coefficients = parameters.list(COEFFICIENTS);
        let rate_hz = parameters.scalar(MODEL_RATE);
        let mut reflection = [0.0; MAX_ORDER];
        let used = &mut reflection[..coefficients.len()];
        used.copy_from_slice(coefficients);
        if !step_down_in_place(used) {
            return Err(unstable());
        }
        // Noise of variance s² has one-sided density 2 s² / rate, read as magnitude² = 2 P ENBW.
        let level = finite_level(passed.all_pole_level_rms(coefficients))?;
        let gain = htex_dsp::root::sqrt(rate_hz / (4.0 * 1.5 * GRID_HZ)) / level;
        Ok(Self { reflection, gain })
    }
}
