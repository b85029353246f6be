//! The data area of a plot: lines, stems, markers and hover text.

use crate::report::legend::stroke;
use crate::report::markup::Element;
use crate::report::number::{brief, px};
use crate::report::plot::Drawing;
use crate::report::series::{Line, Series};
use crate::report::svg;

impl Drawing<'_> {
    /// Draws the series in a nested picture that clips at the data area.
    pub(crate) fn data(&self) -> Element {
        let area = &self.area;
        Element::new("svg")
            .set("x", &px(area.left))
            .set("y", &px(area.top))
            .set("width", &px(area.width))
            .set("height", &px(area.height))
            .set("overflow", "hidden")
            .children(self.plot.series.iter().map(|series| self.series(series)))
    }

    fn series(&self, series: &Series) -> Element {
        let group = stroke(Element::new("g"), series)
            .children(self.strokes(series))
            .children(self.markers(series));
        if series.hover { group.child(&self.hover(series)) } else { group }
    }

    fn strokes(&self, series: &Series) -> Vec<Element> {
        match series.line {
            Line::None => Vec::new(),
            Line::Stems => self.stems(series),
            Line::Solid | Line::Dashed => self.lines(series),
        }
    }

    fn lines(&self, series: &Series) -> Vec<Element> {
        let places: Vec<_> = series.points.iter().map(|p| self.place(*p)).collect();
        let runs = places
            .split(Option::is_none)
            .filter(|run| !run.is_empty())
            .map(|run| run.iter().flatten().copied().collect::<Vec<_>>());
        runs.map(|run| svg::polyline(&run)).collect()
    }

    fn stems(&self, series: &Series) -> Vec<Element> {
        let stem = |point: &(f64, f64)| {
            let (x, top) = self.place(*point)?;
            let (_, base) = self.place((point.0, self.y.base()))?;
            Some(svg::line(x, base, x, top))
        };
        series.points.iter().filter_map(stem).collect()
    }

    fn markers(&self, series: &Series) -> Vec<Element> {
        let Some(radius) = series.marker_radius_px else {
            return Vec::new();
        };
        let places = series.points.iter().filter_map(|p| self.place(*p));
        let shown = places.filter(|place| self.inside(*place));
        shown.map(|(x, y)| svg::circle(x, y, radius).set("fill", series.marker_fill())).collect()
    }

    /// Draws invisible dots that show the hover text. They are no closer together than a pointer
    /// can distinguish.
    fn hover(&self, series: &Series) -> Element {
        let mut last = f64::NEG_INFINITY;
        let mut dots = Element::new("g").set("fill", "transparent").set("stroke", "none");
        for (i, point) in series.points.iter().enumerate() {
            let Some((x, y)) = self.place(*point).filter(|place| self.inside(*place)) else {
                continue;
            };
            if (x - last).abs() < 3.0 && series.marker_radius_px.is_none() {
                continue;
            }
            last = x;
            let text =
                series.notes.get(i).cloned().unwrap_or_else(|| self.describe(series, *point));
            let title = Element::new("title").text(&text);
            dots = dots.child(&svg::circle(x, y, 4.0).child(&title));
        }
        dots
    }

    fn describe(&self, series: &Series, (x, y): (f64, f64)) -> String {
        let (x_unit, y_unit) = (self.plot.x.unit(), self.plot.y.unit());
        let value = |v: f64, unit: &str| format!("{} {unit}", brief(v)).trim_end().to_owned();
        format!("{}: {}, {}", series.name, value(x, x_unit), value(y, y_unit))
    }

    /// Returns the position of a point in the data area, in pixels from the top left corner.
    fn place(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        let across = self.x.fraction(x)? * self.area.width;
        let down = (1.0 - self.y.fraction(y)?) * self.area.height;
        Some((across, down))
    }

    fn inside(&self, (x, y): (f64, f64)) -> bool {
        (-0.5..=self.area.width + 0.5).contains(&x) && (-0.5..=self.area.height + 0.5).contains(&y)
    }
}
