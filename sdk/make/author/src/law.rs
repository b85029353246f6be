//! The law of a texture recorded at several motions: exponents with their standard errors.
//!
//! Levels: a least-squares fit of `ln L = k + b ln v + c ln F` over the conditions. The level of
//! one recording is assumed to have an error of at least [`LEVEL_ERROR_DB`]. An exponent from only
//! two conditions therefore remains uncertain.
//!
//! Frequencies: each spectrum is shifted by `(v / v0)^a` on a logarithmic axis, and its level is
//! removed. The exponent `a` is the value at which the spectra differ least. But the spectra also
//! change with the speed in other ways than by a shift. In recorded strokes without spectral lines
//! that move with the speed, the best exponent `a` was anywhere between -0.5 and 1.5. With the best
//! exponent, the squared difference was still 0.25 to 0.9 times its value without a shift.
//! Therefore an exponent counts as measured only in two cases: the squared difference falls to a
//! quarter of its value without a shift, or to a quarter of its value at the assumed exponent.
//!
//! Two spectra have many features that a shift can align by accident. In recorded strokes, one of
//! 12 pairs of speeds gave an exponent of 0.70, and no third speed confirmed this exponent.
//! Therefore, an exponent from only two speeds counts as measured only under two conditions: the
//! odd and the even blocks of time give the same exponent, and at most a tenth of the squared
//! difference remains.
//!
//! The standard error comes from a bootstrap: the blocks of every condition are drawn anew, with
//! replacement. On simulated surfaces, the 95 % intervals contain the exponent of the true spectra
//! (`the_intervals_contain_the_exponent_of_the_true_spectra`). The exponent of the true spectra
//! differs from the exponent of the relief, because the responses of skin and sensor do not change
//! with the speed. On a smooth spectrum, skin and sensor lower the exponent by up to 0.25.

use htex_dsp::uniform::Uniform;
use htex_format::{Condition, Contact, Exponent, ExponentSource, Law, Quantity};

use crate::conditions::ConditionSpectrum;
use crate::spectrum::TextureSpectrum;

/// Smallest error assumed for a recorded level, decibels.
const LEVEL_ERROR_DB: f64 = 2.0;
/// An exponent counts as measured only if it reduces the squared difference to at most this
/// fraction. The fraction is relative to the larger of two values: the squared difference without a
/// shift, and the squared difference at the assumed exponent.
const MOST_LEFT: f64 = 0.25;
/// Number of points per octave at which spectra are compared, and half the width of the range that
/// is read for each point, octaves.
const POINTS: f64 = 24.0;
const HALF_WIDTH: f64 = 1.0 / 12.0;
/// Frequency exponents that are tried, in hundredths.
const TRIED: std::ops::RangeInclusive<i32> = -30..=130;
/// Smallest length of the common frequency axis, octaves.
const LEAST_OCTAVES: f64 = 1.0;
/// Number of bootstrap samples, each of which draws the blocks of every condition anew.
const RESAMPLED: usize = 100;
/// With at least this number of different speeds, the blocks of time are not compared to decide
/// whether an exponent counts as measured.
const FEWEST_SPEEDS: usize = 3;
/// If there are two speeds, the squared difference must fall to this fraction. For pairs of
/// recorded strokes without moving lines, the smallest fraction was 0.22. For simulated surfaces,
/// the largest fraction is 0.06.
const MOST_LEFT_OF_TWO: f64 = 0.1;
/// If there are two speeds, the exponents from the odd and the even blocks may differ by at most
/// this number.
const MOST_APART: f64 = 0.1;

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
        measured(&mut law.frequency_speed, frequency_exponent(all, speeds, assumed));
    }
    // This call combines the estimates with the assumed exponents. The assumed exponents of the
    // level depend on the frequency exponent, so all three exponents are passed together.
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

/// Returns the exponents of the level over speed and force, with their standard errors. An exponent
/// is `None` if the levels do not determine it.
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
    // The inverse of the matrix of the normal equations. If an axis is constant, its unknown is
    // left out.
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

