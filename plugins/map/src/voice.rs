//! The voice: renders the friction under the finger, without the mean friction and limited to the
//! asset's frequency band.

use htex_dsp::band_limit::{band_limit, band_limit_power};
use htex_dsp::grid::Band;
use htex_dsp::pipeline::Pipeline;
use htex_dsp::uniform::Uniform;
use htex_model::{Error, Motion, MotionVoice, Values, Voice};

use crate::lines::Lines;
use crate::map::Map;
use crate::path::{Path, Transition};
use crate::surface::Surface;

/// Largest gain of a force.
const MOST_GAIN: f64 = 16.0;
/// Part of a row's width over which a voice without motion input moves to the next row.
const TURN: f64 = 0.1;
/// Number of samples that are filtered at a time. A new motion takes effect when the next block
/// begins.
const BLOCK: usize = 2;
/// Number of places on the surface per sample. A fast finger and the images of pixels cause
/// frequencies above the band. Oversampling allows these frequencies to be filtered out before they
/// alias to lower frequencies.
const OVERSAMPLING: usize = 4;

/// A surface, and a finger that moves over it.
pub struct MapVoice {
    /// Number of places per second.
    place_hz: f64,
    surface: Surface,
    /// If `is_changing` is set, the surface that replaces `surface` once the voice is silent.
    next: Surface,
    is_changing: bool,
    /// Part of the first map's RMS that the filters at the band's edges pass.
    passed: f64,
    edges: Pipeline,
    path: Path,
    /// The last motion that was set, and the number of samples that were ready at that time.
    told: Option<Motion>,
    ahead: usize,
    moved: bool,
    /// For a voice without motion input: the distance covered along the rows, pixels.
    way: f64,
    gain: Ramp,
    contact: Ramp,
    is_jumping: bool,
    ready: [f32; BLOCK],
    taken: usize,
}

/// A value with a linear ramp to a new target.
struct Ramp {
    value: f64,
    target: f64,
    step: f64,
}

impl Ramp {
    const fn resting_at(value: f64) -> Self {
        Self { value, target: value, step: 0.0 }
    }

    fn set(&mut self, target: f64, samples: f64) {
        if target == self.target {
            return;
        }
        self.target = target;
        self.step = (target - self.value) / samples;
    }

    fn next(&mut self) -> f64 {
        let value = self.value;
        let left = self.target - value;
        self.value = if left.abs() <= self.step.abs() { self.target } else { value + self.step };
        value
    }
}

