//! What a plot draws: named points and how they look.

use crate::color::RECORDING_COLOR;

/// How a series' points are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// Not at all: a scatter of markers.
    None,
    /// A line through the points in their order, broken where a point cannot be shown.
    Solid,
    /// The same, dashed.
    Dashed,
    /// An upright from zero to each point.
    Stems,
}

/// One set of points of a [`Plot`](crate::Plot).
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Shown in the legend and in the hover text; a series without a name is not in the legend.
    pub name: String,
    /// (x, y) in the axes' units. Points that are not finite are left out.
    pub points: Vec<(f64, f64)>,
    /// A CSS colour.
    pub color: String,
    /// How the points are joined.
    pub line: Line,
    /// Thickness of the line, pixels.
    pub line_width_px: f64,
    /// Radius of a dot on each point, pixels; no dots when absent.
    pub marker_radius_px: Option<f64>,
    /// Whether dots are rings.
    pub marker_hollow: bool,
    /// Whether pointing at a point shows its values.
    pub hover: bool,
    /// What is shown instead of its values, point by point; values where there is none.
    pub notes: Vec<String>,
}

impl Series {
    /// A solid dark grey line that answers to the pointer.
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

    /// Uprights with a dot on each.
    pub fn stems(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self {
            line: Line::Stems,
            marker_radius_px: Some(2.5),
            ..Self::line(name, points)
        }
    }

    /// Dots alone.
    pub fn scatter(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self {
            line: Line::None,
            marker_radius_px: Some(3.0),
            ..Self::line(name, points)
        }
    }

    /// This series in another CSS colour.
    #[must_use]
    pub fn colored(mut self, color: &str) -> Self {
        self.color = color.to_owned();
        self
    }

    /// What dots are filled with.
    pub(crate) fn marker_fill(&self) -> &str {
        if self.marker_hollow {
            "#fff"
        } else {
            &self.color
        }
    }

    /// This series as a backdrop: thin, and silent under the pointer.
    #[must_use]
    pub fn behind(mut self) -> Self {
        self.line_width_px = 1.0;
        self.hover = false;
        self
    }
}