/// Returns how frequencies depend on the speed: the exponent and its standard error. Returns `None`
/// if the spectra do not determine the exponent.
fn frequency_exponent(all: &[ConditionSpectrum], speeds: &[f64], assumed: f64) -> Option<[f64; 2]> {
    let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
    let octaves: Vec<f64> =
        speeds.iter().map(|speed| (speed - mean) / std::f64::consts::LN_2).collect();
    let curves: Vec<Curve> = all.iter().map(|one| Curve::new(&one.spectrum)).collect();
    let best = aligned(&curves, &octaves, assumed, MOST_LEFT)?;
    let blocks = BlockCurves::new(all);
    if distinct(speeds) < FEWEST_SPEEDS {
        let half = |parity| {
            let curves = blocks.as_ref()?.half(parity);
            aligned(&curves, &octaves, assumed, MOST_LEFT)
        };
        let apart = (half(0)?.exponent - half(1)?.exponent).abs();
        if best.left > MOST_LEFT_OF_TWO || apart > MOST_APART {
            return None;
        }
    }
    let error = match blocks {
        Some(blocks) => blocks.bootstrap_error(&octaves, best.exponent),
        None => curvature_error(&curves, &octaves, &best)?,
    };
    error.is_finite().then_some([best.exponent, error])
}

/// Returns the number of different speeds, from their logarithms.
fn distinct(speeds: &[f64]) -> usize {
    let mut different = Vec::<f64>::new();
    for speed in speeds.iter().map(|log| libm::exp(*log)) {
        if !different.iter().any(|other| Condition::is_same(*other, speed)) {
            different.push(speed);
        }
    }
    different.len()
}

/// The exponent at which spectra differ least.
struct Aligned {
    exponent: f64,
    difference: Difference,
    /// The squared difference, divided by the larger of two values: the squared difference without
    /// a shift, and the squared difference at the assumed exponent.
    left: f64,
}

/// Finds the exponent at which the shifted curves differ least. `None` if more than `most_left` of
/// the squared difference remains.
fn aligned(curves: &[Curve], octaves: &[f64], assumed: f64, most_left: f64) -> Option<Aligned> {
    let differ = |a: f64| difference(curves, octaves, a);
    let all: Vec<(f64, Difference)> = TRIED
        .map(|hundredths| f64::from(hundredths) / 100.0)
        .filter_map(|a| Some((a, differ(a)?)))
        .collect();
    let ends = [all.first()?.0, all.last()?.0];
    let least =
        |x: &(f64, Difference), y: &(f64, Difference)| x.1.mean_square.total_cmp(&y.1.mean_square);
    let (exponent, difference) = all.into_iter().min_by(least)?;
    let [still, usual] = [0.0, assumed].map(|a| differ(a).map_or(0.0, |d| d.mean_square));
    let left = difference.mean_square / still.max(usual);
    // If the smallest difference is at an end of the range of tried exponents, the true minimum may
    // lie outside this range.
    let inside = exponent > ends[0] && exponent < ends[1];
    (inside && left <= most_left).then_some(Aligned { exponent, difference, left })
}

/// Returns the standard error of an exponent. It is computed from the curvature of the difference,
/// which is evaluated 0.1 to either side of the exponent.
fn curvature_error(curves: &[Curve], octaves: &[f64], best: &Aligned) -> Option<f64> {
    let step = 0.1;
    let differ = |a: f64| difference(curves, octaves, a).map(|d| d.mean_square);
    let least = &best.difference;
    let around = differ(best.exponent - step)? + differ(best.exponent + step)?;
    let curvature = (around - 2.0 * least.mean_square) / (step * step);
    Some((2.0 * least.mean_square / (least.count * curvature)).sqrt())
}

/// For every condition, the blocks of time, as powers at the points of a [`Curve`].
struct BlockCurves {
    low: f64,
    conditions: Vec<Vec<Vec<f64>>>,
}

impl BlockCurves {
    /// `None` if a condition has fewer than four blocks.
    fn new(all: &[ConditionSpectrum]) -> Option<Self> {
        let band = all.first()?.spectrum.band;
        let points = CurvePoints::new(band);
        let of = |one: &ConditionSpectrum| {
            let blocks = one.block_power.as_ref()?;
            Some(blocks.iter().map(|power| points.powers(|k| power[k])).collect())
        };
        Some(Self { low: points.low, conditions: all.iter().map(of).collect::<Option<_>>()? })
    }

