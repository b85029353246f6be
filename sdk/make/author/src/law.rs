//! The law of a texture recorded at several motions: exponents with their standard errors.
//!
//! Levels: a least-squares fit of `ln L = k + b ln v + c ln F` over the conditions. The level of
//! one recording is assumed to have an error of at least [`LEVEL_ERROR_DB`]. An exponent from only
//! two conditions therefore remains uncertain.
//!
//! Frequencies: each spectrum is shifted by `(v / v0)^a` on a logarithmic axis, and its level is
//! removed. The exponent `a` is the value at which the spectra differ least. Spectra also change
//! with the speed for other reasons. In recorded strokes without moving lines, the best exponent
//! `a` was anywhere between -0.5 and 1.5. With this exponent, the squared difference was still 0.25
//! to 0.9 of the value without a shift. Therefore an exponent counts as measured only if the
//! squared difference falls to a quarter of the value without a shift, or to a quarter of the value
//! at the assumed exponent.

use htex_format::{Condition, Contact, Exponent, ExponentSource, Law, Quantity};

use crate::conditions::ConditionSpectrum;
use crate::spectrum::TextureSpectrum;

/// Smallest error assumed for a recorded level, decibels.
const LEVEL_ERROR_DB: f64 = 2.0;
/// An exponent counts as measured only if it reduces the squared difference to this fraction of its
/// value without a shift, or of its value at the assumed exponent.
const MOST_LEFT: f64 = 0.25;
/// Points per octave at which spectra are compared, and half the width over which each is read,
/// octaves.
const POINTS: f64 = 24.0;
const HALF_WIDTH: f64 = 1.0 / 12.0;
/// Frequency exponents that are tried, in hundredths.
const TRIED: std::ops::RangeInclusive<i32> = -30..=130;
/// Smallest length of the common frequency axis, octaves.
const LEAST_OCTAVES: f64 = 1.0;

/// Estimates the law of conditions from their spectra. Exponents that the spectra do not determine
/// keep their assumed values.
pub(crate) fn law(all: &[ConditionSpectrum], contact: Contact) -> Law {
    let quantity = all.first().map_or(Quantity::default(), |one| one.spectrum.quantity);
    let mut law = Law::assumed(quantity, contact);
    let logarithms = |of: fn(&Condition) -> Option<f64>| logarithms(all, of);
    let [speeds, forces] = [logarithms(|c| c.speed_mm_s), logarithms(|c| c.force_n)];
    let level = |one: &ConditionSpectrum| htex_dsp::grid::level_rms(&one.spectrum.magnitude);
    let levels: Vec<f64> = all.iter().map(|one| libm::log(level(one))).collect();
    let [by_speed, by_force] = level_exponents(&levels, [speeds.as_deref(), forces.as_deref()]);
    measured(&mut law.level_speed, by_speed);
    measured(&mut law.level_force, by_force);
    if let Some(speeds) = &speeds {
        let assumed = law.frequency_speed.exponent;
        let curves: Vec<Curve> = all.iter().map(|one| Curve::new(&one.spectrum)).collect();
        measured(&mut law.frequency_speed, frequency_exponent(&curves, speeds, assumed));
    }
    // This weighs the estimates against the assumptions. The frequency exponent decides which
    // levels are assumed, so all three go together.
    law.reassumed(quantity, contact)
}

/// Stores an estimate and its standard error.
fn measured(exponent: &mut Exponent, estimate: Option<[f64; 2]>) {
    if let Some([estimate, error]) = estimate {
        exponent.source = ExponentSource::Measured;
        (exponent.estimate, exponent.standard_error) = (Some(estimate), Some(error));
    }
}

/// Returns the logarithms of all speeds or forces, if all are known and they are not all the same.
fn logarithms(all: &[ConditionSpectrum], of: fn(&Condition) -> Option<f64>) -> Option<Vec<f64>> {
    let known = |one: &ConditionSpectrum| of(&one.condition).filter(|x| *x > 0.0);
    let all: Vec<f64> = all.iter().map(known).collect::<Option<_>>()?;
    let [low, high] = [
        all.iter().copied().fold(f64::INFINITY, f64::min),
        all.iter().copied().fold(0.0, f64::max),
    ];
    let varies = high > 0.0 && !Condition::is_same(low, high);
    varies.then(|| all.iter().map(|x| libm::log(*x)).collect())
}

