//! Rounding of the manifest's numbers when an asset is written.

use crate::manifest::AtCondition;
use crate::{Manifest, Measure, MeasureKind, Measures};

/// Decimals of measures of agreement, of repeatability and of errors of the fluctuation.
const DECIMALS: usize = 4;
/// Decimals of these numbers in a coded asset, where they would take most of the bytes. Measures of
/// rendered samples vary by ten times as much as a hundredth of a decibel.
const DECIMALS_CODED: usize = 2;

impl Manifest {
    /// Returns the manifest as a writer stores it: with the lowest version that defines its keys
    /// ([`Self::lowest_version`]), and with rounded numbers. Measures of agreement, repeatability
    /// and errors of the fluctuation are rounded to four decimals. In a coded asset, values in
    /// decibels are rounded to two decimals. Levels are rounded to nine significant digits. Applying
    /// this twice changes nothing.
    pub fn rounded(&self) -> Self {
        let mut rounded = self.clone();
        rounded.htex = self.lowest_version();
        let decimals = if self.is_coded() { DECIMALS_CODED } else { DECIMALS };
        for condition in &mut rounded.conditions {
            round(condition.repeatability_rms_db.iter_mut(), decimals);
            round(condition.repeatability_third_octave_rms_db.iter_mut(), decimals);
        }
        if let Some(fluctuation) = &mut rounded.fluctuation {
            round(fluctuation.held_out_error_db.iter_mut(), decimals);
            round(fluctuation.halves_error_db.iter_mut(), decimals);
        }
        for representation in &mut rounded.representations {
            representation.at.iter_mut().for_each(|at| round_at(at, decimals));
        }
        rounded
    }
}

fn round_at(at: &mut AtCondition, decimals: usize) {
    // The number is rounded by writing it as text and reading it again, so that a second rounding
    // does not change it. Multiplying and dividing by a power of ten would add two rounding errors.
    at.level_rms = reread(&format!("{:.8e}", at.level_rms), at.level_rms);
    if let Some(quality) = &mut at.quality {
        round_measures(&mut quality.by_magnitude, decimals);
        round_measures(&mut quality.by_samples, decimals);
        round(quality.band_error_db.iter_mut(), decimals);
        round(quality.rounding_error_db.iter_mut(), decimals);
    }
    if let Some(left_out) = &mut at.left_out {
        round_measures(&mut left_out.0, decimals);
    }
}

fn round_measures(measures: &mut Measures, decimals: usize) {
    for measure in Measure::ALL {
        let decimals = match measure.row().judged {
            MeasureKind::Correlation => DECIMALS,
            _ => decimals,
        };
        round(measures.get_mut(measure).iter_mut(), decimals);
    }
}

fn round<'a>(numbers: impl Iterator<Item = &'a mut f64>, decimals: usize) {
    for number in numbers {
        *number = reread(&format!("{number:.decimals$}"), *number);
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