    /// Returns the curve of the mean power of the chosen blocks.
    fn curve<'a>(&self, chosen: impl Iterator<Item = &'a Vec<f64>>) -> Curve {
        let mut sum = Vec::new();
        for powers in chosen {
            sum.resize(powers.len(), 0.0);
            sum.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power);
        }
        // The sum is not divided by the number of blocks, because this number changes only the
        // level, and the level is removed from every curve.
        Curve { low: self.low, values: sum.into_iter().map(libm::log).collect() }
    }

    /// Returns the curve of each condition from its odd (`parity` 0) or even blocks.
    fn half(&self, parity: usize) -> Vec<Curve> {
        let of = |blocks: &Vec<Vec<f64>>| self.curve(blocks.iter().skip(parity).step_by(2));
        self.conditions.iter().map(of).collect()
    }

    /// Draws the blocks of each condition anew, with replacement, many times, and returns the
    /// standard deviation of the resulting exponents.
    fn bootstrap_error(&self, octaves: &[f64], exponent: f64) -> f64 {
        let mut random = Uniform::new(1);
        let mut sample = || {
            let draw = |blocks: &Vec<Vec<f64>>| {
                let count = blocks.len() as f64;
                let drawn: Vec<usize> =
                    blocks.iter().map(|_| (random.next_unit() * count) as usize).collect();
                self.curve(drawn.iter().map(|i| &blocks[*i]))
            };
            let curves: Vec<Curve> = self.conditions.iter().map(draw).collect();
            nearest_minimum(exponent, |a| difference(&curves, octaves, a).map(|d| d.mean_square))
        };
        let found: Vec<f64> = (0..RESAMPLED).map(|_| sample() - exponent).collect();
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        (found.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (found.len() - 1) as f64).sqrt()
    }
}

/// Finds the minimum of a function near `x` by fitting parabolas.
fn nearest_minimum(mut x: f64, of: impl Fn(f64) -> Option<f64>) -> f64 {
    for step in [0.1, 0.05, 0.05] {
        let [Some(a), Some(b), Some(c)] = [of(x - step), of(x), of(x + step)] else { return x };
        let curvature = a - 2.0 * b + c;
        if curvature > 0.0 {
            x += (0.5 * step * (a - c) / curvature).clamp(-2.0 * step, 2.0 * step);
        } else {
            x += if a < c { -step } else { step };
        }
    }
    x
}

/// The points at which curves are read.
struct CurvePoints {
    low: f64,
    /// For each point, the range of bins.
    bins: Vec<std::ops::Range<usize>>,
}

impl CurvePoints {
    fn new(band: htex_dsp::Band) -> Self {
        let [low, high] = [band.low_hz, band.high_hz].map(libm::log2);
        let grid = band.grid_hz();
        let count = ((high - low) * POINTS) as usize + 1;
        let bins = |i: usize| {
            let middle = low + i as f64 / POINTS;
            let [from, to] = [middle - HALF_WIDTH, middle + HALF_WIDTH].map(libm::exp2);
            let near = grid.partition_point(|f| *f < from)..grid.partition_point(|f| *f < to);
            if near.is_empty() {
                let only = near.start.min(grid.len() - 1);
                return only..only + 1;
            }
            near
        };
        Self { low, bins: (0..count).map(bins).collect() }
    }

    /// Returns the mean power at each point, from the power of each bin.
    fn powers(&self, power: impl Fn(usize) -> f64) -> Vec<f64> {
        let mean = |bins: &std::ops::Range<usize>| {
            bins.clone().map(&power).sum::<f64>() / bins.len() as f64
        };
        self.bins.iter().map(mean).collect()
    }
}

/// A spectrum's logarithmic power over octaves.
struct Curve {
    low: f64,
    values: Vec<f64>,
}