/// Returns the exponents of the level over speed and force with their standard errors, where the
/// levels determine them.
fn level_exponents(levels: &[f64], axes: [Option<&[f64]>; 2]) -> [Option<[f64; 2]>; 2] {
    let n = levels.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
    let centred = |values: &[f64]| {
        let mean = mean(values);
        values.iter().map(|x| x - mean).collect::<Vec<f64>>()
    };
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let y = centred(levels);
    if !y.iter().all(|x| x.is_finite()) {
        return [None; 2];
    }
    let [v, f] = axes.map(|axis| centred(axis.unwrap_or(&vec![0.0; levels.len()])));
    let (vv, ff, vf) = (product(&v, &v), product(&f, &f), product(&v, &f));
    let (vy, fy) = (product(&v, &y), product(&f, &y));
    let varies = axes.map(|axis| axis.is_some());
    // The inverse of the normal equations, without the unknown of an axis that is constant.
    let determinant = vv * ff - vf * vf;
    let inverse = match varies {
        [true, true] if determinant > 1e-6 * vv * ff => {
            [ff / determinant, -vf / determinant, vv / determinant]
        }
        // Speed and force change together, so neither exponent can be determined.
        [true, true] | [false, false] => return [None; 2],
        [true, false] => [1.0 / vv, 0.0, 0.0],
        [false, true] => [0.0, 0.0, 1.0 / ff],
    };
    let b = inverse[0] * vy + inverse[1] * fy;
    let c = inverse[1] * vy + inverse[2] * fy;
    let unknowns = 1.0 + varies.iter().filter(|varies| **varies).count() as f64;
    let rest = y.iter().zip(&v).zip(&f);
    let squares: f64 = rest.map(|((y, v), f)| (y - b * v - c * f).powi(2)).sum();
    let least = (LEVEL_ERROR_DB * std::f64::consts::LN_10 / 20.0).powi(2);
    let variance = if n > unknowns { (squares / (n - unknowns)).max(least) } else { least };
    let error = |inverse: f64| (variance * inverse).sqrt();
    [varies[0].then(|| [b, error(inverse[0])]), varies[1].then(|| [c, error(inverse[2])])]
}

/// Returns the exponent of frequencies over the speed with its standard error, if the spectra
/// determine it.
fn frequency_exponent(curves: &[Curve], speeds: &[f64], assumed: f64) -> Option<[f64; 2]> {
    let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
    let octaves: Vec<f64> =
        speeds.iter().map(|speed| (speed - mean) / std::f64::consts::LN_2).collect();
    let differ = |a: f64| difference(curves, &octaves, a);
    let all: Vec<(f64, Difference)> = TRIED
        .map(|hundredths| f64::from(hundredths) / 100.0)
        .filter_map(|a| Some((a, differ(a)?)))
        .collect();
    let (best, least) = all.iter().min_by(|x, y| x.1.mean_square.total_cmp(&y.1.mean_square))?;
    // At an end of the tried exponents, the difference may still be falling.
    let inside = *best > all.first()?.0 && *best < all.last()?.0;
    let [still, usual] = [0.0, assumed].map(|a| differ(a).map_or(0.0, |d| d.mean_square));
    if !inside || least.mean_square > MOST_LEFT * still.max(usual) {
        return None;
    }
    // The curvature, from differences one tenth to either side.
    let step = 0.1;
    let around = differ(best - step)?.mean_square + differ(best + step)?.mean_square;
    let curvature = (around - 2.0 * least.mean_square) / (step * step);
    let error = (2.0 * least.mean_square / (least.count * curvature)).sqrt();
    error.is_finite().then_some([*best, error])
}

/// A spectrum's logarithmic power over octaves.
struct Curve {
    low: f64,
    values: Vec<f64>,
}

