//! Direct voltage at a display: the mean of any 100 ms of what is written.
//!
//! A carrier keeps charge and direct voltage from a finger. Whatever takes it away (a rate, an
//! effect, a clipped sample, a fault of the program), the mean shows it, so the last place before a
//! device holds it: NI cards in their session, native libraries in their host. Samples over the
//! limit are refused and the output goes to zero; they are not reduced, since a filter that takes
//! the mean away would hide the fault and change every sample.

use crate::Settings;

/// Time over which direct voltage is the mean, seconds.
pub const DIRECT_WINDOW_S: f64 = 0.1;
/// Largest direct voltage of a display that states none, volts.
pub const DIRECT_LIMIT_V: f64 = 1.0;
/// The setting of a display that states one.
pub const DIRECT_SETTING: &str = "dc_limit_v";
/// Relative tolerance: rounding to `f32`.
const ROUNDING: f64 = 1e-6;

/// The samples of the last 100 ms, and their mean.
#[derive(Debug, Clone)]
pub struct DirectVoltage {
    limit_v: f64,
    last_v: Vec<f64>,
    /// Index of the oldest sample.
    oldest: usize,
    sum_v: f64,
}

/// A mean over the limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excess {
    /// Index of the sample at which the limit is exceeded.
    pub at: usize,
    /// Mean of the 100 ms up to it, volts.
    pub mean_v: f64,
}

impl DirectVoltage {
    /// Begins at zero. A limit that is no number is [`DIRECT_LIMIT_V`].
    pub fn new(limit_v: f64, rate_hz: f64) -> Self {
        let frames = (DIRECT_WINDOW_S * rate_hz).round().max(1.0) as usize;
        Self {
            limit_v: if limit_v.is_nan() { DIRECT_LIMIT_V } else { limit_v },
            last_v: vec![0.0; frames],
            oldest: 0,
            sum_v: 0.0,
        }
    }

    /// The limit that a display's settings state, else the usual one.
    pub fn of(settings: &Settings, rate_hz: f64) -> Self {
        Self::new(settings.number(DIRECT_SETTING), rate_hz)
    }

    /// The first sample at which the mean would be over the limit, if these came next.
    pub fn excess<T: Copy + Into<f64>>(&self, samples: &[T]) -> Option<Excess> {
        let frames = self.last_v.len();
        let most_v = self.limit_v * (1.0 + ROUNDING) * frames as f64;
        let (old, new) = self.last_v.split_at(self.oldest);
        let before = new.iter().chain(old).copied();
        let leaving = before.chain(samples.iter().map(|v| (*v).into()));
        let mut sum_v = self.sum_v;
        for (at, (sample, leaves)) in samples.iter().zip(leaving).enumerate() {
            sum_v += (*sample).into() - leaves;
            if sum_v.abs() > most_v {
                let mean_v = sum_v / frames as f64;
                return Some(Excess { at, mean_v });
            }
        }
        None
    }

    /// Takes samples that were given to the device.
    pub fn take<T: Copy + Into<f64>>(&mut self, samples: &[T]) {
        for sample in samples {
            let sample: f64 = (*sample).into();
            self.sum_v += sample - self.last_v[self.oldest];
            self.last_v[self.oldest] = sample;
            self.oldest += 1;
            if self.oldest == self.last_v.len() {
                self.oldest = 0;
                // Rounding errors do not add up.
                self.sum_v = self.last_v.iter().sum();
            }
        }
    }

    /// Mean of the last 100 ms, volts.
    pub fn mean_v(&self) -> f64 {
        self.sum_v / self.last_v.len() as f64
    }

    /// The sample before the last one, the one before that, and so on, back and forth within the
    /// last 100 ms.
    pub fn mirrored(&self) -> impl Iterator<Item = f64> {
        let frames = self.last_v.len();
        let newest = self.oldest + frames - 1;
        let period = (2 * frames).saturating_sub(2).max(1);
        (1..).map(move |back: usize| {
            let into = back % period;
            let back = into.min(period - into);
            self.last_v[(newest - back) % frames]
        })
    }

    /// The limit, volts.
    pub fn limit_v(&self) -> f64 {
        self.limit_v
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of each window, computed from all samples.
    fn first_over(samples: &[f64], frames: usize, limit_v: f64) -> Option<usize> {
        (0..samples.len()).find(|&i| {
            let from = (i + 1).saturating_sub(frames);
            let sum: f64 = samples[from..=i].iter().sum();
            sum.abs() > limit_v * (1.0 + ROUNDING) * frames as f64
        })
    }

    #[test]
    fn the_mean_of_any_window_is_found_whatever_the_blocks() {
        let rate_hz = 1_000.0;
        let wave = |i: usize| {
            let slow = if i > 700 { 0.02 * (i - 700) as f64 } else { 0.0 };
            20.0 * (0.9 * i as f64).sin() + slow
        };
        let samples: Vec<f64> = (0..2_000).map(wave).collect();
        for limit_v in [0.2, 0.5, 1.0, 3.0, 50.0] {
            let expected = first_over(&samples, 100, limit_v);
            for block in [1, 7, 100, 333, 2_000] {
                let mut direct = DirectVoltage::new(limit_v, rate_hz);
                let found = samples.chunks(block).enumerate().find_map(|(i, part)| {
                    let excess = direct.excess(part);
                    direct.take(part);
                    excess.map(|excess| i * block + excess.at)
                });
                assert_eq!(found, expected, "{limit_v} V, blocks of {block}");
            }
        }
    }

    #[test]
    fn the_past_is_read_backwards() {
        let mut direct = DirectVoltage::new(1.0, 40.0);
        direct.take(&[9.0, 9.0, 1.0, 2.0, 3.0, 4.0]);
        let past: Vec<f64> = direct.mirrored().take(9).collect();
        assert_eq!(past, [3.0, 2.0, 1.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0]);
    }
}
