//! Measures samples and spectra.

use htex_dsp::spectrum::SegmentAnalyzer;
use htex_host::{Band, GRID_HZ};

use crate::model::case::RATE_HZ;

/// Fraction of a spectrum's energy that the compared bins contain.
const JUDGED: f64 = 0.99;

/// Returns the root mean square.
pub(crate) fn rms(samples: &[f32]) -> f64 {
    let power: f64 = samples.iter().map(|&x| f64::from(x).powi(2)).sum();
    (power / samples.len().max(1) as f64).sqrt()
}

/// Returns the RMS-averaged texture spectrum of samples at [`RATE_HZ`] on the tactile grid, with
/// segments of 0.2 s that overlap by half and a periodic Hann window.
pub(crate) fn measured_spectrum(samples: &[f32]) -> Vec<f64> {
    let len = (RATE_HZ / GRID_HZ) as usize;
    let mut analyzer = SegmentAnalyzer::new(len);
    let mut bins = analyzer.make_bins();
    let mut power = vec![0.0; Band::TACTILE.bins()];
    let mut count = 0.0;
    for segment in samples.windows(len).step_by(len / 2) {
        let segment: Vec<f64> = segment.iter().map(|&x| x.into()).collect();
        // This cannot fail, because the lengths come from the analyser.
        if analyzer.analyze(&segment, &mut bins).is_err() {
            continue;
        }
        let inside = &bins[Band::TACTILE.first_bin()..];
        for (p, x) in power.iter_mut().zip(inside) {
            *p += x.norm_sqr();
        }
        count += 1.0;
    }
    let scale = analyzer.amplitude_scale();
    power.iter().map(|p| (p / count).sqrt() * scale).collect()
}

/// Returns the RMS difference of two spectra in decibels, after their levels were matched. Compares
/// only the strongest bins of the reference, which contain 99 % of its energy.
pub(crate) fn distance_db(measured: &[f64], reference: &[f64]) -> f64 {
    let energy = |m: &[f64]| m.iter().map(|m| m * m).sum::<f64>();
    let total = energy(reference);
    // Matches the levels.
    let gain = (total / energy(measured)).sqrt();
    let mut order: Vec<usize> = (0..reference.len()).collect();
    order.sort_by(|&a, &b| reference[b].total_cmp(&reference[a]));
    let (mut held, mut sum, mut n) = (0.0, 0.0, 0.0);
    for i in order {
        if held >= JUDGED * total {
            break;
        }
        held += reference[i] * reference[i];
        // No bin is 0 here, because the strongest bins come first and end at 99 % of the energy.
        let db = 20.0 * (gain * measured[i] / reference[i]).log10();
        sum += db * db;
        n += 1.0;
    }
    (sum / n).sqrt()
}

/// Returns the spectrum that the periodic Hann window measures for noise whose density has these
/// magnitudes. Two thirds of a bin's power stay in the bin, and a sixth goes to each neighbour.
/// Outside the band there is no power.
pub(crate) fn read_as_noise(magnitude: &[f64]) -> Vec<f64> {
    let power = |i: Option<usize>| i.and_then(|i| magnitude.get(i)).map_or(0.0, |m| m * m);
    let read = |i: usize| {
        let beside = power(i.checked_sub(1)) + power(Some(i + 1));
        ((beside + 4.0 * power(Some(i))) / 6.0).sqrt()
    };
    (0..magnitude.len()).map(read).collect()
}

/// Returns the relative standard deviation of the RMS of `seconds` of noise with this spectrum. It
/// is half the relative standard deviation of the power, which is `1 / sqrt(B T)` with the
/// equivalent bandwidth `B = (Σ m²)² Δf / Σ m⁴`.
pub(crate) fn rms_spread(magnitude: &[f64], seconds: f64) -> f64 {
    rms_spread_at(magnitude, GRID_HZ, seconds)
}

/// Computes [`rms_spread`] for magnitudes at steps of `step_hz`.
pub(crate) fn rms_spread_at(magnitude: &[f64], step_hz: f64, seconds: f64) -> f64 {
    let moment = |n: i32| magnitude.iter().map(|m| m.powi(n)).sum::<f64>();
    let bandwidth_hz = moment(2).powi(2) / moment(4) * step_hz;
    0.5 / (bandwidth_hz * seconds).sqrt()
}

/// Returns the largest second difference of a signal.
pub(crate) fn sharpest_bend(samples: &[f32]) -> f32 {
    let bend = |x: &[f32]| (x[2] - 2.0 * x[1] + x[0]).abs();
    samples.windows(3).map(bend).fold(0.0, f32::max)
}

/// Returns the index of the first sample whose bits differ between two signals.
pub(crate) fn first_difference(a: &[f32], b: &[f32]) -> Option<usize> {
    // Bits are compared, so that NaN equals itself and -0 differs from 0.
    a.iter().zip(b).position(|(a, b)| a.to_bits() != b.to_bits())
}

/// Returns whether a spectrum of the tactile band consists of lines, i.e. whether most magnitudes
/// on a fine grid are 0.
pub(crate) fn is_line_spectrum(fine: &[f64]) -> bool {
    let largest = fine.iter().copied().fold(0.0, f64::max);
    let empty = fine.iter().filter(|m| **m <= 1e-9 * largest).count();
    2 * empty > fine.len()
}
