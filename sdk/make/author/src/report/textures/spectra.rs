//! For each texture, a row of pictures with its spectra. The first picture shows only the
//! recording; each further picture shows the recording overlaid with one model.

use super::data::{ModelResult, Texture, TextureReport};
use crate::report::axis::Axis;
use crate::report::color::RECORDING_COLOR;
use crate::report::markup::Element;
use crate::report::number::{brief, fixed, px};
use crate::report::plot::Plot;
use crate::report::series::Series;
use crate::report::svg;

/// Size of one panel, pixels.
const PANEL: (f64, f64) = (210.0, 190.0);

/// Colour of the recording when it is drawn behind a model.
const BACKDROP: &str = "#a3a3a3";

/// A model is clipped at this multiple of the recording's maximum. On a longer axis, the curve of
/// the recording would be too flat to read.
const OVERSHOOT: f64 = 2.0;

/// Returns the colour key and the rows of all textures.
pub(super) fn section(report: &TextureReport) -> String {
    let rows = report.textures.iter().map(row);
    let all: String = rows.map(|row| row.render() + "\n").collect();
    key(report).render() + "\n" + &all
}

fn key(report: &TextureReport) -> Element {
    let models = report.models().into_iter().map(|model| key_entry(&model.color, &model.model));
    let recording = key_entry(RECORDING_COLOR, "recording");
    let behind = key_entry(BACKDROP, "recording, behind a model");
    let list = Element::new("ul").set("class", "key");
    list.child(&recording).child(&behind).children(models)
}

fn key_entry(color: &str, name: &str) -> Element {
    let swatch = svg::line(0.0, 5.0, 24.0, 5.0).set("stroke", color).set("stroke-width", "3");
    let swatch = Element::new("svg")
        .set("width", "24")
        .set("height", "10")
        .set("aria-hidden", "true")
        .child(&swatch);
    Element::new("li").child(&swatch).text(name)
}

fn row(texture: &Texture) -> Element {
    let top = top(texture, &texture.models);
    let models = texture.models.iter().map(|model| model_panel(texture, model, top));
    // All in one row, or in two rows of equal length.
    let all = 1 + texture.models.len();
    let half = if all > 4 { all.div_ceil(2) } else { all };
    let panels = Element::new("div")
        .set("class", "panels")
        .set("style", &format!("--all: {all}; --half: {half}"))
        .child(&recording_panel(texture, top))
        .children(models);
    Element::new("section")
        .set("class", "row")
        .child(&row_heading(texture))
        .children([&texture.law, &texture.fluctuation].into_iter().filter_map(|said| detail(said)))
        .child(&panels)
}

/// Returns a paragraph about the texture; `None` if there is nothing to say.
fn detail(said: &str) -> Option<Element> {
    (!said.is_empty()).then(|| Element::new("p").set("class", "law").text(said))
}

fn row_heading(texture: &Texture) -> Element {
    let heading = Element::new("h3").text(&texture.name);
    let heading = if texture.simulated {
        heading.child(&Element::new("span").set("class", "badge").text("simulated"))
    } else {
        heading
    };
    heading.child(&Element::new("span").set("class", "detail").text(&texture.condition))
}

fn recording_panel(texture: &Texture, top: f64) -> Element {
    let title = if texture.simulated { "simulated recording" } else { "recording" };
    let series = Series::line(title, curve(texture, &texture.recorded));
    let note = texture.repeatability_rms_db.map(|db| format!("varies by {} dB RMS", fixed(db, 1)));
    panel(plot(texture, title, vec![series], top), &note.unwrap_or_default())
}

fn model_panel(texture: &Texture, model: &ModelResult, top: f64) -> Element {
    panel(overlay(&model.model, texture, model, top), &model_note(texture, model, top))
}

/// Plots a model over the recording.
pub(super) fn overlay(title: &str, texture: &Texture, model: &ModelResult, top: f64) -> Plot {
    let backdrop = Series::line("recording", curve(texture, &texture.recorded));
    let (scale, _) = texture.plotted();
    let front = match &model.lines {
        Some(lines) => {
            Series::stems(&model.model, lines.iter().map(|(f, a)| (*f, a * scale)).collect())
        }
        None => Series::line(&model.model, curve(texture, &model.magnitude)),
    };
    let front = front.colored(&model.color);
    plot(texture, title, vec![backdrop.behind().colored(BACKDROP), front], top)
}

fn model_note(texture: &Texture, model: &ModelResult, top: f64) -> String {
    let note = model.note.clone();
    let (scale, unit) = texture.plotted();
    match highest(drawn(model), scale) {
        Some(highest) if highest > top => {
            format!("{note}; maximum {} {unit}, clipped", brief(highest))
        }
        _ => note,
    }
}

fn plot(texture: &Texture, title: &str, series: Vec<Series>, top: f64) -> Plot {
    let x = Axis::log("frequency / Hz").with_range(20.0, 1000.0);
    let y = Axis::linear(&format!("magnitude / {}", texture.plotted().1)).with_range(0.0, top);
    Plot { series, width: PANEL.0, height: PANEL.1, legend: false, ..Plot::new(title, x, y) }
}

fn panel(plot: Plot, note: &str) -> Element {
    let width = format!("max-width:{}px", px(2.0 * plot.width));
    let figure = Element::new("figure").set("style", &width).raw(&plot.to_svg());
    figure.child(&Element::new("figcaption").text(note))
}

/// Returns pairs of hertz and magnitude, in the unit of the plots.
fn curve(texture: &Texture, magnitude: &[f64]) -> Vec<(f64, f64)> {
    let pairs = texture.frequency_hz.iter().zip(magnitude);
    let (scale, _) = texture.plotted();
    pairs.map(|(f, n)| (*f, n * scale)).collect()
}

/// Returns the upper end of the vertical axis for some models of a texture, in the unit of the
/// plots.
pub(super) fn top<'a>(texture: &Texture, models: impl IntoIterator<Item = &'a ModelResult>) -> f64 {
    let (scale, _) = texture.plotted();
    let recorded = highest(texture.recorded.iter().copied(), scale);
    let models =
        models.into_iter().filter_map(|model| highest(drawn(model), scale)).fold(0.0, f64::max);
    let highest = recorded.map_or(models, |r| models.min(OVERSHOOT * r).max(r));
    if highest > 0.0 { 1.05 * highest } else { 1.0 }
}

/// Returns the values that a model's panel draws, in the texture's unit.
fn drawn(model: &ModelResult) -> impl Iterator<Item = f64> + '_ {
    let lines = model.lines.iter().flatten().map(|(_, amplitude)| *amplitude);
    let curve = if model.lines.is_some() { &[] } else { model.magnitude.as_slice() };
    lines.chain(curve.iter().copied())
}

/// Returns the highest value above 0, multiplied by `scale`.
fn highest(values: impl Iterator<Item = f64>, scale: f64) -> Option<f64> {
    let positive = values.filter(|v| v.is_finite() && *v > 0.0);
    positive.reduce(f64::max).map(|highest| highest * scale)
}
