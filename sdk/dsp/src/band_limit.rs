//! Steep filters at the edges of the band, for noise that is made wider than it.

use alloc::vec::Vec;

use crate::butterworth::Kind;
use crate::chebyshev::chebyshev;
use crate::grid::{Band, GRID_HZ};
use crate::pipeline::Pipeline;

/// 80 dB a decade, and as steep at the edge as a Butterworth filter of twice the order: half a bin
/// outside the band lets through next to nothing of its power.
const ORDER: usize = 4;
const RIPPLE_DB: f64 = 0.2;

/// Chebyshev filters, within 0.1 dB inside `band` and 3 dB down half a grid bin outside both of its
/// edges, at `rate_hz`. An edge at or above the Nyquist frequency needs no filter and gets none. Some
/// samples late ([`Pipeline`]).
pub fn band_limit(band: Band, rate_hz: f64) -> Pipeline {
    let half_bin = 0.5 * GRID_HZ;
    let low_hz = (band.low_hz - half_bin).max(0.5 * band.low_hz);
    let high_hz = band.high_hz + half_bin;
    let sections: Vec<_> = [(Kind::HighPass, low_hz), (Kind::LowPass, high_hz)]
        .into_iter()
        .filter_map(|(kind, edge_hz)| chebyshev(kind, ORDER, RIPPLE_DB, edge_hz, rate_hz))
        .flatten()
        .collect();
    Pipeline::new(&sections)
}
