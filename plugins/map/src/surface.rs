//! A map in the form that a voice renders, with interpolation of the friction between pixels.

use alloc::vec::Vec;

use htex_model::Error;

use crate::MOST_SIDE;
use crate::map::{Map, cubic};

/// Grey values of a map, and the scale that gives them unit RMS.
#[derive(PartialEq)]
pub(crate) struct Surface {
    grey: Vec<u8>,
    pub(crate) width: usize,
    pub(crate) pitch_mm: f64,
    pub(crate) speed_mm_s: f64,
    pub(crate) force_n: f64,
    mean: f64,
    /// Factor that converts a grey value to a sample.
    scale: f64,
}

impl Surface {
    /// Makes a surface with memory for the largest map.
    pub(crate) fn empty() -> Self {
        Self {
            grey: Vec::with_capacity(MOST_SIDE * MOST_SIDE),
            width: 1,
            pitch_mm: 1.0,
            speed_mm_s: 0.0,
            force_n: 0.0,
            mean: 0.0,
            scale: 0.0,
        }
    }

    /// Replaces the surface with a map. `passed` is the part of the map's RMS that the filters
    /// pass. Does not allocate.
    ///
    /// # Errors
    /// Returns an error if the stated RMS of the map is 0.
    pub(crate) fn set_map(&mut self, map: &Map<'_>, passed: f64) -> Result<(), Error> {
        if map.rms <= 0.0 {
            return Err(Error::parameters("`rms` is 0, and a map is felt by its differences"));
        }
        // `empty` has reserved memory for the largest map, so this does not allocate on the render
        // thread.
        self.grey.clear();
        self.grey.extend(map.grey.iter().map(|grey| libm::round(*grey) as u8));
        self.width = map.width;
        self.pitch_mm = map.pitch_mm;
        self.speed_mm_s = map.speed_mm_s;
        self.force_n = map.force_n;
        self.mean = map.grey.iter().sum::<f64>() / map.grey.len() as f64;
        self.scale = 1.0 / (map.rms * passed);
        Ok(())
    }

    /// Returns the friction at a place, without the map's mean. The place is in pixels.
    pub(crate) fn friction_at(&self, x: f64, y: f64) -> f64 {
        let rows = self.grey.len() / self.width;
        let (x, columns) = around(x, self.width);
        let (y, lines) = around(y, rows);
        let (along, across) = (cubic(x), cubic(y));
        let mut sum = 0.0;
        for (row, weight) in lines.iter().zip(across) {
            let row = &self.grey[row * self.width..][..self.width];
            let mut own = 0.0;
            for (column, part) in columns.iter().zip(along) {
                own += part * f64::from(row[*column]);
            }
            sum += weight * own;
        }
        self.scale * (sum - self.mean)
    }
}

/// Finds a position in a row or column of `count` pixels, which repeats. Returns the position's
/// distance from the pixel before it, from 0 to 1, and the four surrounding pixels.
fn around(at: f64, count: usize) -> (f64, [usize; 4]) {
    let whole = libm::floor(at);
    let count = count as f64;
    // The operator `%` would give a negative remainder for places left of the map or above it.
    let first = whole - 1.0 - count * libm::floor((whole - 1.0) / count);
    let pixel = |i: usize| {
        let next = first + i as f64;
        (next - count * libm::floor(next / count)) as usize
    };
    (at - whole, core::array::from_fn(pixel))
}
