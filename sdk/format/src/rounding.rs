//! Rounding of the manifest's numbers when an asset is written.

use crate::Manifest;
use crate::manifest::{AtCondition, Quality};

impl Manifest {
    /// Returns the manifest as it is read back: agreement and repeatability to four decimals, levels to
    /// nine significant digits. Rounding again changes nothing.
    pub fn rounded(&self) -> Self {
        let mut rounded = self.clone();
        for condition in &mut rounded.conditions {
            four_decimals(condition.repeatability_rms_db.iter_mut());
        }
        for representation in &mut rounded.representations {
            representation.at.iter_mut().for_each(round_at);
        }
        rounded
    }
}

fn round_at(at: &mut AtCondition) {
    at.level_rms = reread(&format!("{:.8e}", at.level_rms), at.level_rms);
    if let Some(quality) = &mut at.quality {
        round_quality(quality);
    }
    if let Some(left_out) = &mut at.left_out {
        let third_octave = left_out.third_octave_error_rms_db.iter_mut();
        four_decimals(third_octave.chain([&mut left_out.band_error_rms_db]));
    }
}

fn round_quality(quality: &mut Quality) {
    let Quality {
        spectral_correlation,
        band_error_db,
        band_error_rms_db,
        band_error_matched_rms_db,
        third_octave_error_rms_db,
        log_spectral_distance_db,
        samples_spectral_correlation,
        samples_band_error_rms_db,
        samples_third_octave_error_rms_db,
        samples_log_spectral_distance_db,
        rounding_error_db,
    } = quality;
    four_decimals([spectral_correlation, band_error_rms_db].into_iter());
    four_decimals(band_error_db.iter_mut());
    let optional = [
        band_error_matched_rms_db,
        third_octave_error_rms_db,
        log_spectral_distance_db,
        samples_spectral_correlation,
        samples_band_error_rms_db,
        samples_third_octave_error_rms_db,
        samples_log_spectral_distance_db,
        rounding_error_db,
    ];
    four_decimals(optional.into_iter().flatten());
}

fn four_decimals<'a>(numbers: impl Iterator<Item = &'a mut f64>) {
    for number in numbers {
        *number = reread(&format!("{number:.4}"), *number);
    }
}

/// Parses a number and removes a negative zero; returns `otherwise` when it is not finite.
fn reread(text: &str, otherwise: f64) -> f64 {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => number + 0.0,
        _ => otherwise,
    }
}
