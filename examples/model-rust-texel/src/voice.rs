//! The surface under the finger: sinusoids over the path, evaluated at the finger's position.

use alloc::vec;
use alloc::vec::Vec;

use htex_dsp::uniform::Uniform;
use htex_model::{Band, Error, Motion, MotionVoice, Values, Voice};

use crate::comb::{Comb, LINES, heard};
use crate::path::{Path, Way};
use crate::{FORCE, SPEED};

/// Largest gain of a force.
const MOST_GAIN: f64 = 16.0;

/// A value with linear ramps to new targets.
#[derive(Clone, Copy, Default)]
struct Ramp {
    value: f64,
    target: f64,
    step: f64,
    left: f64,
}

impl Ramp {
    fn at(value: f64) -> Self {
        Self {
            value,
            target: value,
            ..Self::default()
        }
    }

    fn set(&mut self, target: f64, samples: f64) {
        if target != self.target {
            self.target = target;
            self.left = samples;
            self.step = (target - self.value) / samples;
        }
    }

    /// Returns the value and advances by one sample.
    fn next(&mut self) -> f64 {
        let value = self.value;
        if self.left > 0.0 {
            self.left -= 1.0;
            self.value = if self.left > 0.0 { value + self.step } else { self.target };
        }
        value
    }
}

/// One sinusoid of the surface.
#[derive(Clone, Copy, Default)]
struct Ridge {
    /// Phase under the finger, cycles, 0 to 1.
    phase: f64,
    /// Cycles per mm, and the amplitude after the gain at the band's edges.
    per_mm: Ramp,
    height: Ramp,
    /// Cycles per mm and amplitude according to the parameters.
    wanted: (f64, f64),
}

/// The surface and the finger on it. Phases are proportional to the position, so that samples are a
/// function of the position in both directions, until a retune changes the surface.
pub struct TexelVoice {
    band: Band,
    rate_hz: f64,
    ridges: Vec<Ridge>,
    path: Path,
    /// Force of the recording; 0 if unknown.
    speed_mm_s: f64,
    force_n: f64,
    /// The last motion that was set, if any.
    told: Option<Motion>,
    /// Changes since the last sample.
    retuned: bool,
    moved: bool,
    gain: Ramp,
    /// Decreases to 0 before a jump of the finger, and increases after it.
    contact: Ramp,
}

