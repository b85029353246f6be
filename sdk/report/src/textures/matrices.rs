//! Tables of errors: textures by models, and models by bands.

use super::data::{ModelResult, Texture, TextureReport};
use crate::markup::Element;
use crate::number::fixed;
use crate::page::paragraph;
use crate::table::{Cell, HeatScale, Row, Table};

/// Mark of an error that does not exceed the recording's own variation.
const WITHIN: &str = "\u{a0}*";

/// Error of the darkest shade, decibels.
const DARKEST_DB: f64 = 12.0;

/// Tables of correlation and nine-band error, and of the other measures if they are known.
pub(super) fn summary(report: &TextureReport) -> String {
    let mut out = Element::new("div").set("class", "tables");
    let correlation = correlation(report).to_html();
    out = out
        .raw(&correlation)
        .raw(&error(report, "fitted magnitude", |m| {
            Some(m.band_error_rms_db)
        }));
    let rendered = |m: &ModelResult| m.samples_band_error_rms_db;
    if measured(report, rendered) {
        out = out.raw(&error(report, "rendered samples", rendered));
    }
    let beside: [(&str, Value); 3] = [
        (
            "Third-octave error of the fitted magnitude, RMS in dB",
            |m| m.third_octave_error_rms_db,
        ),
        (
            "Log-spectral distance of the fitted magnitude, RMS in dB",
            |m| m.log_spectral_distance_db,
        ),
        (
            "Felt difference of the fitted magnitude: above the detection threshold, in third octaves, RMS in dB",
            |m| m.felt_error_rms_db,
        ),
    ];
    for (caption, value) in beside {
        if measured(report, value) {
            out = out.raw(&independent_error(report, caption, value));
        }
    }
    let note = paragraph(
        "* at or below the recording's own repeatability: parts of the recording differ from each other \
         by as much, so smaller errors do not distinguish models.",
    );
    out.render() + "\n" + &note
}

type Value = fn(&ModelResult) -> Option<f64>;

fn measured(report: &TextureReport, value: impl Fn(&ModelResult) -> Option<f64>) -> bool {
    let mut models = report.textures.iter().flat_map(|t| &t.models);
    models.any(|m| value(m).is_some())
}

/// Table of an error for which the recording's repeatability is not known.
fn independent_error(report: &TextureReport, caption: &str, value: Value) -> String {
    let cell = |_: &Texture, model: &ModelResult| {
        value(model).map_or(Cell::Missing, |db| Cell::Shaded(db, ""))
    };
    let mut table = by_model(report, cell);
    table.caption = format!("{caption} (0 is the best, light)");
    table.to_html()
}

fn correlation(report: &TextureReport) -> Table {
    let cell = |_: &Texture, model: &ModelResult| Cell::Shaded(model.spectral_correlation, "");
    Table {
        caption: "Spectral correlation with the recording (no unit; 1 is the best, dark)"
            .to_owned(),
        scale: HeatScale::Sequential {
            low: 0.0,
            high: 1.0,
        },
        decimals: 2,
        ..by_model(report, cell)
    }
}

fn error(report: &TextureReport, of: &str, value: impl Fn(&ModelResult) -> Option<f64>) -> String {
    let cell = |texture: &Texture, model: &ModelResult| match value(model) {
        Some(db) if texture.repeatability_rms_db.is_some_and(|own| db <= own) => {
            Cell::Shaded(db, WITHIN)
        }
        Some(db) => Cell::Shaded(db, ""),
        None => Cell::Missing,
    };
    let mut table = by_model(report, cell);
    table.columns.push("recording itself".to_owned());
    for (row, texture) in table.rows.iter_mut().zip(&report.textures) {
        row.cells.push(
            texture
                .repeatability_rms_db
                .map_or(Cell::Missing, Cell::Plain),
        );
    }
    table.caption = format!("Nine-band error of the {of}, RMS in dB (0 is the best, light)");
    table.to_html()
}

/// Table of textures by models.
fn by_model(report: &TextureReport, cell: impl Fn(&Texture, &ModelResult) -> Cell) -> Table {
    let models = report.models();
    let row = |texture: &Texture| {
        let found = models
            .iter()
            .map(|(short_name, _)| texture.model(short_name));
        let cells = found.map(|model| model.map_or(Cell::Missing, |m| cell(texture, m)));
        Row {
            header: texture.header(),
            cells: cells.collect(),
        }
    };
    Table {
        caption: String::new(),
        corner: "texture".to_owned(),
        columns: models.iter().map(|(_, name)| (*name).to_owned()).collect(),
        rows: report.textures.iter().map(row).collect(),
        scale: HeatScale::Sequential {
            low: 0.0,
            high: DARKEST_DB,
        },
        decimals: 1,
    }
}

/// Tables of the nine errors of each model, one per texture.
pub(super) fn bands(report: &TextureReport) -> String {
    let note = paragraph(
        "Model relative to recording in dB: orange is too much vibration in a band, blue is too little. \
         The columns are the bands' centre frequencies in Hz; each band extends to the centres \
         of its neighbours.",
    );
    let fitted = report.textures.iter().filter(|t| !t.models.is_empty());
    let tables: String = fitted.map(|t| band_table(t).to_html()).collect();
    note + "\n"
        + &Element::new("div")
            .set("class", "tables")
            .raw(&tables)
            .render()
}

fn band_table(texture: &Texture) -> Table {
    let row = |model: &ModelResult| Row {
        header: model.model.clone(),
        cells: model
            .band_error_db
            .iter()
            .map(|db| Cell::Shaded(*db, ""))
            .collect(),
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

/// Returns the centres of the nine bands: the inner nine of eleven points evenly spaced in log frequency
/// from 20 to 1000 Hz.
fn band_centres_hz() -> impl Iterator<Item = f64> {
    (1..=9).map(|i| 20.0 * 50f64.powf(f64::from(i) / 10.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fifth_band_is_centred_in_the_tactile_band() {
        let centres: Vec<String> = band_centres_hz().map(|hz| fixed(hz, 0)).collect();
        assert_eq!(
            centres,
            ["30", "44", "65", "96", "141", "209", "309", "457", "676"]
        );
    }
}
