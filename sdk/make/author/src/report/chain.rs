//! Diagram of a chain of processing stages, drawn as one SVG element. The diagram shows the running
//! stages with their costs, and the omitted stages in grey.

use crate::report::markup::Element;
use crate::report::number::{brief, px};
use crate::report::plot::{FONT, INK};
use crate::report::svg::{self, TEXT_PX, fit_text};

const WIDTH: f64 = 760.0;
const LEFT: f64 = 16.0;
const BOX_WIDTH: f64 = 520.0;
const BAR_LEFT: f64 = LEFT + BOX_WIDTH + 16.0;
const BAR_WIDTH: f64 = 140.0;
const BOX_HEIGHT: f64 = 40.0;
const GAP: f64 = 14.0;
const TOP: f64 = 58.0;
const NAME_PX: f64 = 13.0;
const FILL: &str = "#f3f8fc";
const LINE: &str = "#0072b2";
const PALE_LINE: &str = "#c4c4c4";
/// A grey with a contrast of 4.5 : 1 on white.
const PALE_INK: &str = "#767676";

/// A chain of processing stages to draw.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// Title above the picture, which is also its name for screen readers.
    pub title: String,
    /// The running stages, in order.
    pub stages: Vec<ChainStage>,
    /// The omitted stages: for each, its name and the reason why it is omitted.
    pub left_out: Vec<(String, String)>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct ChainStage {
    pub name: String,
    /// Why the stage runs.
    pub reason: String,
    /// Sample rate of the stage's output, hertz.
    pub rate_hz: f64,
    /// Computing time of the stage, nanoseconds per sample.
    pub ns_per_sample: f64,
}

impl Chain {
    /// Draws the chain as an `<svg>` element, which can be a file of its own or part of a page.
    pub fn to_svg(&self) -> String {
        let rows = self.stages.len() + self.left_out.len();
        let pale_head = if self.left_out.is_empty() { 0.0 } else { 30.0 };
        let height = TOP + rows as f64 * (BOX_HEIGHT + GAP) + pale_head + 4.0;
        let pale_top = row_top(self.stages.len()) + pale_head;
        Element::new("svg")
            .set("xmlns", "http://www.w3.org/2000/svg")
            .set("viewBox", &format!("0 0 {} {}", px(WIDTH), px(height)))
            .set("width", &px(WIDTH))
            .set("height", &px(height))
            .set("role", "img")
            .set("aria-label", &self.title)
            .set("font-family", FONT)
            .set("font-size", &px(TEXT_PX))
            .set("fill", INK)
            .set("style", "color-scheme:light")
            .child(&svg::rect(0.0, 0.0, WIDTH, height).set("fill", "#fff"))
            .children(self.heading())
            .children(self.stages.iter().enumerate().map(|row| self.stage(row)))
            .children(self.pale_heading(pale_top))
            .children(self.left_out.iter().enumerate().map(|(i, (name, reason))| {
                pale(pale_top + i as f64 * (BOX_HEIGHT + GAP), name, reason)
            }))
            .render()
    }

    fn total_ns(&self) -> f64 {
        self.stages.iter().map(|stage| stage.ns_per_sample).sum()
    }

    fn heading(&self) -> [Element; 2] {
        let title = fit_text(&self.title, 14.0, WIDTH - 2.0 * LEFT);
        let title = svg::label(LEFT, 22.0, "start", &title);
        let total = format!("{} ns a sample in all", brief(self.total_ns()));
        [
            title.set("font-size", "14").set("font-weight", "600"),
            svg::label(BAR_LEFT, TOP - 12.0, "start", &total),
        ]
    }

    fn stage(&self, (row, stage): (usize, &ChainStage)) -> Element {
        let top = row_top(row);
        let rate = format!("{} Hz", brief(stage.rate_hz));
        let boxed = boxed(top, &stage.name, &stage.reason, FILL, LINE)
            .child(&svg::label(LEFT + BOX_WIDTH - 10.0, top + 16.0, "end", &rate))
            .children(self.bar(top, stage.ns_per_sample));
        let (x, next) = (LEFT + 24.0, top + BOX_HEIGHT);
        let is_last = row + 1 == self.stages.len();
        let arrow = (!is_last).then(|| arrow(x, next, next + GAP));
        boxed.children(arrow)
    }

    /// Draws a stage's share of the total cost as a bar with its number.
    fn bar(&self, top: f64, ns: f64) -> [Element; 2] {
        let total = self.total_ns();
        let share = if total > 0.0 { ns / total } else { 0.0 };
        let width = (BAR_WIDTH * share).clamp(1.0, BAR_WIDTH);
        let label = format!("{} ns", brief(ns));
        [
            svg::rect(BAR_LEFT, top + 22.0, width, 10.0).set("fill", LINE),
            svg::label(BAR_LEFT, top + 16.0, "start", &label),
        ]
    }

    fn pale_heading(&self, pale_top: f64) -> Option<Element> {
        let label = svg::label(LEFT, pale_top - 10.0, "start", "Left out").set("fill", PALE_INK);
        (!self.left_out.is_empty()).then_some(label)
    }
}

fn row_top(row: usize) -> f64 {
    TOP + row as f64 * (BOX_HEIGHT + GAP)
}

fn boxed(top: f64, name: &str, reason: &str, fill: &str, line: &str) -> Element {
    let frame = svg::rect(LEFT, top, BOX_WIDTH, BOX_HEIGHT).set("rx", "5");
    let name = svg::label(LEFT + 10.0, top + 16.0, "start", name);
    let reason_text = fit_text(reason, TEXT_PX, BOX_WIDTH + 40.0);
    let reason_text = svg::label(LEFT + 10.0, top + 32.0, "start", &reason_text);
    let title = Element::new("title").text(reason);
    Element::new("g")
        .child(&title)
        .child(&frame.set("fill", fill).set("stroke", line))
        .child(&name.set("font-size", &px(NAME_PX)).set("font-weight", "600"))
        .child(&reason_text)
}

fn pale(top: f64, name: &str, reason: &str) -> Element {
    let boxed = boxed(top, name, reason, "#fff", PALE_LINE);
    boxed.set("fill", PALE_INK).set("stroke-dasharray", "4 3")
}

fn arrow(x: f64, from: f64, to: f64) -> Element {
    let head = svg::polyline(&[(x - 4.0, to - 6.0), (x, to - 1.0), (x + 4.0, to - 6.0)]);
    Element::new("g")
        .set("stroke", LINE)
        .set("fill", "none")
        .child(&svg::line(x, from, x, to - 1.0))
        .child(&head)
}
