//! Line and scatter plots as one SVG element.

use crate::report::axis::Axis;
use crate::report::legend;
use crate::report::markup::Element;
use crate::report::number::px;
use crate::report::projection::Projection;
use crate::report::series::Series;
use crate::report::svg::{self, TEXT_PX, fit_text, text_width};
use crate::report::ticks::Tick;

const TITLE_PX: f64 = 12.0;
pub(crate) const FONT: &str = "system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', sans-serif";
pub(crate) const INK: &str = "#222";
const GRID: &str = "#e3e3e3";
const MINOR_GRID: &str = "#f2f2f2";

/// A line or scatter plot with axes, series and a title.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Title above the plot, which is also its name for screen readers.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The series in drawing order; the last one is on top.
    pub series: Vec<Series>,
    /// Width of the whole picture, pixels.
    pub width: f64,
    /// Height of the whole picture, pixels.
    pub height: f64,
    /// Whether to show a legend above the plot.
    pub legend: bool,
}

impl Plot {
    /// Creates an empty plot of 480 by 300 pixels with a legend.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        Self {
            title: title.to_owned(),
            x,
            y,
            series: Vec::new(),
            width: 480.0,
            height: 300.0,
            legend: true,
        }
    }

    /// Returns the width with which the plot is drawn, pixels.
    pub(crate) fn drawn_width(&self) -> f64 {
        size(self.width, 480.0)
    }

    /// Returns the height with which the plot is drawn, pixels.
    pub(crate) fn drawn_height(&self) -> f64 {
        size(self.height, 300.0)
    }

    /// Draws the plot as an `<svg>` element, which can be a file of its own or part of a page.
    pub fn to_svg(&self) -> String {
        self.to_svg_from(0.0)
    }

    /// Returns where the data area begins, pixels from the left.
    pub(crate) fn data_left(&self) -> f64 {
        Drawing::new(self, 0.0).area.left
    }

    /// Draws the plot with its data area at least `least_left` pixels from the left.
    pub(crate) fn to_svg_from(&self, least_left: f64) -> String {
        let drawing = Drawing::new(self, least_left);
        let (width, height) = (drawing.width, drawing.height);
        Element::new("svg")
            .set("xmlns", "http://www.w3.org/2000/svg")
            .set("viewBox", &format!("0 0 {} {}", px(width), px(height)))
            .set("width", &px(width))
            .set("height", &px(height))
            .set("role", "img")
            .set("aria-label", &self.title)
            .set("font-family", FONT)
            .set("font-size", &px(TEXT_PX))
            .set("fill", INK)
            .set("style", "color-scheme:light")
            .child(&svg::rect(0.0, 0.0, width, height).set("fill", "#fff"))
            .children(drawing.heading())
            .children(drawing.x_axis())
            .children(drawing.y_axis())
            .child(&drawing.data())
            .child(&drawing.border())
            .render()
    }
}

/// A plot together with its layout.
pub(crate) struct Drawing<'a> {
    pub(crate) plot: &'a Plot,
    width: f64,
    height: f64,
    pub(crate) x: Projection,
    pub(crate) y: Projection,
    x_ticks: Vec<(f64, Tick)>,
    y_ticks: Vec<(f64, Tick)>,
    legend: Vec<(f64, f64, &'a Series)>,
    pub(crate) area: Area,
}

/// The data area, pixels.
pub(crate) struct Area {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl<'a> Drawing<'a> {
    fn new(plot: &'a Plot, least_left: f64) -> Self {
        let (width, height) = (plot.drawn_width(), plot.drawn_height());
        let points = || plot.series.iter().flat_map(|series| &series.points);
        let x = Projection::new(&plot.x, points().map(|p| p.0));
        let y = Projection::new(&plot.y, points().map(|p| p.1));
        let legend = if plot.legend { legend::places(&plot.series, width) } else { Vec::new() };
        let legend_bottom = legend.last().map_or(0.0, |(_, y, _)| y + 12.0);
        let top = legend_bottom.max(if plot.title.is_empty() { 10.0 } else { 24.0 });
        let area_height = (height - top - 38.0).max(30.0);
        let y_ticks = y.ticks((area_height / 26.0) as usize);
        let widest = y_ticks.iter().map(|(_, t)| text_width(&t.label, TEXT_PX)).fold(0.0, f64::max);
        let left = (24.0 + widest).max(least_left);
        let area_width = (width - left - 14.0).max(30.0);
        let x_ticks = x.ticks((area_width / 45.0) as usize);
        let area = Area { left, top, width: area_width, height: area_height };
        Self { plot, width, height, x, y, x_ticks, y_ticks, legend, area }
    }