impl MapVoice {
    pub(crate) fn new(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, Error> {
        let place_hz = OVERSAMPLING as f64 * rate_hz;
        let mut voice = Self {
            place_hz,
            surface: Surface::empty(),
            next: Surface::empty(),
            is_changing: false,
            passed: 1.0,
            edges: band_limit(band, place_hz),
            path: Path::new(place_hz),
            told: None,
            ahead: 0,
            moved: false,
            way: 0.0,
            gain: Ramp::resting_at(1.0),
            contact: Ramp::resting_at(1.0),
            is_jumping: false,
            ready: [0.0; BLOCK],
            taken: BLOCK,
        };
        let map = Map::new(parameters)?;
        let passed = band_limit_power(band, place_hz);
        voice.passed = Lines::stated(&map, band)?.rms_behind(passed);
        voice.surface.set_map(&map, voice.passed)?;
        voice.way = Uniform::new(seed).next_unit() * map.grey.len() as f64;
        // Lets the filter's transient decay before the first sample.
        for _ in 0..(0.2 * rate_hz) as usize / BLOCK {
            voice.fill();
        }
        Ok(voice)
    }

    /// Returns the place of the next sample, in pixels.
    fn place(&mut self) -> [f64; 2] {
        if self.told.is_some() {
            return self.path.next().map(|mm| mm / self.surface.pitch_mm);
        }
        let width = self.surface.width as f64;
        let row = libm::floor(self.way / width);
        let part = self.way / width - row;
        let turn = ((part - 1.0 + TURN) / TURN).max(0.0);
        let place = [self.way, row + turn * turn * (3.0 - 2.0 * turn)];
        self.way += self.surface.speed_mm_s / (self.place_hz * self.surface.pitch_mm);
        place
    }

    /// Renders and filters the next block.
    fn fill(&mut self) {
        let mut pairs = [[0.0; 2]; OVERSAMPLING * BLOCK / 2];
        for sample in pairs.as_flattened_mut() {
            if self.contact.value == 0.0 {
                self.change();
            }
            let [x, y] = self.place();
            let friction = self.surface.friction_at(x, y);
            *sample = friction * self.gain.next() * self.contact.next();
        }
        self.edges.process(&mut pairs);
        let kept = pairs.as_flattened().iter().step_by(OVERSAMPLING);
        for (ready, sample) in self.ready.iter_mut().zip(kept) {
            // Subnormal numbers are slow on some processors.
            let sample = *sample as f32;
            *ready = if sample.abs() < f32::MIN_POSITIVE { 0.0 } else { sample };
        }
        self.taken = 0;
    }

    /// Makes the changes that had to wait for silence, and ends the silence.
    fn change(&mut self) {
        if self.is_changing {
            core::mem::swap(&mut self.surface, &mut self.next);
            self.gain = Ramp::resting_at(self.told.map_or(1.0, |motion| self.gain_of(motion)));
        }
        if self.is_jumping {
            self.path.leap();
        }
        (self.is_changing, self.is_jumping) = (false, false);
        self.contact.set(1.0, self.path.blend());
    }

    /// Returns the gain for the force of a motion.
    fn gain_of(&self, motion: Motion) -> f64 {
        if self.surface.force_n > 0.0 {
            (motion.force_n / self.surface.force_n).min(MOST_GAIN)
        } else {
            1.0
        }
    }

    fn take_motion(&mut self) {
        self.moved = false;
        let Some(motion) = self.told else {
            return;
        };
        let ahead = (OVERSAMPLING * self.ahead) as f64;
        let blend = self.path.blend();
        let gain = self.gain_of(motion);
        match self.path.tell(motion, ahead) {
            Transition::Start => self.gain = Ramp::resting_at(gain),
            Transition::Smooth => self.gain.set(gain, blend),
            Transition::Jump => {
                self.gain.set(gain, blend);
                self.is_jumping = true;
                self.contact.set(0.0, blend);
            }
        }
    }
}

impl Voice for MapVoice {
    fn render(&mut self, out: &mut [f32]) {
        for sample in out {
            if self.taken == BLOCK {
                if self.moved {
                    self.take_motion();
                }
                self.fill();
            }
            *sample = self.ready[self.taken];
            self.taken += 1;
        }
    }

    /// Changes to another map, which begins after a fade. Its level is corrected for the filters
    /// with the factor of the first map.
    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        self.next.set_map(&Map::new(parameters)?, self.passed)?;
        self.is_changing = self.next != self.surface;
        let is_silent = self.is_changing || self.is_jumping;
        let contact = if is_silent { 0.0 } else { 1.0 };
        self.contact.set(contact, self.path.blend());
        Ok(())
    }
}

