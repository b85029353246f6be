//! Steep filters at the edges of the band, for noise that is made wider than it.

use alloc::vec::Vec;

use crate::butterworth::{high_pass, low_pass};
use crate::grid::{Band, GRID_HZ};
use crate::pipeline::Pipeline;

/// 160 dB a decade: half a bin outside the band lets through next to nothing of its power.
const ORDER: usize = 8;

/// Butterworth filters half a grid bin outside both edges of `band`, at `rate_hz`. An edge at or
/// above the Nyquist frequency needs no filter and gets none. Some samples late ([`Pipeline`]).
pub fn band_limit(band: Band, rate_hz: f64) -> Pipeline {
    let half_bin = 0.5 * GRID_HZ;
    let low = high_pass(
        ORDER,
        (band.low_hz - half_bin).max(0.5 * band.low_hz),
        rate_hz,
    );
    let high = low_pass(ORDER, band.high_hz + half_bin, rate_hz);
    let sections: Vec<_> = [low, high]
        .iter()
        .flatten()
        .flat_map(|sections| sections.iter().copied())
        .collect();
    Pipeline::new(&sections)
}