impl Curve {
    fn new(spectrum: &TextureSpectrum) -> Self {
        let points = CurvePoints::new(spectrum.band);
        let powers = points.powers(|k| spectrum.magnitude[k] * spectrum.magnitude[k]);
        Self { low: points.low, values: powers.into_iter().map(libm::log).collect() }
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
    /// Number of independent values, i.e. values whose ranges do not overlap.
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
    // At each point, computing the mean of the curves uses one degree of freedom.
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
    use crate::conditions::ConditionSpectra;
    use crate::simulate::{Departures, FreeMotion, SimulationOptions, Surface, simulate};
    use crate::{AssetRequest, Exploration, SpectrumOptions, Take, segment_take};

    const FORCE_N: f64 = 0.4;
    const SPEEDS_MM_S: [f64; 3] = [40.0, 80.0, 160.0];

    fn steady(
        surface: Surface,
        departures: Departures,
        speed: f64,
        seed: u64,
    ) -> SimulationOptions {
        let motion = FreeMotion::default().with_speed_mm_s([speed; 2]).with_force_n([FORCE_N; 2]);
        SimulationOptions::new(surface)
            .with_free_motion(motion)
            .with_departures(departures)
            .with_rate_hz(5_000.0)
            .with_seed(seed)
    }

    /// The exponent of recordings of a surface at three speeds, with its standard error.
    fn recorded(surface: Surface, departures: Departures, seed: u64) -> Option<[f64; 2]> {
        let takes = SPEEDS_MM_S.iter().enumerate().map(|(i, &speed)| {
            let options = steady(surface, departures, speed, 3 * seed + i as u64);
            let recording = simulate(&options).unwrap().to_recording("steady.csv").unwrap();
            let given = Exploration { speed_mm_s: Some(speed), force_n: Some(FORCE_N) };
            segment_take(&Take { recording, given }, &SpectrumOptions::default(), false).unwrap()
        });
        let all = ConditionSpectra::new(takes.collect(), &AssetRequest::new("law")).unwrap();
        let found = all.law.frequency_speed;
        Some([found.estimate?, found.standard_error?])
    }

    /// The exponent of the true spectra of a surface.
    fn truth(surface: Surface, departures: Departures) -> Option<f64> {
        let all = SPEEDS_MM_S.map(|speed| {
            let options = steady(surface, departures, speed, 0);
            let truth = options.truth().unwrap();
            let (frequency_hz, magnitude) =
                (truth.frequency_hz(), truth.magnitude(speed, FORCE_N).unwrap());
            let condition = Condition {
                speed_mm_s: Some(speed),
                force_n: Some(FORCE_N),
                ..Condition::default()
            };
            let spectrum = TextureSpectrum {
                quantity: Quantity::LateralForce,
                band: htex_dsp::Band::TACTILE,
                frequency_hz,
                magnitude,
                segments: 1,
                repeatability: None,
                signal: Vec::new(),
                signal_rate_hz: 5_000.0,
            };
            ConditionSpectrum::new(condition, spectrum)
        });
        law(&all, Contact::Finger).frequency_speed.estimate
    }

    /// The stated 95 % intervals contain the exponent of the true spectra.
    #[test]
    fn the_intervals_contain_the_exponent_of_the_true_spectra() {
        let seeds = if xtask::prove::whole() { 20 } else { 2 };
        let relief = Departures::default();
        let other = relief.with_frequency_speed(0.0).with_level_speed(0.5);
        let half = relief.with_frequency_speed(0.5);
        let (mut inside, mut all) = (0, 0);
        for surface in Surface::ALL {
            for departures in [relief, half, other] {
                let Some(truth) = truth(surface, departures) else { continue };
                for seed in 0..seeds {
                    let Some([estimate, error]) = recorded(surface, departures, seed) else {
                        continue;
                    };
                    let off = (estimate - truth) / error;
                    println!("{surface} {truth:.2}: {estimate:.3} ± {error:.3}, {off:.1}");
                    all += 1;
                    inside += usize::from(off.abs() <= 1.96);
                }
            }
        }
        println!("{inside} of {all} intervals contain the true exponent");
        let share = inside as f64 / f64::from(all);
        // If the true share is 90 to 98 %, a sample of 30 contains 24 to 30 such intervals with a
        // probability of 99.9 %.
        let least = if xtask::prove::whole() { 0.9 } else { 0.8 };
        assert!(share >= least, "{share}");
    }

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
        // A level error of two decibels gives an error of about a fifth in the exponent over three
        // octaves of speed.
        assert!((0.1..0.3).contains(&of_b) && of_c > of_b, "{of_b}, {of_c}");
        // If speed and force change together, neither exponent can be determined.
        assert_eq!(level_exponents(&levels, [Some(&speeds), Some(&speeds)]), [None; 2]);
    }
}
