//! What a take consists of, on disk and in memory.

use htex_format::Quantity;
use serde::{Deserialize, Serialize};

use crate::record::write::Format;

/// Roles of the axes of the texture's signal.
const AXES: [&str; 7] = [
    "lateral",
    "lateral_x",
    "lateral_y",
    "signal",
    "signal_x",
    "signal_y",
    "signal_z",
];

/// What a take was recorded with; the first line of a part file, and a part of the JSON beside a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TakeHeader {
    /// Version of this structure: 1.
    pub htex_take: u32,
    /// Name of the takes.
    pub name: String,
    /// Number of the take, from 1.
    pub number: u32,
    /// Program and version.
    pub tool: String,
    /// The source, as it was named.
    pub source: String,
    /// The map of channels, if one was given.
    pub map: Option<String>,
    /// Calibration matrices, row by row.
    pub calibrations: Vec<Vec<f64>>,
    /// Quantity of the texture's signal.
    pub quantity: Quantity,
    /// Sample rate, hertz.
    pub rate_hz: f64,
    /// Length of a complete take, seconds.
    pub seconds: f64,
    /// Recorded signals: role and unit.
    pub signals: Vec<(String, String)>,
    /// Means that were subtracted from the signals; empty without tare.
    pub tare: Vec<f64>,
    /// Signals of the tracker, without the time: role and unit; empty without a tracker.
    pub tracker: Vec<(String, String)>,
    /// Target speed, mm/s.
    pub target_speed_mm_s: Option<f64>,
    /// Target normal force, newtons.
    pub target_force_n: Option<f64>,
    /// Allowed relative difference from the target.
    pub tolerance: f64,
    /// Format of the recording: see [`Format`].
    pub format: Format,
}

/// A take: its header and its samples.
#[derive(Debug, Clone, PartialEq)]
pub struct TakeData {
    /// The header.
    pub header: TakeHeader,
    /// The samples of each signal, of equal lengths.
    pub signals: Vec<Vec<f64>>,
    /// Time since the beginning of the take (s), then the values of each signal of the tracker.
    pub tracker: Vec<Vec<f64>>,
}

impl TakeData {
    /// Makes a take without samples.
    #[must_use]
    pub fn empty(header: TakeHeader) -> Self {
        let signals = vec![Vec::new(); header.signals.len()];
        let tracked = match header.tracker.len() {
            0 => 0,
            signals => signals + 1,
        };
        Self {
            header,
            signals,
            tracker: vec![Vec::new(); tracked],
        }
    }

    /// Number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.signals.first().map_or(0, Vec::len)
    }

    /// Seconds that were recorded.
    #[must_use]
    pub fn recorded_s(&self) -> f64 {
        self.frames() as f64 / self.header.rate_hz
    }

    /// Whether it has all frames of its length.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.frames() >= self.header.frames()
    }

    /// Appends interleaved frames.
    pub(crate) fn extend(&mut self, frames: &[f64]) {
        spread(&mut self.signals, frames);
    }

    /// Appends interleaved rows of the tracker.
    pub(crate) fn extend_tracker(&mut self, rows: &[f64]) {
        spread(&mut self.tracker, rows);
    }
}

impl TakeHeader {
    /// Frames of a complete take.
    #[must_use]
    pub fn frames(&self) -> usize {
        (self.seconds * self.rate_hz).round() as usize
    }

    /// Index of the signal of a role.
    #[must_use]
    pub fn signal(&self, role: &str) -> Option<usize> {
        self.signals.iter().position(|(own, _)| own == role)
    }
}

/// Indices of the signals that are the axes of the texture's signal, in the order of [`AXES`]; without any, that of the normal force.
pub(crate) fn texture_axes(signals: &[(String, String)]) -> Vec<usize> {
    let position = |role: &&str| signals.iter().position(|(own, _)| own == role);
    let axes: Vec<usize> = AXES.iter().filter_map(position).collect();
    match axes.is_empty() {
        true => position(&"normal").into_iter().collect(),
        false => axes,
    }
}

fn spread(columns: &mut [Vec<f64>], rows: &[f64]) {
    let width = columns.len().max(1);
    for row in rows.chunks_exact(width) {
        for (column, value) in columns.iter_mut().zip(row) {
            column.push(*value);
        }
    }
}
