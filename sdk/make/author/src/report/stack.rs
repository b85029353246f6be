//! Several plots stacked vertically in one SVG element.

use crate::report::markup::Element;
use crate::report::number::px;
use crate::report::plot::Plot;

/// Draws plots below one another as one self-contained `<svg>` element. The plots keep their order,
/// and their data areas are aligned at the left. `title` is the picture's name for screen readers.
///
/// ```
/// use htex_author::report::{Axis, Plot, stacked};
/// let plot = |name: &str| Plot::new(name, Axis::log("frequency / Hz"), Axis::linear("gain / dB"));
/// let picture = stacked("A response", &[plot("measured"), plot("expected")]);
/// assert!(picture.contains("viewBox=\"0 0 480 600\""));
/// ```
pub fn stacked(title: &str, plots: &[Plot]) -> String {
    let width = plots.iter().map(Plot::drawn_width).fold(0.0, f64::max);
    let left = plots.iter().map(Plot::data_left).fold(0.0, f64::max);
    let mut top = 0.0;
    let mut panels = Vec::with_capacity(plots.len());
    for plot in plots {
        let place = format!("translate(0 {})", px(top));
        let panel = Element::new("g").set("transform", &place);
        panels.push(panel.raw(&plot.to_svg_from(left)));
        top += plot.drawn_height();
    }
    let drawn = Element::new("svg")
        .set("xmlns", "http://www.w3.org/2000/svg")
        .set("viewBox", &format!("0 0 {} {}", px(width), px(top)))
        .set("width", &px(width))
        .set("height", &px(top))
        .set("role", "img")
        .set("aria-label", title)
        .children(panels);
    drawn.render() + "\n"
}
