//! Tables of errors. Two kinds of tables: for each measure, a table with a row for each texture and
//! a column for each model; for each texture, a table with a row for each model and a column for
//! each band.

use super::data::{Measure, ModelResult, Texture, TextureReport};
use crate::REPEATABILITY_BOUND;
use crate::report::markup::Element;
use crate::report::number::fixed;
use crate::report::page::paragraph;
use crate::report::table::{Cell, HeatScale, Row, Table};

/// Mark of an error that is within the recording's own variation.
const WITHIN: &str = "\u{a0}*";

/// Error with the darkest shade, decibels.
const DARKEST_DB: f64 = 12.0;
const CORRELATIONS: HeatScale = HeatScale::Sequential { low: 0.0, high: 1.0 };

/// Returns one table for each measure that is known for at least one model.
pub(super) fn summary(report: &TextureReport) -> String {
    let measures = report.measures.iter().enumerate();
    let tables: String = measures
        .filter(|(at, _)| is_known(report, *at))
        .map(|(at, measure)| table(report, at, measure).to_html())
        .collect();
    let out = Element::new("div").set("class", "tables").raw(&tables);
    let note = paragraph(
        "* within repeatability: at most 3.5 times what a second recording is expected to differ by. One in ten second \
         recordings differs by more, so smaller errors do not distinguish models.",
    );
    out.render() + "\n" + &note
}

fn value(model: &ModelResult, at: usize) -> Option<f64> {
    model.measured.get(at).copied().flatten()
}

fn is_known(report: &TextureReport, at: usize) -> bool {
    let mut models = report.textures.iter().flat_map(|t| &t.models);
    models.any(|model| value(model, at).is_some())
}

fn table(report: &TextureReport, at: usize, measure: &Measure) -> Table {
    let cell = |texture: &Texture, model: &ModelResult| {
        let Some(value) = value(model, at) else {
            return Cell::Missing;
        };
        let own = texture.repeatability_rms_db.filter(|_| measure.repeats);
        let mark =
            if own.is_some_and(|own| value <= REPEATABILITY_BOUND * own) { WITHIN } else { "" };
        Cell::Shaded(value, mark)
    };
    let mut table = by_model(report, cell);
    table.caption.clone_from(&measure.caption);
    if measure.is_correlation {
        (table.scale, table.decimals) = (CORRELATIONS, 2);
    }
    if measure.repeats {
        table.columns.push("recording itself".to_owned());
        for (row, texture) in table.rows.iter_mut().zip(&report.textures) {
            let own = texture.repeatability_rms_db;
            row.cells.push(own.map_or(Cell::Missing, Cell::Plain));
        }
    }
    table
}

fn by_model(report: &TextureReport, cell: impl Fn(&Texture, &ModelResult) -> Cell) -> Table {
    let models = report.models();
    let row = |texture: &Texture| {
        let found = models.iter().map(|model| texture.model(&model.short_name));
        let cells = found.map(|model| model.map_or(Cell::Missing, |m| cell(texture, m)));
        Row { header: texture.header(), cells: cells.collect() }
    };
    Table {
        caption: String::new(),
        corner: "texture".to_owned(),
        columns: models.iter().map(|model| model.model.clone()).collect(),
        rows: report.textures.iter().map(row).collect(),
        scale: HeatScale::Sequential { low: 0.0, high: DARKEST_DB },
        decimals: 1,
    }
}

/// Returns one table for each texture, with the nine band errors of each model.
pub(super) fn bands(report: &TextureReport) -> String {
    let note = paragraph(
        "Model relative to recording in dB: orange is too much vibration in a band, blue is too little. \
         The columns are the bands' centre frequencies in Hz; each band extends to the centres \
         of its neighbours.",
    );
    let fitted = report.textures.iter().filter(|t| !t.models.is_empty());
    let tables: String = fitted.map(|t| band_table(t).to_html()).collect();
    note + "\n" + &Element::new("div").set("class", "tables").raw(&tables).render()
}

fn band_table(texture: &Texture) -> Table {
    let row = |model: &ModelResult| Row {
        header: model.model.clone(),
        cells: model.band_error_db.iter().map(|db| Cell::Shaded(*db, "")).collect(),
    };
    Table {
        caption: format!("{}: error / dB", texture.title()),
        corner: "band centre / Hz".to_owned(),
        columns: band_centres_hz().map(|hz| fixed(hz, 0)).collect(),
        rows: texture.models.iter().map(row).collect(),
        scale: HeatScale::Diverging { extent: DARKEST_DB },
        decimals: 1,
    }
}

/// Returns the centres of the nine bands: the inner nine of eleven points evenly spaced in log
/// frequency from 20 to 1000 Hz.
fn band_centres_hz() -> impl Iterator<Item = f64> {
    (1..=9).map(|i| 20.0 * 50f64.powf(f64::from(i) / 10.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fifth_band_is_centred_in_the_tactile_band() {
        let centres: Vec<String> = band_centres_hz().map(|hz| fixed(hz, 0)).collect();
        assert_eq!(centres, ["30", "44", "65", "96", "141", "209", "309", "457", "676"]);
    }
}
