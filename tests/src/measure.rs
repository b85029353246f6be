//! Measures a voice's samples, for comparison with its model's magnitude.

use htex_dsp::Band;
use htex_dsp::spectrum::SegmentAnalyzer;

/// The sample rate of measured samples, hertz.
pub const RATE_HZ: f64 = 20_000.0;
/// Samples in one segment: bins of 5 Hz.
const SEGMENT: usize = 4_000;

/// RMS-averaged texture spectrum of samples at [`RATE_HZ`], on the grid of the tactile band.
pub fn measured_spectrum(samples: &[f32]) -> Vec<f64> {
    let mut analyzer = SegmentAnalyzer::new(SEGMENT);
    let mut bins = analyzer.make_bins();
    let mut power = vec![0.0; Band::TACTILE.bins()];
    let mut count = 0.0;
    for start in (0..samples.len() - SEGMENT).step_by(SEGMENT / 2) {
        let segment: Vec<f64> = samples[start..start + SEGMENT].iter().map(|&x| x.into()).collect();
        analyzer.analyze(&segment, &mut bins).unwrap();
        power
            .iter_mut()
            .zip(&bins[Band::TACTILE.first_bin()..])
            .for_each(|(p, x)| *p += x.norm_sqr());
        count += 1.0;
    }
    power.iter().map(|p| (p / count).sqrt() * analyzer.amplitude_scale()).collect()
}

/// RMS difference of two spectra in decibels, over the reference's strongest bins, which contain 99
/// % of its energy.
pub fn distance_db(measured: &[f64], reference: &[f64]) -> f64 {
    let mut order: Vec<usize> = (0..reference.len()).collect();
    order.sort_by(|&a, &b| reference[b].total_cmp(&reference[a]));
    let total: f64 = reference.iter().map(|m| m * m).sum();
    let (mut held, mut sum, mut n) = (0.0, 0.0, 0.0);
    for i in order {
        if held >= 0.99 * total {
            break;
        }
        held += reference[i] * reference[i];
        let db = 20.0 * (measured[i] / reference[i]).log10();
        sum += db * db;
        n += 1.0;
    }
    (sum / n).sqrt()
}

pub fn rms(samples: &[f32]) -> f64 {
    let power: f64 = samples.iter().map(|&x| f64::from(x).powi(2)).sum();
    (power / samples.len() as f64).sqrt()
}