impl TexelVoice {
    pub(crate) fn new(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, Error> {
        let mut phases = Uniform::new(seed);
        let mut ridges = vec![Ridge::default(); LINES];
        for ridge in &mut ridges {
            ridge.phase = phases.next_unit();
        }
        let mut voice = Self {
            band,
            rate_hz,
            ridges,
            path: Path::new(parameters.scalar(SPEED), rate_hz),
            speed_mm_s: 0.0,
            force_n: 0.0,
            told: None,
            retuned: false,
            moved: false,
            gain: Ramp::at(1.0),
            contact: Ramp::at(1.0),
        };
        voice.retune(parameters)?;
        voice.take_changes();
        voice.settle();
        Ok(voice)
    }

    /// Ends all ramps, before the first sample.
    fn settle(&mut self) {
        for ridge in &mut self.ridges {
            ridge.per_mm = Ramp::at(ridge.per_mm.target);
            ridge.height = Ramp::at(ridge.height.target);
        }
        self.gain = Ramp::at(self.gain.target);
    }

    /// Starts the changes since the last sample.
    fn take_changes(&mut self) {
        let samples = self.path.blend();
        if core::mem::take(&mut self.retuned) {
            for ridge in &mut self.ridges {
                let (per_mm, height) = ridge.wanted;
                if ridge.height.value == 0.0 && ridge.height.left == 0.0 {
                    // A line of amplitude 0 can start with any pitch.
                    ridge.per_mm = Ramp::at(per_mm);
                }
                ridge.per_mm.set(per_mm, samples);
                ridge.height.set(height, samples);
            }
            if self.told.is_none() {
                self.path.set_speed(self.speed_mm_s);
            }
        }
        let way = match (core::mem::take(&mut self.moved), self.told) {
            (true, Some(motion)) => self.path.tell(motion),
            _ => Way::Smooth,
        };
        self.press(samples);
        match way {
            Way::Smooth => {}
            Way::Start(way_mm) => {
                self.settle();
                self.move_by(way_mm);
            }
            Way::Jump => self.contact.set(0.0, samples),
        }
    }

    /// Starts the change to the level for the current force.
    fn press(&mut self, samples: f64) {
        let force = self.told.filter(|_| self.force_n > 0.0);
        let gain = force.map_or(1.0, |m| (m.force_n / self.force_n).min(MOST_GAIN));
        self.gain.set(gain, samples);
    }

    fn move_by(&mut self, way_mm: f64) {
        for ridge in &mut self.ridges {
            let phase = ridge.phase + ridge.per_mm.value * way_mm;
            ridge.phase = phase - libm::floor(phase);
        }
    }

    fn next_sample(&mut self) -> f32 {
        if self.contact.target == 0.0 && self.contact.left == 0.0 {
            let way_mm = self.path.leap();
            self.move_by(way_mm);
            self.contact.set(1.0, self.path.blend());
        }
        let way_mm = self.path.advance();
        let speed_mm_s = way_mm.abs() * self.rate_hz;
        let mut sum = 0.0;
        for ridge in &mut self.ridges {
            let (height, per_mm) = (ridge.height.next(), ridge.per_mm.next());
            let amplitude = height * heard(per_mm * speed_mm_s, self.band);
            if amplitude != 0.0 {
                sum += amplitude * sine(ridge.phase);
            }
            let phase = ridge.phase + per_mm * way_mm;
            ridge.phase = phase - libm::floor(phase);
        }
        let sample = (sum * self.gain.next() * self.contact.next()) as f32;
        // Avoids subnormal numbers, which are slow on some processors.
        if sample.abs() < f32::MIN_POSITIVE {
            0.0
        } else {
            sample
        }
    }
}

impl Voice for TexelVoice {
    fn render(&mut self, out: &mut [f32]) {
        if !out.is_empty() && (self.retuned || self.moved) {
            self.take_changes();
        }
        for sample in out {
            *sample = self.next_sample();
        }
    }

    /// Pitches and amplitudes change over 10 ms; phases are continuous.
    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        let comb = Comb::new(parameters, self.band)?;
        self.speed_mm_s = parameters.scalar(SPEED);
        self.force_n = parameters.scalar(FORCE);
        let silent = |ridge: &mut Ridge| ridge.wanted.1 = 0.0;
        self.ridges.iter_mut().for_each(silent);
        comb.for_each_ridge(self.speed_mm_s, |i, per_mm, height| {
            self.ridges[i].wanted = (per_mm, height);
        });
        self.retuned = true;
        Ok(())
    }
}

impl MotionVoice for TexelVoice {
    fn set_motion(&mut self, motion: Motion) {
        self.told = Some(motion);
        self.moved = true;
    }
}

/// Returns the sine of an angle of 0 to 1 cycle, computed from its series. The error is at most
/// 1e-7, and the result is bit-identical on every machine.
fn sine(cycles: f64) -> f64 {
    let centred = if cycles < 0.5 { cycles } else { cycles - 1.0 };
    let folded = if centred > 0.25 {
        0.5 - centred
    } else if centred < -0.25 {
        -0.5 - centred
    } else {
        centred
    };
    let x = core::f64::consts::TAU * folded;
    let y = x * x;
    let series = 1.0 / 362_880.0 - y / 39_916_800.0;
    x * (1.0 - y * (1.0 / 6.0 - y * (1.0 / 120.0 - y * (1.0 / 5_040.0 - y * series))))
}