impl MotionVoice for MapVoice {
    fn set_motion(&mut self, motion: Motion) {
        self.told = Some(motion);
        self.ahead = BLOCK - self.taken;
        self.moved = true;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::disallowed_methods)] // A failed unwrap is a failed test.
    extern crate std;

    use alloc::vec::Vec;

    use htex_dsp::grid::Band;
    use htex_model::{Model, Motion, MotionVoice, Values, Voice};

    use crate::{FrictionMap, MapVoice};

    const RATE_HZ: f64 = 4_000.0;

    /// Returns the parameters of a map whose grey value is a function of x and y in pixels.
    fn parameters(width: usize, rows: usize, grey: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let pixels = (0..rows).flat_map(|y| (0..width).map(move |x| (x as f64, y as f64)));
        let grey: Vec<f64> = pixels.map(|(x, y)| grey(x, y).round()).collect();
        let rms = crate::rms(width, 0.1, 80.0, &grey, Band::TACTILE).unwrap();
        let mut all = vec![width as f64, 0.1, 80.0, 0.5, rms, grey.len() as f64];
        all.extend(grey);
        all
    }

    fn voice(parameters: &[f64]) -> MapVoice {
        let values = Values::read(&FrictionMap::DESCRIPTOR, parameters).unwrap();
        MapVoice::new(&values, Band::TACTILE, RATE_HZ, 1).unwrap()
    }

    fn waves(per_width: f64) -> impl Fn(f64, f64) -> f64 {
        move |x, _| 127.5 + 100.0 * (core::f64::consts::TAU * per_width * x / 100.0).sin()
    }

    fn motion(speed_mm_s: f64, x_mm: f64, y_mm: f64) -> Motion {
        Motion { speed_mm_s, force_n: 0.5, position_mm: 0.0, x_mm, y_mm }
    }

    /// Returns the samples of a straight stroke, with a new motion every 5 ms.
    fn stroke(voice: &mut MapVoice, [dx, dy]: [f64; 2], seconds: f64) -> Vec<f32> {
        let (speed, block) = ((dx * dx + dy * dy).sqrt(), 20);
        let mut samples = Vec::new();
        while (samples.len() as f64) < seconds * RATE_HZ {
            let t = samples.len() as f64 / RATE_HZ;
            voice.set_motion(motion(speed, 3.0 + dx * t, 2.0 + dy * t));
            let mut out = [0.0; 20];
            voice.render(&mut out);
            samples.extend_from_slice(&out[..block]);
        }
        samples
    }

    fn amplitude_at(samples: &[f32], hz: f64) -> f64 {
        let (mut re, mut im) = (0.0, 0.0);
        for (n, sample) in samples.iter().enumerate() {
            let a = core::f64::consts::TAU * hz * n as f64 / RATE_HZ;
            re += f64::from(*sample) * a.cos();
            im += f64::from(*sample) * a.sin();
        }
        2.0 * (re * re + im * im).sqrt() / samples.len() as f64
    }

    #[test]
    fn a_line_is_as_fast_as_the_finger_crosses_it() {
        // Ten waves in 10 mm: one per millimetre.
        let all = parameters(100, 3, waves(10.0));
        for (speed, hz) in
            [([80.0, 0.0], 80.0), ([160.0, 0.0], 160.0), ([48.0, 36.0], 48.0), ([-80.0, 0.0], 80.0)]
        {
            let mut voice = voice(&all);
            let samples = stroke(&mut voice, speed, 1.5);
            let there = amplitude_at(&samples[2_000..], hz);
            assert!((there - 2.0f64.sqrt()).abs() < 0.05, "{speed:?}: {there}");
        }
        // Along the lines nothing is felt.
        let mut voice = voice(&all);
        let samples = stroke(&mut voice, [0.0, 80.0], 1.5);
        let rest = samples[2_000..].iter().fold(0.0f32, |most, x| most.max(x.abs()));
        assert!(rest < 1e-3, "{rest}");
    }

    #[test]
    fn untold_it_plays_the_level_that_is_stated() {
        let all = parameters(97, 31, |x, y| {
            127.5 + 60.0 * (1.7 * x + 2.3 * y).sin() + 50.0 * (0.9 * x * (1.0 + 0.1 * y)).cos()
        });
        let mut voice = voice(&all);
        let mut samples = vec![0.0; 120_000];
        voice.render(&mut samples);
        let square: f64 = samples.iter().map(|x| f64::from(*x) * f64::from(*x)).sum();
        let level_db = 10.0 * (square / samples.len() as f64).log10();
        assert!(level_db.abs() < 0.5, "{level_db} dB");
    }

    #[test]
    fn blocks_do_not_matter_and_a_jump_is_no_step() {
        let all = parameters(100, 3, waves(20.0));
        let (mut one, mut other) = (voice(&all), voice(&all));
        let (mut a, mut b) = (vec![0.0; 1_000], vec![0.0; 1_000]);
        one.render(&mut a);
        b.chunks_mut(37).for_each(|part| other.render(part));
        assert_eq!(a, b);
        let mut samples = stroke(&mut one, [80.0, 0.0], 0.5);
        one.set_motion(motion(80.0, 77.7, 1.0));
        let mut after = [0.0; 400];
        one.render(&mut after);
        samples.extend_from_slice(&after);
        let most = |part: &[f32]| {
            part.windows(2).fold(0.0f32, |most, pair| most.max((pair[1] - pair[0]).abs()))
        };
        assert!(most(&samples[1_900..]) < 1.5 * most(&samples[1_000..1_900]));
    }

    #[test]
    fn another_map_is_no_step() {
        let [one, other] = [20.0, 21.0].map(|waves_of| parameters(100, 3, waves(waves_of)));
        let mut voice = voice(&one);
        let mut samples = stroke(&mut voice, [80.0, 0.0], 0.5);
        voice.retune(&Values::read(&FrictionMap::DESCRIPTOR, &other).unwrap()).unwrap();
        let mut after = [0.0; 2_000];
        voice.render(&mut after);
        samples.extend_from_slice(&after);
        let most = |part: &[f32]| {
            part.windows(2).fold(0.0f32, |most, pair| most.max((pair[1] - pair[0]).abs()))
        };
        assert!(most(&samples[1_900..]) < 1.2 * most(&samples[1_000..1_900]));
        assert!(amplitude_at(&after[1_000..], 168.0) > 1.0);
    }
}
