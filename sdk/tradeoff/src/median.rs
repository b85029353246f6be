//! Medians of each setting over several recordings, and shares of the recordings.

use std::collections::BTreeMap;

use crate::point::Point;

/// Returns a point for each setting that was measured on all of `recordings`, in the order of the first.
pub(crate) fn medians(points: &[Point], recordings: usize) -> Vec<Point> {
    let mut settings: BTreeMap<String, Vec<&Point>> = BTreeMap::new();
    for point in points {
        settings.entry(point.name()).or_default().push(point);
    }
    let mut medians = Vec::new();
    for point in points {
        let Some(same) = settings.remove(&point.name()) else {
            continue;
        };
        if same.len() == recordings {
            medians.push(median_of(&same, &format!("median of {recordings}")));
        }
    }
    medians
}

fn median_of(same: &[&Point], name: &str) -> Point {
    let of = |value: fn(&Point) -> f64| {
        let mut values: Vec<f64> = same.iter().map(|p| value(p)).collect();
        values.sort_by(f64::total_cmp);
        let half = values.len() / 2;
        0.5 * (values[half] + values[(values.len() - 1) / 2])
    };
    let mean =
        |value: fn(&Point) -> f64| same.iter().map(|p| value(p)).sum::<f64>() / same.len() as f64;
    Point {
        recording: name.to_owned(),
        fit_ms: of(|p| p.fit_ms),
        fit_spread: of(|p| p.fit_spread),
        first_sample_us: of(|p| p.first_sample_us),
        first_sample_spread: of(|p| p.first_sample_spread),
        ns_per_sample: of(|p| p.ns_per_sample),
        spread: of(|p| p.spread),
        bytes: of(|p| p.bytes as f64) as usize,
        kept_bytes: of(|p| p.kept_bytes as f64) as usize,
        spectral_correlation: of(|p| p.spectral_correlation),
        band_error_rms_db: of(|p| p.band_error_rms_db),
        third_octave_error_rms_db: of(|p| p.third_octave_error_rms_db),
        log_spectral_distance_db: of(|p| p.log_spectral_distance_db),
        level_error_db: of(|p| p.level_error_db),
        felt_error_rms_db: of(|p| p.felt_error_rms_db),
        share_below_difference_threshold: mean(|p| p.share_below_difference_threshold),
        share_lossless: mean(|p| p.share_lossless),
        samples_spectral_correlation: of(|p| p.samples_spectral_correlation),
        samples_band_error_rms_db: of(|p| p.samples_band_error_rms_db),
        samples_band_error_spread_db: of(|p| p.samples_band_error_spread_db),
        samples_third_octave_error_rms_db: of(|p| p.samples_third_octave_error_rms_db),
        samples_log_spectral_distance_db: of(|p| p.samples_log_spectral_distance_db),
        samples_level_error_db: of(|p| p.samples_level_error_db),
        samples_felt_error_rms_db: of(|p| p.samples_felt_error_rms_db),
        ..same[0].clone()
    }
}
