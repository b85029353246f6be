//! The hand: back-and-forth sweeps over the surface with uneven speed and force.

use std::f64::consts::PI;

use htex_dsp::biquad::Cascade;
use htex_dsp::normal::Normal;

use super::filters::{OnePole, band_pass};

/// Length of a sweep, mm; the surface is 100 mm long.
const SWEEP_MM: f64 = 83.0;
/// Scatter of a sweep's end, mm (standard deviation).
const END_SCATTER_MM: f64 = 0.8;
/// Time to reach the speed, and also to stop, s.
const RAMP_S: f64 = 0.1;
/// Rest at each end, shortest and longest duration, s.
const REST_S: [f64; 2] = [0.06, 0.11];
/// Relative scatter of the speed, between sweeps and within a sweep.
const SPEED_SCATTER: [f64; 2] = [0.015, 0.02];
/// Slow drift of the force, and physiological tremor (8–12 Hz), both relative. Their sum is kept
/// within 10 %.
const FORCE_SCATTER: [f64; 2] = [0.03, 0.012];
const FORCE_BOUND: f64 = 0.1;
const TREMOR_HZ: f64 = 10.0;
const TREMOR_Q: f64 = 4.0;
/// Scatter of the direction of motion, radians, and the rate at which the finger returns to the
/// middle, 1/mm.
const HEADING: f64 = 0.03;
const HEADING_HZ: f64 = 1.5;
const DRAW_BACK: f64 = 0.02;
/// Relative scatter of the strength of contact, between sweeps and within a sweep.
const CONTACT_SCATTER: [f64; 2] = [0.07, 0.08];

/// State of the finger.
#[derive(Debug, Clone, Copy)]
pub(super) struct Finger {
    /// Position along and across the sweep, mm; 0 is the middle of the surface.
    pub(super) along_mm: f64,
    pub(super) across_mm: f64,
    /// Velocity, mm/s.
    pub(super) along_mm_s: f64,
    pub(super) across_mm_s: f64,
    /// Normal force, newtons.
    pub(super) normal_n: f64,
    /// Strength of the contact with the texture; 1 on average.
    pub(super) contact: f64,
}

impl Finger {
    /// Makes a finger at rest, in the middle of the surface across the sweep.
    pub(super) fn at_rest(along_mm: f64, normal_n: f64) -> Self {
        Self { along_mm, across_mm: 0.0, along_mm_s: 0.0, across_mm_s: 0.0, normal_n, contact: 1.0 }
    }
}

/// The finger's direction of motion, which wanders around the direction of the sweep.
pub(super) struct Heading(SlowNoise);

impl Heading {
    /// Creates a direction that changes at frequencies up to about `hz`.
    pub(super) fn new(hz: f64, rate_hz: f64) -> Self {
        Self(SlowNoise::new(hz, rate_hz))
    }

    /// Moves the finger by one step, at a velocity along the sweep.
    pub(super) fn steer(
        &mut self,
        finger: &mut Finger,
        along_mm_s: f64,
        step_s: f64,
        random: &mut Normal,
    ) {
        finger.along_mm_s = along_mm_s;
        let heading = HEADING * self.0.tick(random) - DRAW_BACK * finger.across_mm;
        finger.across_mm_s = along_mm_s.abs() * heading;
        finger.along_mm += finger.along_mm_s * step_s;
        finger.across_mm += finger.across_mm_s * step_s;
    }
}

/// A rest, and the sweep that follows it.
#[derive(Debug, Clone, Copy, Default)]
struct Sweep {
    rest_s: f64,
    ramp_s: f64,
    /// Time from the end of the rest until the finger stands still again, s.
    moving_s: f64,
    /// Signed speed between the ramps, mm/s.
    speed_mm_s: f64,
    contact: f64,
}

/// The hand's state, advanced sample by sample.
pub(super) struct Hand {
    speed_mm_s: f64,
    force_n: f64,
    step_s: f64,
    random: Normal,
    sweep: Sweep,
    /// Time since the rest before the sweep began, s.
    time_s: f64,
    direction: f64,
    finger: Finger,
    drift: SlowNoise,
    tremor: Tremor,
    unevenness: SlowNoise,
    heading: Heading,
    grip: SlowNoise,
}

impl Hand {
    pub(super) fn new(speed_mm_s: f64, force_n: f64, rate_hz: f64, random: Normal) -> Self {
        Self {
            speed_mm_s,
            force_n,
            step_s: 1.0 / rate_hz,
            random,
            sweep: Sweep::default(),
            time_s: 0.0,
            direction: -1.0,
            finger: Finger::at_rest(-SWEEP_MM / 2.0, force_n),
            drift: SlowNoise::new(1.0, rate_hz),
            tremor: Tremor::new(rate_hz),
            unevenness: SlowNoise::new(3.0, rate_hz),
            heading: Heading::new(HEADING_HZ, rate_hz),
            grip: SlowNoise::new(2.0, rate_hz),
        }
    }

