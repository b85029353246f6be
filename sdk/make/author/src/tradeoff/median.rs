//! Medians of each setting's measurements over several recordings, and the shares of recordings in
//! which a difference is small.

use std::collections::BTreeMap;

use htex_format::{By, Measure, Measures};

use crate::tradeoff::point::{Point, RenderedAccuracy, Shares};

/// Returns one point for each setting that was measured on all `recordings` recordings, in the
/// order of the first recording.
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
    let of = |value: &dyn Fn(&Point) -> f64| {
        let mut values: Vec<f64> = same.iter().map(|p| value(p)).collect();
        values.sort_by(f64::total_cmp);
        let half = values.len() / 2;
        0.5 * (values[half] + values[(values.len() - 1) / 2])
    };
    let all_of = |value: &dyn Fn(&Point) -> Option<f64>| {
        let all = same.iter().all(|p| value(p).is_some());
        all.then(|| of(&|p| value(p).unwrap_or(f64::NAN)))
    };
    let measures = |by| Measures::new(|m| Some(of(&|p| p.get(by, m)))).only(Measure::of_both());
    let mean =
        |value: fn(&Point) -> f64| same.iter().map(|p| value(p)).sum::<f64>() / same.len() as f64;
    Point {
        recording: name.to_owned(),
        fit_ms: of(&|p| p.fit_ms),
        fit_spread: of(&|p| p.fit_spread),
        first_sample_us: of(&|p| p.first_sample_us),
        first_sample_spread: of(&|p| p.first_sample_spread),
        ns_per_sample: of(&|p| p.ns_per_sample),
        spread: of(&|p| p.spread),
        bytes: of(&|p| p.bytes as f64) as usize,
        kept_bytes: of(&|p| p.kept_bytes as f64) as usize,
        held_out_error: all_of(&|p| p.held_out_error),
        held_out_error_db: all_of(&|p| p.held_out_error_db),
        by_magnitude: measures(By::Magnitude),
        shares: Shares {
            below_detection: mean(|p| p.shares.below_detection),
            below_threshold: mean(|p| p.shares.below_threshold),
            below_threshold_if_sensitive: mean(|p| p.shares.below_threshold_if_sensitive),
            within_repeatability: mean(|p| p.shares.within_repeatability),
        },
        by_samples: RenderedAccuracy {
            measures: measures(By::Samples),
            band_error_spread_db: of(&|p| p.by_samples.band_error_spread_db),
        },
        ..same[0].clone()
    }
}
