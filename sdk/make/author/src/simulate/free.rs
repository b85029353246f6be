//! A hand in free motion: strokes in both directions, with random speeds and forces.

use std::f64::consts::PI;

use htex_dsp::normal::Normal;

use super::filters::OnePole;
use super::hand::{Finger, Heading};

/// Half the length of the sheet on which the strokes stay, mm: the long side of A4.
const HALF_SHEET_MM: f64 = 148.0;
/// Shortest and longest duration of a stroke, s. At high speed the end of the sheet may end a
/// stroke earlier.
const STROKE_S: [f64; 2] = [0.6, 1.6];
/// Time to reach the speed, and also to stop, s.
const RAMP_S: f64 = 0.06;
/// Largest change of speed and force within a stroke, relative to the stroke's own values.
const WANDER: f64 = 0.1;
/// Range of the frequencies of these changes, Hz: far below the texture's frequencies.
const WANDER_HZ: [f64; 2] = [0.1, 0.4];
/// Cutoff frequency of changes of direction, Hz. The friction force changes its direction with the
/// motion. The cutoff is so low that at 20 Hz this change of force is weaker than any texture.
const HEADING_HZ: f64 = 0.3;
/// Cutoff frequency of the change of force between strokes, Hz.
const FORCE_HZ: f64 = 8.0;

/// The state of a freely stroking hand, advanced sample by sample.
pub(super) struct FreeHand {
    speed: Range,
    force: Range,
    step_s: f64,
    random: Normal,
    stroke: Stroke,
    /// Time since the stroke began, s.
    time_s: f64,
    finger: Finger,
    heading: Heading,
    press: [OnePole; 2],
}

/// A stroke between two reversals.
#[derive(Debug, Clone, Copy, Default)]
struct Stroke {
    duration_s: f64,
    /// 1 or -1.
    direction: f64,
    /// Logarithms of the speed in mm/s and of the force in newtons.
    log_speed: f64,
    log_force: f64,
}

impl FreeHand {
    /// Creates a hand whose speed (mm/s) and force (N) stay within the given ranges, each from
    /// lowest to highest value.
    pub(super) fn new(
        speed_mm_s: [f64; 2],
        force_n: [f64; 2],
        rate_hz: f64,
        mut random: Normal,
    ) -> Self {
        let (speed, force) =
            (Range::new(speed_mm_s, &mut random), Range::new(force_n, &mut random));
        let mut hand = Self {
            finger: Finger::at_rest(0.0, libm::exp(force.middle())),
            heading: Heading::new(HEADING_HZ, rate_hz),
            press: [0; 2].map(|_| OnePole::settled(FORCE_HZ, rate_hz, force.middle())),
            speed,
            force,
            step_s: 1.0 / rate_hz,
            random,
            stroke: Stroke::default(),
            time_s: 0.0,
        };
        hand.stroke.direction = -1.0;
        hand.begin_stroke();
        hand
    }

    /// Advances the finger by one sample.
    pub(super) fn tick(&mut self) -> Finger {
        if self.time_s >= self.stroke.duration_s {
            self.begin_stroke();
        }
        self.time_s += self.step_s;
        let speed = libm::exp(self.stroke.log_speed + self.speed.wander(self.step_s));
        let along_mm_s = self.stroke.direction * speed * self.stroke.envelope(self.time_s);
        self.heading.steer(&mut self.finger, along_mm_s, self.step_s, &mut self.random);
        let target = self.stroke.log_force + self.force.wander(self.step_s);
        let log_force = self.press.iter_mut().fold(target, |x, pole| pole.tick(x));
        self.finger.normal_n = libm::exp(log_force);
        self.finger
    }

    /// Draws a random speed, force and duration for the next stroke. The stroke goes in the other
    /// direction, unless the sheet ends there.
    fn begin_stroke(&mut self) {
        let random = &mut self.random;
        let log_speed = self.speed.draw(random);
        let log_force = self.force.draw(random);
        let wanted_s = STROKE_S[0] + (STROKE_S[1] - STROKE_S[0]) * random.next_unit();
        // The stroke is planned for its highest speed, so that it cannot leave the sheet.
        let highest = libm::exp(log_speed + self.speed.wander);
        let left_s = |direction: f64| (HALF_SHEET_MM - direction * self.finger.along_mm) / highest;
        let mut direction = -self.stroke.direction;
        // Near the end of the sheet a full stroke may not fit in the other direction either.
        if left_s(direction) < STROKE_S[0] && left_s(-direction) > left_s(direction) {
            direction = -direction;
        }
        self.time_s = 0.0;
        self.stroke =
            Stroke { duration_s: wanted_s.min(left_s(direction)), direction, log_speed, log_force };
    }
}

impl Stroke {
    /// Returns the fraction of the full speed: 0 at both ends of a stroke, 1 between its
    /// raised-cosine ramps.
    fn envelope(&self, time_s: f64) -> f64 {
        let ramp_s = RAMP_S.min(0.25 * self.duration_s);
        let from_end = time_s.min(self.duration_s - time_s);
        0.5 - 0.5 * libm::cos(PI * (from_end / ramp_s).clamp(0.0, 1.0))
    }
}

/// A range of speeds or forces as logarithms, with the slow change within strokes.
struct Range {
    low: f64,
    high: f64,
    /// Largest change within a stroke, as a logarithm.
    wander: f64,
    /// Phase in radians and angular frequency in radians per second.
    waves: [[f64; 2]; 3],
}

impl Range {
    fn new([low, high]: [f64; 2], random: &mut Normal) -> Self {
        let (low, high) = (libm::log(low), libm::log(high));
        let wave = |_| {
            let hz = WANDER_HZ[0] + (WANDER_HZ[1] - WANDER_HZ[0]) * random.next_unit();
            [2.0 * PI * random.next_unit(), 2.0 * PI * hz]
        };
        // The limit leaves at least half of the range to draw from.
        Self { low, high, wander: WANDER.min(0.25 * (high - low)), waves: [0; 3].map(wave) }
    }

    fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }

    /// Draws a random value that stays in the range even with all its changes.
    fn draw(&self, random: &mut Normal) -> f64 {
        let (low, high) = (self.low + self.wander, self.high - self.wander);
        low + (high - low) * random.next_unit()
    }

    /// Advances the slow change and returns it.
    fn wander(&mut self, step_s: f64) -> f64 {
        let mut sum = 0.0;
        for [phase, speed] in &mut self.waves {
            *phase += *speed * step_s;
            sum += libm::sin(*phase);
        }
        self.wander * sum / self.waves.len() as f64
    }
}
