//! Measures what a device is given: the levels that a line of answers states.

use htex_device::{DIRECT_LIMIT_V, DirectVoltage};

use crate::study::lines::OutputLevels;

/// Measures the samples that are written to a device.
///
/// ```
/// use htex_lab::study::Meter;
/// let mut meter = Meter::new("V", 1000.0);
/// meter.take(&[3.0, -3.0, 3.0, -3.0]);
/// let levels = meter.levels();
/// assert_eq!((levels.peak, levels.rms, levels.duration_s), (3.0, 3.0, 0.004));
/// assert!((levels.direct - 0.03).abs() < 1e-12, "3 V for 1 ms of 100 ms");
/// ```
#[derive(Debug, Clone)]
pub struct Meter {
    unit: String,
    rate_hz: f64,
    frames: u64,
    peak: f64,
    /// Sum of the squared samples.
    energy: f64,
    direct: f64,
    last: DirectVoltage,
}

impl Meter {
    /// Creates a meter for samples in a unit, at a sample rate in hertz.
    pub fn new(unit: &str, rate_hz: f64) -> Self {
        Self {
            unit: unit.to_owned(),
            rate_hz,
            frames: 0,
            peak: 0.0,
            energy: 0.0,
            direct: 0.0,
            last: DirectVoltage::new(DIRECT_LIMIT_V, rate_hz),
        }
    }

    /// Measures samples that were written to the device.
    pub fn take(&mut self, samples: &[f32]) {
        for sample in samples {
            let value = f64::from(*sample);
            self.peak = self.peak.max(value.abs());
            self.energy += value * value;
            // One sample at a time, because the largest mean may lie inside a block.
            self.last.push(std::slice::from_ref(sample));
            self.direct = self.direct.max(self.last.mean_v().abs());
        }
        self.frames += samples.len() as u64;
    }

    /// Returns the levels so far.
    pub fn levels(&self) -> OutputLevels {
        OutputLevels {
            unit: self.unit.clone(),
            peak: self.peak,
            rms: (self.energy / self.frames.max(1) as f64).sqrt(),
            direct: self.direct,
            duration_s: self.frames as f64 / self.rate_hz,
        }
    }
}
