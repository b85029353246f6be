//! Reads a finger's stroke, its speed and force over time, from a CSV file.

use std::path::Path;

use htex_author::recording::{ReadError, read_stroke, stroke_from_bytes};
use htex_play::Motion;

use crate::curve::{Point, value_at};

/// A stroke of a finger: its speed and force over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    speed_mm_s: Vec<Point>,
    force_n: Vec<Point>,
    /// Distance along the path over time, mm.
    way_mm: Vec<Point>,
    /// Assumptions that the reader made, as a list of sentences.
    pub warnings: Vec<String>,
}

impl Stroke {
    /// Reads a CSV file with time, speed and force (`t_s`, `speed_mm_s`, `force_n`), or a trace
    /// with time, position and force.
    ///
    /// # Errors
    /// Returns the same errors as [`htex_author::recording::read_trace`]. However, positions may be
    /// missing if the file has a speed.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Ok(Self::new(read_stroke(path)?))
    }

    /// Does the same as [`Self::open`], for a file in memory. `file` is the file's name in
    /// messages.
    ///
    /// # Errors
    /// Returns the errors of [`Self::open`].
    pub fn from_bytes(file: &str, bytes: &[u8]) -> Result<Self, ReadError> {
        Ok(Self::new(stroke_from_bytes(file, bytes)?))
    }

    fn new(read: htex_author::recording::StrokeColumns) -> Self {
        let start_s = read.t_s.first().copied().unwrap_or(0.0);
        let curve = |values: &[f64]| -> Vec<Point> {
            let points = read.t_s.iter().zip(values);
            // A trace may begin at any time. A stroke begins at 0.
            points.map(|(t, value)| Point::new(t - start_s, *value)).collect()
        };
        let speed_mm_s = curve(&read.speed_mm_s);
        let mut way_mm = Vec::with_capacity(speed_mm_s.len());
        let mut way = 0.0;
        let mut before: Option<&Point> = None;
        for point in &speed_mm_s {
            if let Some(before) = before {
                // This sum is exact, because the speed is linear between points.
                way += 0.5 * (before.value + point.value) * (point.time_s - before.time_s);
            }
            way_mm.push(Point::new(point.time_s, way));
            before = Some(point);
        }
        let force_n: Vec<f64> = read.force_n.iter().map(|force| force.max(0.0)).collect();
        Self { force_n: curve(&force_n), way_mm, speed_mm_s, warnings: read.warnings.clone() }
    }

    /// Returns the length of the stroke, seconds.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.speed_mm_s.last().map_or(0.0, |last| last.time_s)
    }

    /// Returns the motion at a time, seconds.
    #[must_use]
    pub(crate) fn motion_at(&self, time_s: f64) -> Motion {
        let at = |curve: &[Point]| value_at(curve, time_s).unwrap_or(0.0);
        Motion::new(at(&self.speed_mm_s), at(&self.force_n)).with_position_mm(at(&self.way_mm))
    }
}