    /// Advances the finger by one sample.
    pub(super) fn tick(&mut self) -> Finger {
        if self.time_s >= self.sweep.rest_s + self.sweep.moving_s {
            self.turn_round();
        }
        self.time_s += self.step_s;
        self.steer();
        self.press();
        self.finger
    }

    fn turn_round(&mut self) {
        self.direction = -self.direction;
        let scatter = 1.0 + SPEED_SCATTER[0] * self.random.next_normal();
        let speed = self.speed_mm_s * scatter;
        let end = self.direction * SWEEP_MM / 2.0 + END_SCATTER_MM * self.random.next_normal();
        let length = (end - self.finger.along_mm).abs();
        // A very short or fast sweep still needs time between its two ramps.
        let ramp_s = RAMP_S.min(0.25 * length / speed);
        self.time_s = 0.0;
        self.sweep = Sweep {
            rest_s: REST_S[0] + (REST_S[1] - REST_S[0]) * self.random.next_unit(),
            ramp_s,
            // In a ramp, the finger covers half the distance that it would cover at full speed. The
            // two ramps together therefore add the time of one ramp.
            moving_s: length / speed + ramp_s,
            speed_mm_s: self.direction * speed,
            contact: 1.0 + CONTACT_SCATTER[0] * self.random.next_normal(),
        };
    }

    fn steer(&mut self) {
        let uneven = 1.0 + SPEED_SCATTER[1] * self.unevenness.tick(&mut self.random);
        let along_mm_s = self.sweep.speed_mm_s * self.sweep.envelope(self.time_s) * uneven;
        self.heading.steer(&mut self.finger, along_mm_s, self.step_s, &mut self.random);
    }

    fn press(&mut self) {
        let scatter = FORCE_SCATTER[0] * self.drift.tick(&mut self.random)
            + FORCE_SCATTER[1] * self.tremor.tick(&mut self.random);
        // Clipping would cause corners in the force, and corners excite all frequencies. This
        // formula causes no corners.
        self.finger.normal_n =
            self.force_n * (1.0 + FORCE_BOUND * libm::tanh(scatter / FORCE_BOUND));
        self.finger.contact =
            self.sweep.contact + CONTACT_SCATTER[1] * self.grip.tick(&mut self.random);
    }
}

impl Sweep {
    /// Returns the fraction of the full speed: 0 at rest, 1 between the raised-cosine ramps.
    fn envelope(&self, time_s: f64) -> f64 {
        let from_start = time_s - self.rest_s;
        let to_end = self.moving_s - from_start;
        let ramp = (from_start.min(to_end) / self.ramp_s).clamp(0.0, 1.0);
        0.5 - 0.5 * libm::cos(PI * ramp)
    }
}

/// Low-pass noise of unit variance.
struct SlowNoise {
    filters: [OnePole; 2],
    gain: f64,
}

impl SlowNoise {
    fn new(hz: f64, rate_hz: f64) -> Self {
        let keep = libm::exp(-2.0 * PI * hz / rate_hz);
        // Variance of white noise after two equal one-pole filters, whose impulse response is
        // `n·keepⁿ`.
        let power =
            (1.0 - keep) * (1.0 + keep * keep) / ((1.0 + keep) * (1.0 + keep) * (1.0 + keep));
        Self {
            filters: [OnePole::new(hz, rate_hz), OnePole::new(hz, rate_hz)],
            gain: 1.0 / libm::sqrt(power),
        }
    }

    fn tick(&mut self, random: &mut Normal) -> f64 {
        let x = self.gain * random.next_normal();
        self.filters.iter_mut().fold(x, |x, filter| filter.tick(x))
    }
}

/// Physiological tremor: noise of unit variance around 10 Hz.
struct Tremor {
    filter: Cascade,
    gain: f64,
}

impl Tremor {
    fn new(rate_hz: f64) -> Self {
        // The noise bandwidth of the band-pass, π·f/2Q, as a fraction of the whole bandwidth, which
        // is half the sample rate.
        let power = PI * TREMOR_HZ / TREMOR_Q / rate_hz;
        Self {
            filter: Cascade::new(&[band_pass(TREMOR_Q, TREMOR_HZ, rate_hz)]),
            gain: 1.0 / libm::sqrt(power),
        }
    }

    fn tick(&mut self, random: &mut Normal) -> f64 {
        self.gain * self.filter.tick(random.next_normal())
    }
}
