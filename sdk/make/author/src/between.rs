//! Extra conditions between recorded speeds, computed by the texture's scaling law.
//!
//! A player mixes the parameters of neighbouring conditions. If the relief of a surface produces
//! spectral lines, the frequencies of these lines follow the speed. But mixing two recorded
//! conditions does not move the lines: the lines of one speed fade out while the lines of the next
//! speed fade in. Therefore this module computes further conditions between two recorded speeds. It
//! shifts both recorded spectra to the intermediate speed, by the scaling law. It then mixes the
//! shifted spectra. To test the method, we fitted five simulated reliefs at 40, 80 and 160 mm/s. We
//! compared the fits with the simulation at 57 and 113 mm/s. For corrugated paper, the third-octave
//! errors of the model Bands at 57 and 113 mm/s are 1.2 and 0.8 dB. Without added conditions, these
//! errors would be 4.3 and 5.5 dB. On the other reliefs, the errors are 0.3 to 1.6 dB. Without
//! added conditions, these errors would be 0.6 to 3.4 dB. One of the ten predictions gets worse:
//! the error for vinyl, which has hardly any lines, is 1.6 dB instead of 0.9 dB at 57 mm/s. This
//! module adds conditions only if the recordings show that frequencies follow the speed. We tried
//! third-party recordings of strokes, and they did not show that frequencies follow the speed.

use htex_dsp::grid::level_rms;
use htex_format::{Condition, Exponent, ExponentSource, Law};
use htex_play::Mesh;

use crate::TextureSpectrum;
use crate::conditions::{ConditionSpectrum, four_digits};

/// Smallest frequency exponent at which extra conditions are added. With smaller exponents, lines
/// move too little to need them.
const LEAST_EXPONENT: f64 = 0.5;
/// Largest ratio of neighbouring speeds after conditions are added. Between neighbours, frequencies
/// then move by a fifth at most.
const RATIO: f64 = 1.2;
/// Largest number of conditions that are added.
const MOST: usize = 64;

/// If the frequencies change with the speed in the measured law, returns conditions between
/// recorded conditions of the same force.
pub(crate) fn conditions(recorded: &[ConditionSpectrum], law: &Law) -> Vec<ConditionSpectrum> {
    let Exponent { exponent, source, .. } = law.frequency_speed;
    if source != ExponentSource::Measured || exponent < LEAST_EXPONENT {
        return Vec::new();
    }
    let between = |pair: [usize; 2]| {
        let [slow, fast] = pair.map(|i| &recorded[i]);
        inner(&slow.condition, &fast.condition).into_iter().map(move |motion| {
            let spectrum = mixed([slow, fast], motion, exponent);
            let [speed_mm_s, force_n] = motion.map(|x| Some(four_digits(x)));
            let condition =
                Condition { speed_mm_s, force_n, segments: Some(0), ..Condition::default() };
            ConditionSpectrum { condition, spectrum, block_power: None, halves: None }
        })
    };
    neighbours(recorded).into_iter().flat_map(between).take(MOST).collect()
}

/// Returns the pairs of conditions that have the same force and no third speed between them. In
/// each pair, the slower condition comes first.
fn neighbours(recorded: &[ConditionSpectrum]) -> Vec<[usize; 2]> {
    let known = |i: usize| recorded[i].condition.speed_mm_s.zip(recorded[i].condition.force_n);
    let mut order: Vec<usize> = (0..recorded.len()).filter(|i| known(*i).is_some()).collect();
    htex_dsp::order::sort_by(&mut order, |a, b| {
        known(*a).partial_cmp(&known(*b)).unwrap_or(std::cmp::Ordering::Equal)
    });
    let next = |at: usize| {
        let force = recorded[order[at]].condition.force_n?;
        let same = |i: &&usize| {
            recorded[**i].condition.force_n.is_some_and(|f| Condition::is_same(f, force))
        };
        let next = order[at + 1..].iter().find(same)?;
        Some([order[at], *next])
    };
    (0..order.len()).filter_map(next).collect()
}

