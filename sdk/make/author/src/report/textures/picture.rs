//! Spectra of several textures as one picture: one column for each texture, one row for each model.

use super::data::{ModelResult, Texture};
use super::spectra::{overlay, top};
use crate::report::markup::Element;
use crate::report::number::px;
use crate::report::plot::{FONT, INK, Plot};
use crate::report::svg::{self, TEXT_PX};

/// Size of one panel, pixels.
const PANEL: (f64, f64) = (230.0, 190.0);
/// Height of the caption below the panels, pixels.
const CAPTION_PX: f64 = 26.0;

/// Draws each texture's recording, overlaid with each of the named models, as a self-contained SVG.
/// If a texture lacks a model, the panel for this texture and model stays empty.
pub fn spectra_picture(textures: &[Texture], short_names: &[&str]) -> String {
    let width = PANEL.0 * textures.len() as f64;
    let height = PANEL.1 * short_names.len() as f64 + CAPTION_PX;
    let panels = textures.iter().enumerate().flat_map(|(column, texture)| {
        let of_texture = texture_panels(texture, short_names);
        let at = move |(row, panel): (usize, Plot)| placed(column, row, &panel);
        of_texture.into_iter().map(at)
    });
    Element::new("svg")
        .set("xmlns", "http://www.w3.org/2000/svg")
        .set("viewBox", &format!("0 0 {} {}", px(width), px(height)))
        .set("width", &px(width))
        .set("height", &px(height))
        .set("role", "img")
        .set("aria-label", "Spectra of recordings, and of models over them")
        .set("font-family", FONT)
        .set("font-size", &px(TEXT_PX))
        .set("fill", INK)
        .child(&svg::rect(0.0, 0.0, width, height).set("fill", "#fff"))
        .children(panels)
        .child(&caption(textures, short_names, height))
        .render()
        + "\n"
}

/// Returns the panels of a texture, each with its row. All have the same vertical axis.
fn texture_panels(texture: &Texture, short_names: &[&str]) -> Vec<(usize, Plot)> {
    let rows = short_names.iter().enumerate();
    let found = rows.filter_map(|(row, name)| Some((row, texture.model(name)?)));
    let found: Vec<(usize, &ModelResult)> = found.collect();
    let top = top(texture, found.iter().map(|(_, model)| *model));
    let panel = |(row, model): (usize, &ModelResult)| {
        let title = format!("{}: {} bytes", texture.name, model.payload_bytes);
        let plot = Plot { width: PANEL.0, height: PANEL.1, ..overlay(&title, texture, model, top) };
        (row, plot)
    };
    found.into_iter().map(panel).collect()
}

fn placed(column: usize, row: usize, panel: &Plot) -> Element {
    let (x, y) = (column as f64 * PANEL.0, row as f64 * PANEL.1);
    Element::new("g")
        .set("transform", &format!("translate({} {})", px(x), px(y)))
        .raw(&panel.to_svg())
}

fn caption(textures: &[Texture], short_names: &[&str], height: f64) -> Element {
    let kind = if textures.iter().all(|texture| texture.simulated) {
        "simulated recording"
    } else {
        "recording"
    };
    let name = |short: &&str| Some(&textures.iter().find_map(|t| t.model(short))?.model[..]);
    let names: Vec<&str> = short_names.iter().filter_map(name).collect();
    let text = format!(
        "Grey: {kind}. Colour: models, row by row {}, with the bytes of their parameters.",
        names.join(", ")
    );
    Element::new("text").set("x", "24").set("y", &px(height - 9.0)).text(&text)
}
