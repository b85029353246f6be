//! Direct voltage at a display: the mean of the written voltage over a window of 100 ms.
//!
//! A carrier protects a finger from charge and direct voltage. Many faults can remove the carrier,
//! such as a wrong rate, an effect, a clipped sample or a fault of the program. The mean voltage
//! reveals all of these faults. Therefore, the mean voltage is limited by the last part of the
//! program through which the samples pass before they reach the device. For NI cards, this part is
//! the adapter's session; for native libraries, it is the host. If the mean voltage would exceed
//! the limit, the samples are refused and the output goes to zero. The samples are not corrected,
//! because a filter that removes the mean would hide the fault and change every sample.

use crate::Settings;

/// Length of the window whose mean is the direct voltage, seconds.
const DIRECT_WINDOW_S: f64 = 0.1;
/// Default limit of the direct voltage, volts, for a display whose settings state no limit.
pub const DIRECT_LIMIT_V: f64 = 1.0;
/// Name of the setting in which a display states its limit of the direct voltage.
pub const DIRECT_SETTING: &str = "dc_limit_v";
/// Relative tolerance, for rounding to `f32`.
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

/// A mean that exceeds the limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excess {
    /// Index of the sample at which the limit is exceeded.
    pub at: usize,
    /// Mean of the 100 ms that end with this sample, volts.
    pub mean_v: f64,
}

impl DirectVoltage {
    /// Creates the window, filled with 100 ms of zero volts. If `limit_v` is NaN,
    /// [`DIRECT_LIMIT_V`] applies.
    pub fn new(limit_v: f64, rate_hz: f64) -> Self {
        let frames = (DIRECT_WINDOW_S * rate_hz).round().max(1.0) as usize;
        Self {
            limit_v: if limit_v.is_nan() { DIRECT_LIMIT_V } else { limit_v },
            last_v: vec![0.0; frames],
            oldest: 0,
            sum_v: 0.0,
        }
    }

    /// Takes the limit from a display's settings, or [`DIRECT_LIMIT_V`] if they have none.
    pub(crate) fn from_settings(settings: &Settings, rate_hz: f64) -> Self {
        Self::new(settings.number(DIRECT_SETTING), rate_hz)
    }

    /// Returns the first sample at which the mean would exceed the limit if the device played
    /// `samples` next.
    pub fn excess<T: Copy + Into<f64>>(&self, samples: &[T]) -> Option<Excess> {
        let frames = self.last_v.len();
        let most_v = self.limit_v * (1.0 + ROUNDING) * frames as f64;
        let (old, new) = self.last_v.split_at(self.oldest);
        let before = new.iter().chain(old).copied();
        // If the block is longer than the window, the first samples of the block leave the window
        // before the block ends.
        let leaving = before.chain(samples.iter().map(|v| (*v).into()));
        let mut sum_v = self.sum_v;
        for (at, (sample, leaves)) in samples.iter().zip(leaving).enumerate() {
            sum_v += (*sample).into() - leaves;
            // A sum that is not a number must not count as a small one.
            if sum_v.is_nan() || sum_v.abs() > most_v {
                let mean_v = sum_v / frames as f64;
                return Some(Excess { at, mean_v });
            }
        }
        None
    }

    /// Adds samples to the window after the device has accepted them.
    pub fn push<T: Copy + Into<f64>>(&mut self, samples: &[T]) {
        for sample in samples {
            let sample: f64 = (*sample).into();
            self.sum_v += sample - self.last_v[self.oldest];
            self.last_v[self.oldest] = sample;
            self.oldest += 1;
            if self.oldest == self.last_v.len() {
                self.oldest = 0;
                // The sum is computed anew once per window, so that rounding errors do not
                // accumulate.
                self.sum_v = self.last_v.iter().sum();
            }
        }
    }

    /// Returns the mean of the last 100 ms, volts.
    pub fn mean_v(&self) -> f64 {
        self.sum_v / self.last_v.len() as f64
    }

    /// Iterates backwards over the last 100 ms, beginning with the sample before the newest sample.
    /// The direction reverses at both ends of the window, so the iterator never ends.
    pub fn mirrored(&self) -> impl Iterator<Item = f64> {
        let frames = self.last_v.len();
        // One window is added, so that the index below is never negative.
        let newest = self.oldest + frames - 1;
        let period = (2 * frames).saturating_sub(2).max(1);
        (1..).map(move |back: usize| {
            let into = back % period;
            let back = into.min(period - into);
            self.last_v[(newest - back) % frames]
        })
    }

    /// Returns the limit, volts.
    pub fn limit_v(&self) -> f64 {
        self.limit_v
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Finds the first window over the limit by computing each mean from all of its samples.
    fn first_over(samples: &[f64], frames: usize, limit_v: f64) -> Option<usize> {
        (0..samples.len()).find(|&i| {
            let from = (i + 1).saturating_sub(frames);
            let sum: f64 = samples[from..=i].iter().sum();
            sum.abs() > limit_v * (1.0 + ROUNDING) * frames as f64
        })
    }

    #[test]
    fn what_is_not_a_number_is_an_excess() {
        let direct = DirectVoltage::new(1.0, 1_000.0);
        assert_eq!(direct.excess(&[0.5, f64::NAN, 0.5]).unwrap().at, 1);
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
                    direct.push(part);
                    excess.map(|excess| i * block + excess.at)
                });
                assert_eq!(found, expected, "{limit_v} V, blocks of {block}");
            }
        }
    }

    #[test]
    fn the_past_is_read_backwards() {
        let mut direct = DirectVoltage::new(1.0, 40.0);
        direct.push(&[9.0, 9.0, 1.0, 2.0, 3.0, 4.0]);
        let past: Vec<f64> = direct.mirrored().take(9).collect();
        assert_eq!(past, [3.0, 2.0, 1.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0]);
    }
}
