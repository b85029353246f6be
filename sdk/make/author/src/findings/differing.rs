//! Detection of recordings whose level differs from the median level of all recordings at the same
//! condition.

use htex_base::finding::Findings;

use super::quantile::median;
use crate::SegmentSpectra;
use htex_recording::rules::RECORDING_LEVELS_DIFFER;

/// A recording is reported if its level differs by more than this factor from the median of its
/// condition: 8 dB. A robot slid ten times over each of 20 materials. No slide differs by more than
/// 5.0 dB from the median of its material. The largest difference between two slides over the same
/// material is 6.2 dB.
// This is ten to the power of 8 / 20. The digits are written out, because a constant cannot call
// libm.
const DIFFERS: f64 = 2.511_886_431_509_58;

/// Defines the finding of this module, for `spec/recording-findings.md`.
pub(super) fn definition() -> String {
    "- `RECORDING_LEVELS_DIFFER`: the level of a recording is the root of the mean over its segments of the sum of their squared magnitudes over the band's bins. Of two or more recordings of one condition, it is more than 8 dB \
     above or below the median of these levels. `htex validate`, which reads recordings one by one, does not have it.\n"
        .to_owned()
}

/// Returns the level of a recording: RMS over the segments that are read, in the recording's unit
/// up to a constant factor.
pub(crate) fn level_of(part: &SegmentSpectra) -> f64 {
    let bins = part.spectra.iter().flatten();
    let sum: f64 = bins.map(htex_dsp::spectrum::Complex::<f64>::norm_sqr).sum();
    (sum / part.spectra.len().max(1) as f64).sqrt()
}

/// Returns the findings for each recording of one condition, given the recordings' levels.
pub(crate) fn differing(levels: &[f64]) -> Vec<Findings> {
    let usual = median(levels).unwrap_or(0.0);
    let judge = |level: &f64| {
        let mut findings = Findings::default();
        let ratio = level / usual;
        if usual > 0.0 && !(1.0 / DIFFERS..=DIFFERS).contains(&ratio) {
            let count = levels.len();
            let message = if ratio > 0.0 {
                format!(
                    "its level is {:.1} dB {} the median of the {count} recordings of this condition",
                    20.0 * libm::log10(ratio).abs(),
                    if ratio > 1.0 { "above" } else { "below" }
                )
            } else {
                format!("it is silent, and the {count} recordings of this condition are not")
            };
            findings.add(
                RECORDING_LEVELS_DIFFER,
                "",
                format!("{message}; give its speed and force, correct its scale, or leave it out"),
            );
        }
        findings
    };
    levels.iter().map(judge).collect()
}
