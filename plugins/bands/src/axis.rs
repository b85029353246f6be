//! Where the knots stand, and the straight lines between them.

use alloc::sync::Arc;

use htex_dsp::beta::log_unit;
use htex_dsp::grid::Band;
use htex_dsp::shared::Shared;

/// Added to frequencies on the axis of [`Layout::Edges`], hertz. Below it knots are nearly as far apart in
/// hertz, above it in octaves: 30 knots over 20 to 1000 Hz stand 4.9 Hz apart at 20 Hz, where bins are
/// 5 Hz apart. Of 0 to 60 Hz the values around 20 Hz had the least third-octave error.
const CORNER_HZ: f64 = 20.0;
/// From so many bands on, knots reach the band's edges unless a layout is asked for.
const EDGES_FROM: usize = 20;

/// How knots are spread over the band.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Layout {
    /// Evenly in the logarithm of frequency, within the band: at the apexes of triangles that
    /// overlap by half and whose outermost feet are the band's edges (paper, Linear regression).
    Within,
    /// From edge to edge, evenly in `ln(f + 20 Hz)`.
    Edges,
}

impl Layout {
    /// The layout of so many bands when none is asked for.
    pub(crate) fn of(bands: usize) -> Self {
        if bands < EDGES_FROM {
            Self::Within
        } else {
            Self::Edges
        }
    }

    /// The number that stands for it among the parameters.
    pub(crate) fn number(self) -> f64 {
        match self {
            Self::Within => 0.0,
            Self::Edges => 1.0,
        }
    }

    /// The layout of a number; those of mixtures lie between.
    pub(crate) fn from_number(number: f64) -> Self {
        if number < 0.5 {
            Self::Within
        } else {
            Self::Edges
        }
    }
}

/// A frequency axis on which the knots stand at 0, 1, 2, ...
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axis {
    pub(crate) knots: usize,
    pub(crate) layout: Layout,
    pub(crate) band: Band,
}

impl Axis {
    /// Where a frequency of the band lies.
    fn place(&self, frequency_hz: f64) -> f64 {
        match self.layout {
            Layout::Within => log_unit(frequency_hz, self.band) * (self.knots + 1) as f64 - 1.0,
            Layout::Edges => {
                let raised = Band {
                    low_hz: self.band.low_hz + CORNER_HZ,
                    high_hz: self.band.high_hz + CORNER_HZ,
                };
                log_unit(frequency_hz + CORNER_HZ, raised) * (self.knots - 1) as f64
            }
        }
    }

    /// How the bins of the band see the knots. Voices of one axis share it.
    pub(crate) fn grid_points(&self) -> Arc<[Point]> {
        static POINTS: Shared<Axis, [Point]> = Shared::new();
        let points = || self.band.grid_hz().iter().map(|&f| self.point(f)).collect();
        POINTS.get(*self, points)
    }

    /// How a frequency of the band sees the knots.
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

/// A frequency on the way from `knot` to `next`, `share` of its value from the first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub(crate) knot: usize,
    pub(crate) next: usize,
    pub(crate) share: f64,
    /// Sum of the triangles' weights: below 1 beyond the outermost knots, 0 at the edges of a band
    /// whose knots stand within it.
    pub(crate) weight: f64,
}

impl Point {
    /// The value here of what is straight between knots, and level beyond the outermost.
    pub(crate) fn between(&self, knots: &[f64]) -> f64 {
        self.share * knots[self.knot] + (1.0 - self.share) * knots[self.next]
    }
}