    fn heading(&self) -> Vec<Element> {
        let title = fit_text(&self.plot.title, TITLE_PX * 1.1, self.width - 16.0);
        let title = svg::label(self.width / 2.0, 15.0, "middle", &title)
            .set("font-size", &px(TITLE_PX))
            .set("font-weight", "600");
        let shown = (!self.plot.title.is_empty()).then_some(title);
        let names = self.legend.iter().map(|(x, y, series)| legend::entry(*x, *y, series));
        shown.into_iter().chain(names).collect()
    }

    fn x_axis(&self) -> Vec<Element> {
        let area = &self.area;
        let bottom = area.top + area.height;
        let mut out = Vec::new();
        for (fraction, tick) in &self.x_ticks {
            let x = area.left + fraction * area.width;
            out.push(grid_line(tick, svg::line(x, area.top, x, bottom)));
        }
        for (x, text) in spaced_labels(&self.x_ticks, area) {
            out.push(svg::label(x, bottom + 14.0, "middle", text));
        }
        let middle = area.left + area.width / 2.0;
        let text = fit_text(&self.plot.x.label, TEXT_PX, self.width);
        out.push(svg::label(middle, bottom + 30.0, "middle", &text));
        out
    }

    fn y_axis(&self) -> Vec<Element> {
        let area = &self.area;
        let mut out = Vec::new();
        for (fraction, tick) in &self.y_ticks {
            let y = area.top + (1.0 - fraction) * area.height;
            out.push(grid_line(tick, svg::line(area.left, y, area.left + area.width, y)));
            if !tick.label.is_empty() {
                out.push(svg::label(area.left - 5.0, y + 4.0, "end", &tick.label));
            }
        }
        let middle = px(area.top + area.height / 2.0);
        let text = fit_text(&self.plot.y.label, TEXT_PX, self.height);
        let turned = format!("rotate(-90 12 {middle})");
        out.push(
            svg::label(12.0, area.top + area.height / 2.0, "middle", &text)
                .set("transform", &turned),
        );
        out
    }

    fn border(&self) -> Element {
        let Area { left, top, width, height } = self.area;
        let border = svg::rect(left, top, width, height);
        border.set("fill", "none").set("stroke", "#8a8a8a").set("pointer-events", "none")
    }
}

/// Returns `given` if it is a valid width or height, otherwise `otherwise`.
fn size(given: f64, otherwise: f64) -> f64 {
    if given.is_finite() { given.clamp(120.0, 10_000.0) } else { otherwise }
}

fn grid_line(tick: &Tick, line: Element) -> Element {
    line.set("stroke", if tick.label.is_empty() { MINOR_GRID } else { GRID })
}

/// Returns the labels of `ticks` that fit without overlap, the most important first.
fn spaced_labels<'t>(ticks: &'t [(f64, Tick)], area: &Area) -> Vec<(f64, &'t str)> {
    let mut order: Vec<&(f64, Tick)> = ticks.iter().filter(|(_, t)| !t.label.is_empty()).collect();
    order.sort_by_key(|(_, tick)| tick.rank);
    let mut kept: Vec<(f64, &str)> = Vec::new();
    for (fraction, tick) in order {
        let x = area.left + fraction * area.width;
        let clearance = |other: &str| {
            (text_width(&tick.label, TEXT_PX) + text_width(other, TEXT_PX)) / 2.0 + 4.0
        };
        if kept.iter().all(|(at, other)| (x - at).abs() >= clearance(other)) {
            kept.push((x, &tick.label));
        }
    }
    kept
}