impl Curve {
    fn new(spectrum: &TextureSpectrum) -> Self {
        let band = spectrum.band;
        let [low, high] = [band.low_hz, band.high_hz].map(libm::log2);
        let grid = band.grid_hz();
        let count = ((high - low) * POINTS) as usize + 1;
        let value = |i: usize| {
            let middle = low + i as f64 / POINTS;
            let [from, to] = [middle - HALF_WIDTH, middle + HALF_WIDTH].map(libm::exp2);
            let near = grid.partition_point(|f| *f < from)..grid.partition_point(|f| *f < to);
            let near = if near.is_empty() {
                near.start.min(grid.len() - 1)..near.start.min(grid.len() - 1) + 1
            } else {
                near
            };
            let power: f64 = spectrum.magnitude[near.clone()].iter().map(|m| m * m).sum();
            libm::log(power / near.len() as f64)
        };
        Self { low, values: (0..count).map(value).collect() }
    }

    fn high(&self) -> f64 {
        self.low + (self.values.len() - 1) as f64 / POINTS
    }

    /// Interpolates linearly at an octave inside the curve.
    fn value_at(&self, octave: f64) -> f64 {
        let place = ((octave - self.low) * POINTS).max(0.0);
        let i = (place as usize).min(self.values.len().saturating_sub(2));
        let part = place - i as f64;
        self.values[i] + part * (self.values[i + 1] - self.values[i])
    }
}

/// How much the shifted curves differ.
struct Difference {
    /// Mean square, in squared natural logarithms of power.
    mean_square: f64,
    /// Number of values that do not overlap.
    count: f64,
}

/// Shifts each curve by `a` times the logarithm of its speed in octaves, and returns how much the
/// shifted curves differ. Only octaves that all curves cover are compared.
fn difference(curves: &[Curve], octaves: &[f64], a: f64) -> Option<Difference> {
    let shifted = || curves.iter().zip(octaves).map(|(curve, o)| (curve, -a * o));
    let low = shifted().map(|(c, s)| c.low + s).fold(f64::MIN, f64::max);
    let high = shifted().map(|(c, s)| c.high() + s).fold(f64::MAX, f64::min);
    let points = ((high - low) * POINTS).floor();
    if points < LEAST_OCTAVES * POINTS || curves.len() < 2 {
        return None;
    }
    let rows: Vec<Vec<f64>> = shifted()
        .map(|(curve, shift)| {
            let value = |i: usize| curve.value_at(low + i as f64 / POINTS - shift);
            let row: Vec<f64> = (0..points as usize).map(value).collect();
            let mean = row.iter().sum::<f64>() / points;
            // Without its mean, a row no longer contains the level.
            row.iter().map(|x| x - mean).collect()
        })
        .collect();
    // The mean of the curves takes one degree of freedom at each point.
    let others = curves.len() as f64 - 1.0;
    let mut squares = 0.0;
    for i in 0..points as usize {
        let mean = rows.iter().map(|row| row[i]).sum::<f64>() / (others + 1.0);
        squares += rows.iter().map(|row| (row[i] - mean).powi(2)).sum::<f64>();
    }
    let mean_square = squares / (others * points);
    mean_square.is_finite().then_some(Difference {
        mean_square,
        count: others * (points / POINTS) / (2.0 * HALF_WIDTH),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The level rises with the speed to the power of 0.6 and with the force to the power of 0.9.
    #[test]
    fn exponents_of_levels_are_found_with_their_errors() {
        let motions = [(20.0, 0.3), (40.0, 0.6), (80.0, 0.3), (160.0, 0.9)];
        let speeds: Vec<f64> = motions.iter().map(|m: &(f64, f64)| m.0.ln()).collect();
        let forces: Vec<f64> = motions.iter().map(|m| m.1.ln()).collect();
        let levels: Vec<f64> =
            speeds.iter().zip(&forces).map(|(v, f)| 0.6 * v + 0.9 * f - 3.0).collect();
        let [b, c] = level_exponents(&levels, [Some(&speeds), Some(&forces)]);
        let ([b, of_b], [c, of_c]) = (b.unwrap_or_default(), c.unwrap_or_default());
        assert!((b - 0.6).abs() < 1e-9 && (c - 0.9).abs() < 1e-9);
        // Two decibels of level error are a fifth over three octaves of speed.
        assert!((0.1..0.3).contains(&of_b) && of_c > of_b, "{of_b}, {of_c}");
        // If speed and force change together, neither exponent can be determined.
        assert_eq!(level_exponents(&levels, [Some(&speeds), Some(&speeds)]), [None; 2]);
    }
}