/// Returns the motions (speed, force) to add between two conditions. Each speed follows the one
/// before it by the same factor.
fn inner(slow: &Condition, fast: &Condition) -> Vec<[f64; 2]> {
    let both = |of: fn(&Condition) -> Option<f64>| {
        of(slow).zip(of(fast)).filter(|(a, b)| *a > 0.0 && *b > 0.0)
    };
    let (Some((from, to)), Some((light, firm))) = (both(|c| c.speed_mm_s), both(|c| c.force_n))
    else {
        return Vec::new();
    };
    let steps = (libm::log(to / from) / libm::log(RATIO)).ceil() as usize;
    let motion = |step: usize| {
        let part = step as f64 / steps as f64;
        let between = |a: f64, b: f64| a * libm::pow(b / a, part);
        [between(from, to), between(light, firm)]
    };
    (1..steps).map(motion).collect()
}

/// Returns the spectrum at a motion between two recorded conditions. Both recorded spectra are
/// moved to this motion and mixed with the weights and the level that a player would use. In bins
/// where one of the moved spectra has no value, only the other spectrum counts.
fn mixed(both: [&ConditionSpectrum; 2], motion: [f64; 2], exponent: f64) -> TextureSpectrum {
    let motions =
        both.map(|one| [one.condition.speed_mm_s, one.condition.force_n].map(|x| x.unwrap_or(1.0)));
    // This uses the player's own mesh, so that the weights are those with which a player would mix
    // the two conditions.
    let mesh = Mesh::new(&motions);
    let mut weights = [0.0; 2];
    for (i, weight) in mesh.weights(motion[0], motion[1]).iter() {
        weights[i] = weight;
    }
    let factors = motions.map(|own| libm::pow(motion[0] / own[0], exponent));
    let moved = [0, 1].map(|i| moved(&both[i].spectrum, factors[i]));
    let power = |bin: usize| match [moved[0][bin], moved[1][bin]] {
        [Some(a), Some(b)] => weights[0] * a + weights[1] * b,
        [Some(one), None] | [None, Some(one)] => one,
        [None, None] => 0.0,
    };
    let bins = 0..both[0].spectrum.magnitude.len();
    let mut magnitude: Vec<f64> = bins.map(|bin| power(bin).sqrt()).collect();
    let level: f64 = both
        .iter()
        .zip(weights)
        .map(|(one, weight)| weight * level_rms(&one.spectrum.magnitude))
        .sum();
    // A player mixes levels. Mixing powers gives another level.
    let now = level_rms(&magnitude);
    if now > 0.0 {
        magnitude.iter_mut().for_each(|m| *m *= level / now);
    }
    let nearest = usize::from(weights[0] < weights[1]);
    let spectrum = &both[nearest].spectrum;
    TextureSpectrum {
        magnitude,
        segments: 0,
        repeatability: None,
        signal: faster(&spectrum.signal, factors[nearest]),
        ..spectrum.clone()
    }
}

/// Returns the power in each bin after all frequencies are multiplied by `factor`; `None` where
/// nothing was recorded.
fn moved(spectrum: &TextureSpectrum, factor: f64) -> Vec<Option<f64>> {
    let (grid, magnitude) = (&spectrum.frequency_hz, &spectrum.magnitude);
    let power = |at: usize| magnitude[at] * magnitude[at];
    // If frequencies are stretched by `factor`, the same power is spread over `factor` times as
    // many bins.
    let of = |hz: &f64| {
        let from = hz / factor;
        let above = grid.partition_point(|f| *f < from);
        if above == grid.len() {
            return None;
        }
        if grid[above] == from {
            return Some(power(above) / factor);
        }
        let below = above.checked_sub(1)?;
        let part = (from - grid[below]) / (grid[above] - grid[below]);
        Some(((1.0 - part) * power(below) + part * power(above)) / factor)
    };
    grid.iter().map(of).collect()
}

/// Speeds a signal up by `factor`, with linear interpolation between samples.
fn faster(signal: &[f64], factor: f64) -> Vec<f64> {
    let samples = (signal.len() as f64 / factor) as usize;
    let at = |i: usize| {
        let place = i as f64 * factor;
        let before = place as usize;
        let after = signal.get(before + 1).or_else(|| signal.last());
        let (a, b) = (signal.get(before).copied().unwrap_or(0.0), after.copied().unwrap_or(0.0));
        a + (place - before as f64) * (b - a)
    };
    (0..samples).map(at).collect()
}
