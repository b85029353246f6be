//! Rounding of the manifest's numbers when an asset is written.

use crate::manifest::AtCondition;
use crate::{Manifest, Quality};

impl Manifest {
    /// Returns the manifest as a writer stores it: with the lowest version that has its keys
    /// ([`Self::lowest_version`]), measures of agreement and repeatability rounded to four decimals,
    /// and levels to nine significant digits. Applying this twice changes nothing.
    pub fn rounded(&self) -> Self {
        let mut rounded = self.clone();
        rounded.htex = self.lowest_version();
        for condition in &mut rounded.conditions {
            four_decimals(condition.repeatability_rms_db.iter_mut());
            four_decimals(condition.repeatability_third_octave_rms_db.iter_mut());
        }
        for representation in &mut rounded.representations {
            representation.at.iter_mut().for_each(round_at);
        }
        rounded
    }
}

fn round_at(at: &mut AtCondition) {
    // Rounded by way of text: the nearest number to a decimal text stays the same when it is
    // rounded again, while multiplying and dividing by a power of ten would round twice more.
    at.level_rms = reread(&format!("{:.8e}", at.level_rms), at.level_rms);
    if let Some(quality) = &mut at.quality {
        round_quality(quality);
    }
    if let Some(left_out) = &mut at.left_out {
        four_decimals(left_out.0.iter_mut());
    }
}

fn round_quality(quality: &mut Quality) {
    four_decimals(quality.by_magnitude.iter_mut());
    four_decimals(quality.by_samples.iter_mut());
    four_decimals(quality.band_error_db.iter_mut());
    four_decimals(quality.rounding_error_db.iter_mut());
}

fn four_decimals<'a>(numbers: impl Iterator<Item = &'a mut f64>) {
    for number in numbers {
        *number = reread(&format!("{number:.4}"), *number);
    }
}

/// Parses a number and turns a negative zero into zero. Returns `otherwise` if the number is not
/// finite.
fn reread(text: &str, otherwise: f64) -> f64 {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => number + 0.0,
        _ => otherwise,
    }
}
