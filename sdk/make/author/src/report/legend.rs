//! The legend of a plot: the names of its series with samples of their line styles.

use crate::report::markup::Element;
use crate::report::number::px;
use crate::report::series::{Line, Series};
use crate::report::svg::{self, TEXT_PX, text_width};

/// Places the series' names from left to right below the title, wrapped at `width`.
pub(crate) fn places(series: &[Series], width: f64) -> Vec<(f64, f64, &Series)> {
    let (mut x, mut y) = (12.0, 33.0);
    let mut out = Vec::new();
    for one in series.iter().filter(|one| !one.name.is_empty()) {
        let needed = 26.0 + text_width(&one.name, TEXT_PX) + 12.0;
        if x > 12.0 && x + needed > width {
            (x, y) = (12.0, y + 16.0);
        }
        out.push((x, y, one));
        x += needed;
    }
    out
}

/// Draws a sample of the series' style at `(x, y)` in pixels, followed by its name.
pub(crate) fn entry(x: f64, y: f64, series: &Series) -> Element {
    let sample = match series.line {
        Line::None => None,
        _ => Some(svg::line(x, y - 4.0, x + 20.0, y - 4.0)),
    };
    let dot = series
        .marker_radius_px
        .map(|r| svg::circle(x + 10.0, y - 4.0, r).set("fill", series.marker_fill()));
    let look = stroke(Element::new("g"), series).children(sample).children(dot);
    Element::new("g").child(&look).child(&svg::label(x + 26.0, y, "start", &series.name))
}

/// Applies the series' colour and line style to `element`.
pub(crate) fn stroke(element: Element, series: &Series) -> Element {
    let element = element
        .set("fill", "none")
        .set("stroke", &series.color)
        .set("stroke-width", &px(series.line_width_px))
        .set("stroke-linejoin", "round");
    match series.line {
        Line::Dashed => element.set("stroke-dasharray", "5 3"),
        _ => element,
    }
}
