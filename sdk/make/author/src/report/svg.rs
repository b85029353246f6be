//! The SVG shapes used in plots.

use crate::report::markup::Element;
use crate::report::number::px;

/// Size of the smallest text, pixels.
pub(crate) const TEXT_PX: f64 = 11.0;

/// Returns an upper estimate of the width of `text` at `size_px` in common sans-serif fonts.
pub(crate) fn text_width(text: &str, size_px: f64) -> f64 {
    0.62 * size_px * text.chars().count() as f64
}

/// Shortens `text` to `width_px`, with an ellipsis if something was cut off.
pub(crate) fn fit_text(text: &str, size_px: f64, width_px: f64) -> String {
    if text_width(text, size_px) <= width_px {
        return text.to_owned();
    }
    let fitting = (width_px / text_width("x", size_px)).max(1.0) as usize - 1;
    let kept: String = text.chars().take(fitting).collect();
    format!("{}\u{2026}", kept.trim_end())
}

/// Draws a straight line from `(x1, y1)` to `(x2, y2)`.
pub(crate) fn line(x1: f64, y1: f64, x2: f64, y2: f64) -> Element {
    let element = Element::new("line").set("x1", &px(x1)).set("y1", &px(y1));
    element.set("x2", &px(x2)).set("y2", &px(y2))
}

/// Draws a circle of radius `radius` around `(x, y)`.
pub(crate) fn circle(x: f64, y: f64, radius: f64) -> Element {
    let element = Element::new("circle").set("cx", &px(x)).set("cy", &px(y));
    element.set("r", &px(radius))
}

/// Draws a rectangle with its top left corner at `(x, y)`.
pub(crate) fn rect(x: f64, y: f64, width: f64, height: f64) -> Element {
    let element = Element::new("rect").set("x", &px(x)).set("y", &px(y));
    element.set("width", &px(width)).set("height", &px(height))
}

/// Draws a line through `points`.
pub(crate) fn polyline(points: &[(f64, f64)]) -> Element {
    let pairs: Vec<String> = points.iter().map(|(x, y)| format!("{},{}", px(*x), px(*y))).collect();
    Element::new("polyline").set("points", &pairs.join(" "))
}

/// Writes text with its baseline at `y`, anchored `start`, `middle` or `end` at `x`.
pub(crate) fn label(x: f64, y: f64, anchor: &str, text: &str) -> Element {
    let element = Element::new("text").set("x", &px(x)).set("y", &px(y));
    element.set("text-anchor", anchor).text(text)
}
