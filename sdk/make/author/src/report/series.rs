//! Series of a plot: points with a name and a style.

use crate::report::color::RECORDING_COLOR;

/// How a series' points are connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// Points are not connected; only their markers are drawn.
    None,
    /// A line through the points in order, interrupted at points that cannot be shown.
    Solid,
    Dashed,
    /// A vertical line from zero to each point.
    Stems,
}

/// A series of points in a [`Plot`](crate::report::Plot).
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend and in the hover text. A series without a name is not in the legend.
    pub name: String,
    /// Points (x, y) in the axes' units. Points that are not finite are not drawn.
    pub points: Vec<(f64, f64)>,
    /// A CSS colour.
    pub color: String,
    /// How the points are connected.
    pub line: Line,
    /// Thickness of the line, pixels.
    pub line_width_px: f64,
    /// Radius of a dot on each point, pixels; `None` for no dots.
    pub marker_radius_px: Option<f64>,
    /// Whether the dots are hollow.
    pub marker_hollow: bool,
    /// Whether hovering over a point shows its values.
    pub hover: bool,
    /// Hover texts, one for each point. A point shows its hover text instead of its values. A point
    /// without a text shows its values.
    pub notes: Vec<String>,
}

impl Series {
    /// Creates a solid dark grey line with hover text.
    pub fn line(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.to_owned(),
            points,
            color: RECORDING_COLOR.to_owned(),
            line: Line::Solid,
            line_width_px: 1.5,
            marker_radius_px: None,
            marker_hollow: false,
            hover: true,
            notes: Vec::new(),
        }
    }

    /// Creates stems (a vertical line from zero to each point) with a dot at each point.
    pub fn stems(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self { line: Line::Stems, marker_radius_px: Some(2.5), ..Self::line(name, points) }
    }

    /// Creates dots that are not connected.
    pub fn scatter(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self { line: Line::None, marker_radius_px: Some(3.0), ..Self::line(name, points) }
    }

    #[must_use]
    pub fn colored(mut self, color: &str) -> Self {
        self.color = color.to_owned();
        self
    }

    /// Returns the fill colour of dots.
    pub(crate) fn marker_fill(&self) -> &str {
        if self.marker_hollow { "#fff" } else { &self.color }
    }

    /// Turns the series into a backdrop: thin, and without hover text.
    #[must_use]
    pub fn behind(mut self) -> Self {
        self.line_width_px = 1.0;
        self.hover = false;
        self
    }
}
