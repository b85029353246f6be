//! Table of sizes in bytes: recording, asset, and each model's parameters.

use super::data::{ModelResult, Texture, TextureReport};
use crate::report::number::{bytes, ratio};
use crate::report::table::{Cell, HeatScale, Row, Table};

const CAPTION: &str = "Bytes (1 kB = 1000 B); for a model, the bytes of its parameters. \
                       Below each, the ratio of the recording file's size to it";

pub(super) fn table(report: &TextureReport) -> String {
    let models = report.models();
    let files = ["recording file", "asset file"].map(str::to_owned);
    let names = models.iter().map(|model| model.model.clone());
    let rows = report.textures.iter().map(|texture| row(texture, &models));
    let table = Table {
        caption: CAPTION.to_owned(),
        corner: "texture".to_owned(),
        columns: files.into_iter().chain(names).collect(),
        rows: rows.collect(),
        scale: HeatScale::None,
        decimals: 0,
    };
    table.to_html()
}

fn row(texture: &Texture, models: &[&ModelResult]) -> Row {
    let recording = Cell::Text(bytes(texture.recording_bytes), String::new());
    let asset = size(texture, texture.asset_bytes);
    let payload =
        |short_name: &str| texture.model(short_name).map(|model| model.payload_bytes as u64);
    let sizes = models
        .iter()
        .map(|model| payload(&model.short_name))
        .map(|found| found.map_or(Cell::Missing, |count| size(texture, count)));
    Row { header: texture.header(), cells: [recording, asset].into_iter().chain(sizes).collect() }
}

fn size(texture: &Texture, count: u64) -> Cell {
    Cell::Text(bytes(count), ratio(texture.recording_bytes, count))
}
