//! Motions over time: one speed and one force for each block of samples.

use htex::Motion;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::errors::{MotionError, option};
use crate::python::zeros;

/// A speed, force or position along a path: one number for all blocks, or one for each block.
pub(crate) enum Series {
    /// The same number for all blocks.
    Constant(f64),
    /// One number for each block.
    Each(Vec<f64>),
}

impl FromPyObject<'_, '_> for Series {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        if let Ok(x) = value.extract() {
            return Ok(Self::Constant(x));
        }
        value.extract().map(Self::Each).map_err(|_| {
            let text = "expected a number, or one number for each block of samples";
            PyTypeError::new_err(text)
        })
    }
}

impl Series {
    fn len(&self) -> Option<usize> {
        match self {
            Self::Constant(_) => None,
            Self::Each(all) => Some(all.len()),
        }
    }

    /// Returns the number for a block, which must exist.
    pub(crate) fn at(&self, block: usize) -> f64 {
        match self {
            Self::Constant(x) => *x,
            Self::Each(all) => all[block],
        }
    }
}

/// Adds the position and the place of the finger to a motion, if they are known.
///
/// # Errors
/// When a place has only one coordinate.
pub(crate) fn located(
    motion: Motion,
    position_mm: Option<f64>,
    [x_mm, y_mm]: [Option<f64>; 2],
) -> PyResult<Motion> {
    let motion = match position_mm {
        Some(position) => motion.with_position_mm(position),
        None => motion,
    };
    match (x_mm, y_mm) {
        (Some(x), Some(y)) => Ok(motion.with_place_mm([x, y])),
        (None, None) => Ok(motion),
        _ => Err(option("a place is two numbers: give x_mm and y_mm, or neither")),
    }
}

/// The motions of a path, one for each block. All of them are valid.
pub(crate) struct Path {
    pub(crate) motions: Vec<Motion>,
    pub(crate) block: usize,
}

impl Path {
    /// Makes a path; each motion lasts `block` samples.
    pub(crate) fn new(
        speed_mm_s: &Series,
        force_n: &Series,
        position_mm: Option<&Series>,
        place_mm: [Option<&Series>; 2],
        block: usize,
    ) -> PyResult<Self> {
        let [x, y] = place_mm;
        let given = [Some(speed_mm_s), Some(force_n), position_mm, x, y];
        let count = count(&given, block)? / block;
        let motion = |i: usize| {
            let motion = Motion::new(speed_mm_s.at(i), force_n.at(i));
            let at = |series: Option<&Series>| series.map(|series| series.at(i));
            let motion = located(motion, at(position_mm), place_mm.map(at))?;
            let checked = motion.checked();
            checked.map_err(|error| MotionError::new_err(format!("block {i}: {error}")))
        };
        Ok(Self { motions: (0..count).map(motion).collect::<PyResult<_>>()?, block })
    }

    /// Returns a buffer for all samples of the path.
    pub(crate) fn buffer(&self) -> PyResult<Vec<f32>> {
        zeros(self.motions.len() * self.block)
    }
}

/// Returns the number of samples in a path that is given by these series.
///
/// # Errors
/// When a block has no samples, or the series differ in length.
pub(crate) fn count(given: &[Option<&Series>], block: usize) -> PyResult<usize> {
    if block == 0 {
        return Err(option("block is 0; a motion lasts at least one sample"));
    }
    let lengths = given.iter().copied().flatten().filter_map(Series::len);
    let lengths: Vec<usize> = lengths.collect();
    // Without arrays, the path is a single block.
    let blocks = lengths.first().copied().unwrap_or(1);
    if lengths.iter().any(|len| *len != blocks) {
        let text =
            format!("the arrays of the motion have {lengths:?} numbers; give one for each block");
        return Err(option(text));
    }
    let samples = blocks.checked_mul(block);
    samples.ok_or_else(|| option(format!("{blocks} blocks of {block} samples are too many")))
}
