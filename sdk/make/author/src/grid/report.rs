//! Report on a fitted grid.

use htex_play::Mesh;
use serde::Serialize;

use super::cells::Cell;
use super::paths::Window;
use super::played::motion;
use super::search::SearchResult;
use crate::TextureSpectrum;
use crate::conditions::{ConditionSpectrum, four_digits};

/// Whether a cell became a condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum CellStatus {
    /// The cell has enough windows.
    Fitted,
    /// The cell itself has too few windows. Together with the nearest windows of neighbouring
    /// cells, the cell has enough windows.
    Widened,
    /// The cell has too few windows and did not become a condition.
    Thin,
}

/// A cell of a grid, around the crossing of two lines.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct GridCell {
    /// Speed of the crossing, mm/s.
    pub speed_mm_s: f64,
    /// Normal force of the crossing, newtons.
    pub force_n: f64,
    /// Number of steady windows inside the cell.
    pub segments: usize,
    /// Number of windows that were averaged, including windows from neighbouring cells; 0 for a
    /// cell with too few windows.
    pub averaged: usize,
    /// Repeatability of the cell's spectrum, decibels. It is computed from the spectra of the odd
    /// and of the even blocks of the windows: the RMS of their difference over nine bands, divided
    /// by √2.
    pub repeatability_rms_db: Option<f64>,
    pub status: CellStatus,
    /// Index of the cell's condition in the asset; `None` for a cell with too few windows.
    pub condition: Option<usize>,
}

/// The grid of conditions that was made from recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct GridReport {
    /// Speeds of the lines, mm/s.
    pub speed_mm_s: Vec<f64>,
    /// Normal forces of the lines, newtons.
    pub force_n: Vec<f64>,
    /// Number of windows of 0.2 s in the recordings. Each window overlaps the next window by half.
    pub windows: usize,
    /// Number of steady windows.
    pub steady: usize,
    /// Held-out error, decibels. To measure this error, blocks of time are left out. A player
    /// predicts the spectra of these blocks by interpolating between the recorded spectra of the
    /// other blocks. The error is the RMS difference in third octaves. `None` if the blocks have
    /// too few windows.
    pub left_out_rms_db: Option<f64>,
    /// The held-out error of an asset with a single condition, decibels. This condition is the mean
    /// of all steady windows. The law scales this mean to each motion. If a grid is useful, its
    /// held-out error is smaller than this error.
    pub one_condition_rms_db: Option<f64>,
    /// The cells, ordered by speed and then by force.
    pub cells: Vec<GridCell>,
    /// Triangles in which players interpolate, each with the indices of three conditions.
    pub triangles: Vec<[usize; 3]>,
    /// Mean speed (mm/s) and mean force (newtons) of each steady window.
    #[serde(skip)]
    pub motions: Vec<[f64; 2]>,
}

impl GridReport {
    pub(super) fn new(looked_at: usize, windows: &[Window], found: &SearchResult) -> Self {
        let lines = &found.gathered.lines;
        let natural = |axis: usize| {
            let values = lines.axes[axis].iter();
            values.map(|log| four_digits(libm::exp(*log))).collect()
        };
        Self {
            speed_mm_s: natural(0),
            force_n: natural(1),
            windows: looked_at,
            steady: windows.len(),
            left_out_rms_db: found.left_out_rms_db,
            one_condition_rms_db: found.one_condition_rms_db,
            cells: Vec::new(),
            triangles: Vec::new(),
            motions: windows.iter().map(|w| w.motion.map(libm::exp)).collect(),
        }
    }

    pub(super) fn add_thin(&mut self, cell: &Cell) {
        self.cells.push(grid_cell(cell, CellStatus::Thin));
    }

    pub(super) fn add_fitted(&mut self, cell: &Cell, spectrum: &TextureSpectrum, condition: usize) {
        let status =
            if cell.borrowed.is_empty() { CellStatus::Fitted } else { CellStatus::Widened };
        self.cells.push(GridCell {
            averaged: spectrum.segments,
            repeatability_rms_db: spectrum.repeatability_rms_db(),
            condition: Some(condition),
            ..grid_cell(cell, status)
        });
    }

    pub(super) fn add_mesh(&mut self, all: &[ConditionSpectrum]) {
        let points: Vec<[f64; 2]> = all.iter().map(|one| motion(&one.condition)).collect();
        self.triangles = Mesh::new(&points).triangles().collect();
    }

    /// Returns the cell of a crossing, given the indices of its two lines.
    #[must_use]
    pub fn cell(&self, speed: usize, force: usize) -> Option<&GridCell> {
        let inside = force < self.force_n.len();
        self.cells.get(speed * self.force_n.len() + force).filter(|_| inside)
    }

    /// Describes the ranges of speed and force over the steady windows.
    pub(super) fn motion_text(&self) -> String {
        let range = |axis: usize| {
            let values = self.motions.iter().map(|motion| motion[axis]);
            values.fold([f64::INFINITY, 0.0], |[low, high], x| [x.min(low), x.max(high)])
        };
        let ([slow, fast], [light, firm]) = (range(0), range(1));
        format!("{slow:.4} to {fast:.4} mm/s and {light:.4} to {firm:.4} N")
    }
}

fn grid_cell(cell: &Cell, status: CellStatus) -> GridCell {
    let [speed_mm_s, force_n] = cell.at.map(|log| four_digits(libm::exp(log)));
    GridCell {
        speed_mm_s,
        force_n,
        segments: cell.own.len(),
        averaged: 0,
        repeatability_rms_db: None,
        status,
        condition: None,
    }
}
