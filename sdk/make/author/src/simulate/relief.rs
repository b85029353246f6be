//! The relief of a simulated surface: the variation of the friction coefficient along the surface,
//! smoothed by the contact area of a finger's ridge.

use std::f64::consts::PI;

use htex_dsp::normal::Normal;

use super::filters::OnePole;
use super::surface::{Grain, Line, Parameters};

/// Number of points per millimetre. At 80 mm/s, 1000 Hz has a period of 8 points; faster sweeps
/// have longer periods.
pub(super) const POINTS_PER_MM: f64 = 100.0;
/// Length of the surface including a margin, mm, centred on 0.
const LENGTH_MM: f64 = 120.0;
/// Half the length of the part that is read if the reading point does not move at the finger's
/// speed, mm.
pub(super) const HALF_READ_MM: f64 = 45.0;
/// Standard deviation of the Gaussian over which the contact of one ridge averages, mm: -3 dB at
/// 6.6 periods per millimetre (530 Hz at 80 mm/s).
const CONTACT_MM: f64 = 0.02;
/// Distance across the sweep over which the grain changes completely, mm.
const TRACK_MM: f64 = 3.0;

/// The relief of one surface: a fixed field, read at the finger's position.
pub(super) struct Relief {
    lines: Vec<f64>,
    /// Two independent fields. Their mix changes with the position across the sweep.
    grains: [Vec<f64>; 2],
}

impl Relief {
    /// Creates a field. Before it is smoothed by the contact, its standard deviation is
    /// `parameters.relief`.
    pub(super) fn new(parameters: &Parameters, random: &mut Normal) -> Self {
        let unit = parameters.unit();
        let mut field = |add: &mut dyn FnMut(&mut [f64], &mut Normal)| {
            let mut values = vec![0.0; (LENGTH_MM * POINTS_PER_MM) as usize];
            add(&mut values, random);
            smooth(&values)
        };
        let mut grains = |values: &mut [f64], random: &mut Normal| {
            parameters.grains.iter().for_each(|grain| add_grain(values, grain, unit, random));
        };
        Self {
            lines: field(&mut |values, random| {
                parameters.lines.iter().for_each(|line| add_line(values, line, unit, random));
            }),
            grains: [field(&mut grains), field(&mut grains)],
        }
    }

    /// Returns the change of the friction coefficient at `along_mm` (0 is the middle of the sweep)
    /// and `across_mm`.
    pub(super) fn height_at(&self, along_mm: f64, across_mm: f64) -> f64 {
        let point = (along_mm + LENGTH_MM / 2.0) * POINTS_PER_MM;
        let turn = PI * across_mm / (2.0 * TRACK_MM);
        let [a, b] = &self.grains;
        cubic(&self.lines, point)
            + libm::cos(turn) * cubic(a, point)
            + libm::sin(turn) * cubic(b, point)
    }
}

fn add_line(values: &mut [f64], line: &Line, unit: f64, random: &mut Normal) {
    // A cosine has a standard deviation of 1/√2 of its amplitude.
    let amplitude = unit * line.weight * libm::sqrt(2.0);
    let step = 2.0 * PI * line.per_mm / POINTS_PER_MM;
    // The variances of the random walk's steps add up to the variance over a millimetre.
    let wander = line.wander / libm::sqrt(POINTS_PER_MM);
    let mut phase = 2.0 * PI * random.next_unit();
    for value in values {
        *value += amplitude * libm::cos(phase);
        phase += step + wander * random.next_normal();
    }
}

fn add_grain(values: &mut [f64], grain: &Grain, unit: f64, random: &mut Normal) {
    let mut slow = OnePole::new(grain.from_per_mm, POINTS_PER_MM);
    let mut fast = [0; 2].map(|_| OnePole::new(grain.to_per_mm, POINTS_PER_MM));
    let mut noise: Vec<f64> = Vec::with_capacity(values.len());
    for _ in 0..values.len() {
        let white = random.next_normal();
        let high = white - slow.tick(white);
        noise.push(fast.iter_mut().fold(high, |x, filter| filter.tick(x)));
    }
    let power = noise.iter().map(|x| x * x).sum::<f64>() / noise.len() as f64;
    let scale = unit * grain.weight / libm::sqrt(power);
    values.iter_mut().zip(noise).for_each(|(value, x)| *value += scale * x);
}

/// Returns the contact's Gaussian, normalised to a sum of 1.
pub(super) fn contact_kernel() -> Vec<f64> {
    let (kernel, total) = gaussian();
    kernel.iter().map(|weight| weight / total).collect()
}

/// Returns the contact's Gaussian and its sum.
fn gaussian() -> (Vec<f64>, f64) {
    let sigma = CONTACT_MM * POINTS_PER_MM;
    let reach = libm::ceil(4.0 * sigma) as usize;
    let weight = |offset: usize| {
        let x = offset as f64 - reach as f64;
        libm::exp(-0.5 * (x / sigma) * (x / sigma))
    };
    let kernel: Vec<f64> = (0..=2 * reach).map(weight).collect();
    let total = kernel.iter().sum();
    (kernel, total)
}

/// Smooths values with the contact's Gaussian.
fn smooth(values: &[f64]) -> Vec<f64> {
    let (kernel, total) = gaussian();
    let reach = kernel.len() / 2;
    let at = |point: usize| {
        let sum: f64 = kernel
            .iter()
            .enumerate()
            .filter_map(|(k, weight)| Some(weight * values.get((point + k).checked_sub(reach)?)?))
            .sum();
        sum / total
    };
    (0..values.len()).map(at).collect()
}

/// Returns the weights of Catmull–Rom interpolation for a position between the second and the third
/// of four values; `t` goes from 0 to 1.
pub(super) fn cubic_weights(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (2.0 * t2 - t - t3),
        0.5 * (2.0 - 5.0 * t2 + 3.0 * t3),
        0.5 * (t + 4.0 * t2 - 3.0 * t3),
        0.5 * (t3 - t2),
    ]
}

/// Interpolates by Catmull–Rom; beyond the ends it is constant.
fn cubic(values: &[f64], point: f64) -> f64 {
    let last = values.len() - 3;
    let whole = libm::floor(point).clamp(1.0, last as f64);
    let t = (point - whole).clamp(0.0, 1.0);
    let at = whole as usize;
    let [a, b, c, d] = [values[at - 1], values[at], values[at + 1], values[at + 2]];
    b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
}
