//! An endless relief. The relief is generated along the finger's path, so the finger never touches
//! the same place twice.

use std::f64::consts::PI;

use htex_dsp::normal::Normal;

use super::filters::OnePole;
use super::relief::{POINTS_PER_MM, contact_kernel, cubic_weights};
use super::surface::{Grain, Line, Parameters};

/// A relief along a path, generated while the finger moves on.
pub(super) struct Track {
    lines: Vec<Wave>,
    grains: Vec<Noise>,
    random: Normal,
    kernel: Vec<f64>,
    /// The latest values before smoothing by the contact, oldest first: one for each value of the
    /// kernel.
    raw: Vec<f64>,
    /// The latest smoothed values, oldest first.
    smooth: [f64; 4],
    /// How far the finger is past the second of `smooth`, in points, from 0 to below 1.
    ahead: f64,
}

/// The phase of a line.
struct Wave {
    amplitude: f64,
    phase: f64,
    step: f64,
    wander: f64,
}

/// The filters of a grain.
struct Noise {
    gain: f64,
    slow: OnePole,
    fast: [OnePole; 2],
}

impl Track {
    /// Creates a relief. Before it is smoothed by the contact, its standard deviation is
    /// `parameters.relief`.
    pub(super) fn new(parameters: &Parameters, mut random: Normal) -> Self {
        let unit = parameters.unit();
        let wave = |line: &Line| Wave {
            amplitude: unit * line.weight * std::f64::consts::SQRT_2,
            phase: 2.0 * PI * random.next_unit(),
            step: 2.0 * PI * line.per_mm / POINTS_PER_MM,
            wander: line.wander / libm::sqrt(POINTS_PER_MM),
        };
        let lines = parameters.lines.iter().map(wave).collect();
        let noise = |grain: &Grain| Noise {
            gain: unit * grain.weight / libm::sqrt(grain.noise_power()),
            slow: OnePole::new(grain.from_per_mm, POINTS_PER_MM),
            fast: [0; 2].map(|_| OnePole::new(grain.to_per_mm, POINTS_PER_MM)),
        };
        let kernel = contact_kernel();
        let mut track = Self {
            lines,
            grains: parameters.grains.iter().map(noise).collect(),
            random,
            raw: vec![0.0; kernel.len()],
            kernel,
            smooth: [0.0; 4],
            ahead: 0.0,
        };
        track.settle(parameters);
        track
    }

    /// Skips the beginning, in which the filters still contain their initial zeros.
    fn settle(&mut self, parameters: &Parameters) {
        let lowest =
            parameters.grains.iter().map(|grain| grain.from_per_mm).fold(f64::INFINITY, f64::min);
        // Five time constants of the slowest filter.
        let points = 5.0 * POINTS_PER_MM / (2.0 * PI * lowest);
        for _ in 0..(points as usize).min(100_000) + self.raw.len() {
            self.push();
        }
    }

    /// Moves on by a distance in mm, and returns the change of the friction coefficient there.
    pub(super) fn advance(&mut self, distance_mm: f64) -> f64 {
        self.ahead += distance_mm * POINTS_PER_MM;
        while self.ahead >= 1.0 {
            self.ahead -= 1.0;
            self.push();
        }
        let weights = cubic_weights(self.ahead);
        self.smooth.iter().zip(weights).map(|(x, w)| x * w).sum()
    }

    fn push(&mut self) {
        let value = self.next_raw();
        self.raw.rotate_left(1);
        if let Some(last) = self.raw.last_mut() {
            *last = value;
        }
        let smooth = self.raw.iter().zip(&self.kernel).map(|(x, w)| x * w).sum();
        self.smooth.rotate_left(1);
        self.smooth[3] = smooth;
    }

    fn next_raw(&mut self) -> f64 {
        let random = &mut self.random;
        let mut value = 0.0;
        for line in &mut self.lines {
            value += line.amplitude * libm::cos(line.phase);
            line.phase += line.step + line.wander * random.next_normal();
            // Keeping the phase small keeps the cosine exact on long paths.
            line.phase -= if line.phase > 2.0 * PI { 2.0 * PI } else { 0.0 };
        }
        for grain in &mut self.grains {
            let white = random.next_normal();
            let high = white - grain.slow.tick(white);
            value += grain.gain * grain.fast.iter_mut().fold(high, |x, pole| pole.tick(x));
        }
        value
    }
}
