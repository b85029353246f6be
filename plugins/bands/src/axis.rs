//! The positions of the knots on the frequency axis, and linear interpolation between knots.

use alloc::sync::Arc;

use htex_dsp::bands::edge_to_edge;
use htex_dsp::beta::log_unit;
use htex_dsp::grid::Band;
use htex_dsp::shared::Shared;

/// From this number of bands on, the default layout is [`Layout::Edges`].
const EDGES_FROM: usize = 20;

/// Distribution of the knots over the band.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Layout {
    /// Knots inside the band, equally spaced in the logarithm of the frequency. The knots are the
    /// apexes of half-overlapping triangles. The outermost triangles end at the edges of the band
    /// (section "Linear regression" of the paper).
    Within,
    /// Knots from edge to edge of the band, equally spaced in `ln(f + 20 Hz)`.
    Edges,
}

impl Layout {
    /// Returns the default layout for this number of bands.
    pub(crate) fn for_bands(bands: usize) -> Self {
        if bands < EDGES_FROM { Self::Within } else { Self::Edges }
    }

    /// Returns the parameter value of the layout.
    pub(crate) fn number(self) -> f64 {
        match self {
            Self::Within => 0.0,
            Self::Edges => 1.0,
        }
    }

    /// Returns the layout of a parameter value. Interpolation between conditions may give a value
    /// between 0 and 1, which selects the nearer layout.
    pub(crate) fn from_number(number: f64) -> Self {
        if number < 0.5 { Self::Within } else { Self::Edges }
    }
}

/// A frequency axis on which knot `i` is at position `i`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axis {
    pub(crate) knots: usize,
    pub(crate) layout: Layout,
    pub(crate) band: Band,
}

impl Axis {
    /// Returns the position of a frequency on the axis. The frequency must be in the band.
    fn place(&self, frequency_hz: f64) -> f64 {
        match self.layout {
            Layout::Within => log_unit(frequency_hz, self.band) * (self.knots + 1) as f64 - 1.0,
            Layout::Edges => edge_to_edge(frequency_hz, self.band) * (self.knots - 1) as f64,
        }
    }

    /// Returns the interpolation weights of the band's bins. Voices with the same axis share them.
    pub(crate) fn grid_points(&self) -> Arc<[Point]> {
        static POINTS: Shared<Axis, [Point]> = Shared::new();
        let points = || self.band.grid_hz().iter().map(|&f| self.point(f)).collect();
        POINTS.get(*self, points)
    }

    /// Returns the interpolation weights of a frequency in the band.
    pub(crate) fn point(&self, frequency_hz: f64) -> Point {
        let (place, last) = (self.place(frequency_hz), (self.knots - 1) as f64);
        let inside = place.clamp(0.0, last);
        let knot = inside as usize;
        Point {
            knot,
            next: (knot + 1).min(self.knots - 1),
            share: 1.0 - (inside - knot as f64),
            weight: (1.0 + place).min(1.0 + last - place).clamp(0.0, 1.0),
        }
    }
}

/// Interpolation weights at a frequency: `share` for the knot `knot`, and `1 - share` for the knot
/// `next`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub(crate) knot: usize,
    pub(crate) next: usize,
    pub(crate) share: f64,
    /// Sum of the triangles' weights. It is below 1 outside the outermost knots. With
    /// [`Layout::Within`], it is 0 at the edges of the band.
    pub(crate) weight: f64,
}

impl Point {
    /// Returns the value of a curve at this frequency. The curve is linear between the knots, and
    /// constant outside the outermost knots.
    pub(crate) fn between(&self, knots: &[f64]) -> f64 {
        self.share * knots[self.knot] + (1.0 - self.share) * knots[self.next]
    }
}
