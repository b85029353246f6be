//! A sum of sinusoids.

use crate::block::{Block, Target};
use crate::layout::MOST_TONES;
use crate::random::Random;

/// Cycles per unit of a 32-bit phase.
pub(crate) const CYCLES: f32 = 1.0 / 4_294_967_296.0;
/// Lowest power of mixed sinusoids that can be scaled to a level.
const LEAST_POWER: f32 = 1e-9;

/// A sinusoid whose frequency and amplitude glide when the motion changes. Frequencies are in
/// cycles per sample of the internal rate.
#[derive(Debug, Clone, Copy)]
struct Tone {
    phase: u32,
    frequency: f32,
    frequency_step: f32,
    amplitude: f32,
    amplitude_step: f32,
}

impl Tone {
    const ZERO: Self =
        Self { phase: 0, frequency: 0.0, frequency_step: 0.0, amplitude: 0.0, amplitude_step: 0.0 };
}

/// A sum of sinusoids.
#[derive(Debug, Clone)]
pub(crate) struct Tones {
    tones: [Tone; MOST_TONES],
    count: usize,
}

impl Tones {
    pub(crate) const ZERO: Self = Self { tones: [Tone::ZERO; MOST_TONES], count: 0 };

    /// Starts the sinusoids at their crests, or at random phases from the seed. All numbers must be
    /// zero before.
    pub(crate) fn start(&mut self, count: usize, random_phase: bool, seed: u32) {
        self.count = count;
        if random_phase {
            let mut random = Random::new(seed);
            let tones = self.tones.iter_mut();
            tones.for_each(|tone| tone.phase = random.bits());
        }
    }

    fn sounding(&mut self) -> &mut [Tone] {
        self.tones.get_mut(..self.count).unwrap_or(&mut [])
    }

    /// Starts a glide over `samples` samples to the sinusoids of a motion. If `samples` is 0, sets
    /// the sinusoids at once. Returns the level at the end of the glide.
    pub(crate) fn retune(&mut self, block: &Block<'_>, target: Target, samples: u32) -> f32 {
        let part = 1.0 / samples.max(1) as f32;
        let (mut power, mut highest) = (0.0, 0.0f32);
        for (i, tone) in self.sounding().iter_mut().enumerate() {
            let (mut frequency, mut amplitude) = (0.0, 0.0);
            for (condition, weight) in target.weights.iter() {
                let values = block.tones(condition);
                frequency += weight * values.get(2 * i);
                amplitude += weight * values.get(2 * i + 1);
            }
            power += 0.5 * amplitude * amplitude;
            // A silent sinusoid must not limit the frequencies of the others.
            if amplitude != 0.0 {
                highest = highest.max(frequency);
            }
            tone.frequency_step = frequency;
            tone.amplitude_step = amplitude;
            if samples == 0 {
                (tone.frequency, tone.amplitude) = (0.0, 0.0);
            }
        }
        let (level, gain) = if power > LEAST_POWER {
            (target.level, target.level / libm::sqrtf(power))
        } else {
            (0.0, 0.0)
        };
        let factor = block.limited(target.frequency, highest);
        for tone in self.sounding() {
            tone.frequency_step = (tone.frequency_step * factor - tone.frequency) * part;
            tone.amplitude_step = (tone.amplitude_step * gain - tone.amplitude) * part;
        }
        if samples == 0 {
            self.glide();
        }
        level
    }

    /// Starts a glide over `samples` samples to silence, without a change of frequencies. If
    /// `samples` is 0, the sinusoids are silent at once.
    pub(crate) fn fade(&mut self, samples: u32) {
        let part = 1.0 / samples.max(1) as f32;
        for tone in self.sounding() {
            tone.frequency_step = 0.0;
            tone.amplitude_step = -tone.amplitude * part;
        }
        if samples == 0 {
            self.silence();
        }
    }

    /// Advances frequencies and amplitudes by one step of the glide.
    fn glide(&mut self) {
        for tone in self.sounding() {
            tone.frequency += tone.frequency_step;
            tone.amplitude += tone.amplitude_step;
        }
    }

    /// Sets all amplitudes to zero.
    fn silence(&mut self) {
        self.sounding().iter_mut().for_each(|tone| tone.amplitude = 0.0);
    }

    /// Returns the next sample. If `is_gliding`, advances the glide first. `becomes_silent` means
    /// that this step ends a glide to silence.
    pub(crate) fn next(&mut self, is_gliding: bool, becomes_silent: bool) -> f32 {
        if is_gliding {
            self.glide();
        }
        // The steps have rounding errors, which would leave a faint rest of sound.
        if becomes_silent {
            self.silence();
        }
        self.tick()
    }

    fn tick(&mut self) -> f32 {
        let mut sum = 0.0;
        for tone in self.sounding() {
            sum += tone.amplitude * cosine(tone.phase);
            // The factor is a power of two, so the product is exact.
            let step = (tone.frequency * (1.0 / CYCLES)) as u32;
            tone.phase = tone.phase.wrapping_add(step);
        }
        sum
    }
}

/// Returns the cosine of a phase, where `2^32` is one cycle. The error is at most 4e-6. Uses
/// Taylor's series of the sine within a quarter of a cycle.
pub(crate) fn cosine(phase: u32) -> f32 {
    let x = phase as i32 as f32 * CYCLES;
    let t = 0.25 - x.abs();
    let s = t * t;
    let high = -76.705_86 + s * 42.058_693;
    t * (6.283_185_5 + s * (-41.341_7 + s * (81.605_25 + s * high)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_is_the_cosine() {
        for i in 0..100_000u32 {
            let phase = i.wrapping_mul(42_949);
            let exact = libm::cos(f64::from(phase) * core::f64::consts::TAU / 4_294_967_296.0);
            let error = f64::from(cosine(phase)) - exact;
            assert!(error.abs() < 4e-6, "{phase}: {error}");
        }
    }
}
