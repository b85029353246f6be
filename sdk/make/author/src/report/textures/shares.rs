//! Table with two counts for each model: the number of textures whose error is below the difference
//! threshold, and the number of textures whose error is within the recording's own variation.

use super::data::{Share, TextureReport};
use crate::report::page::paragraph;
use crate::report::table::{Cell, HeatScale, Row, Table};

const CAPTION: &str = "Textures whose difference is below the difference threshold, and textures within what the recording varies";
const NOTE: &str = "Cannot be felt itself: the whole recorded texture is below a fingertip's detection threshold, so no difference from it is judged. Below the difference threshold: what is above a fingertip's detection threshold differs by less than \
    1.6 dB (20 %) in every third octave, and in all together. Sensitive finger: the same for a threshold 10 dB lower and a skin that yields \
    twice as far. Neither is a rating by a participant. Within repeatability: the nine-band error is at most 3.5 times the difference \
    that is expected between two recordings, as for nine in ten second recordings. That says how well the recording repeats, not what is felt.";

/// Returns the table with an explanation; empty if there are no shares.
pub(super) fn table(report: &TextureReport) -> String {
    if report.shares.is_empty() {
        return String::new();
    }
    let columns = [
        "cannot be felt itself",
        "below the difference threshold",
        "the same, sensitive finger",
        "within repeatability",
    ];
    let table = Table {
        caption: CAPTION.to_owned(),
        corner: "model".to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: report.shares.iter().map(|share| row(report, share)).collect(),
        scale: HeatScale::None,
        decimals: 0,
    };
    table.to_html() + "\n" + &paragraph(NOTE)
}

fn row(report: &TextureReport, share: &Share) -> Row {
    let models = report.models();
    let known = models.iter().find(|model| model.short_name == share.short_name);
    let counts = [
        share.below_detection_threshold,
        share.below_difference_threshold,
        share.below_if_sensitive,
        share.within_repeatability,
    ];
    let cell = |count: usize| Cell::Text(format!("{count} of {}", share.textures), String::new());
    Row {
        header: known.map_or(&share.short_name, |model| &model.model).to_owned(),
        cells: counts.map(cell).to_vec(),
    }
}
