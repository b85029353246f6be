//! Corrects the spectra of windows for the difference between the motion in a window and the
//! crossing of its cell. The crossing is the speed and force for which the cell stands.
//!
//! In all windows of a cell, the finger covers a path of the same length ([`super::paths`]). In
//! each third-octave band, a linear fit over the windows around the crossing describes how the
//! logarithm of the energy depends on the logarithms of speed and force. The fit predicts how the
//! energy changes if speed and force change from the values of the window to those of the crossing.
//! The window's spectrum is scaled by this change. Without this correction, windows with a firm
//! touch would dominate the mean of the cell.

use htex_dsp::Band;
use htex_dsp::spectrum::Complex;

use super::cells::Cell;
use super::paths::{Paths, Window};
use crate::AuthorError;

/// Fewest windows for a regression.
const FEWEST: usize = 12;
/// A slope over an axis is determined only if the standard deviation of the axis, in the logarithm,
/// is at least this number.
const LEAST_SPREAD: f64 = 0.02;
/// Largest exponent that is used for the energy. No texture changes with a higher power of speed or
/// force.
const STEEPEST: f64 = 6.0;
/// Energy added to each band, relative to the band's mean, so that a silent band has a logarithm.
const FLOOR: f64 = 1e-9;

/// The spectrum of a window over the path of its cell, with its motion.
pub(super) struct WindowSpectrum {
    index: usize,
    motion: [f64; 2],
    spectrum: Vec<Complex<f64>>,
}

/// Reads the windows around a crossing.
pub(super) fn read_around(
    paths: &mut Paths<'_>,
    windows: &[Window],
    cell: &Cell,
) -> Result<Vec<WindowSpectrum>, AuthorError> {
    let mut around = Vec::with_capacity(cell.around.len());
    for &index in &cell.around {
        around.push(WindowSpectrum {
            index,
            motion: windows[index].motion,
            spectrum: paths.read(&windows[index], cell.at[0])?,
        });
    }
    Ok(around)
}

/// Returns the spectra of the windows `used`, corrected to the crossing of their cell. `reads`
/// holds all windows around the crossing.
pub(super) fn corrected(
    reads: &[WindowSpectrum],
    cell: &Cell,
    used: &[usize],
    band: Band,
) -> Vec<Vec<Complex<f64>>> {
    let octaves = third_octaves(band);
    let is_around = |read: &&WindowSpectrum| cell.around.binary_search(&read.index).is_ok();
    let around: Vec<&WindowSpectrum> = reads.iter().filter(is_around).collect();
    let slopes: Vec<[f64; 2]> = octaves.iter().map(|bins| slopes(&around, cell.at, bins)).collect();
    let correct = |window: &&WindowSpectrum| {
        let mut spectrum = window.spectrum.clone();
        for (bins, slope) in octaves.iter().zip(&slopes) {
            let change = [0, 1].map(|axis| slope[axis] * (window.motion[axis] - cell.at[axis]));
            // Half of the change is used, because the slopes apply to energies, but the bins are
            // amplitudes.
            let gain = libm::exp(-0.5 * (change[0] + change[1]));
            let bins = spectrum.get_mut(bins.clone());
            bins.into_iter().flatten().for_each(|bin| *bin *= gain);
        }
        spectrum
    };
    let is_used = |window: &&&WindowSpectrum| used.binary_search(&window.index).is_ok();
    around.iter().filter(is_used).map(correct).collect()
}

/// Returns the bins of each third octave from the band's lower edge; the last range holds the
/// remaining bins.
pub(super) fn third_octaves(band: Band) -> Vec<std::ops::Range<usize>> {
    let grid = band.grid_hz();
    let mut bands: Vec<std::ops::Range<usize>> = Vec::new();
    let mut start = 0;
    while let Some(from) = grid.get(start) {
        let end = start + grid[start..].partition_point(|f| *f < from * libm::cbrt(2.0));
        bands.push(start..end);
        start = end;
    }
    bands
}

/// Returns the slopes of the logarithm of a band's energy over the logarithms of speed and force.
fn slopes(windows: &[&WindowSpectrum], at: [f64; 2], bins: &std::ops::Range<usize>) -> [f64; 2] {
    if windows.len() < FEWEST {
        return [0.0; 2];
    }
    let energy = |window: &&WindowSpectrum| {
        let bins = window.spectrum.get(bins.clone()).unwrap_or_default();
        bins.iter().map(Complex::norm_sqr).sum::<f64>()
    };
    let energies: Vec<f64> = windows.iter().map(energy).collect();
    let count = energies.len() as f64;
    let floor = FLOOR * energies.iter().sum::<f64>() / count;
    if floor <= 0.0 {
        return [0.0; 2];
    }
    let logs: Vec<f64> = energies.iter().map(|e| libm::log(e + floor)).collect();
    let rows = || {
        let place = |window: &&WindowSpectrum| [0, 1].map(|axis| window.motion[axis] - at[axis]);
        windows.iter().map(place).zip(&logs)
    };
    let mean = |value: &dyn Fn([f64; 2], f64) -> f64| {
        rows().map(|(x, y)| value(x, *y)).sum::<f64>() / count
    };
    let [mx, my, ml] = [mean(&|x, _| x[0]), mean(&|x, _| x[1]), mean(&|_, y| y)];
    let xx = mean(&|x, _| (x[0] - mx) * (x[0] - mx));
    let yy = mean(&|x, _| (x[1] - my) * (x[1] - my));
    let xy = mean(&|x, _| (x[0] - mx) * (x[1] - my));
    let xl = mean(&|x, y| (x[0] - mx) * (y - ml));
    let yl = mean(&|x, y| (x[1] - my) * (y - ml));
    let least = LEAST_SPREAD * LEAST_SPREAD;
    let determinant = xx * yy - xy * xy;
    let slopes = match (xx > least, yy > least) {
        // If speed and force rise together, their slopes cannot be separated.
        (true, true) if determinant > 0.1 * xx * yy => {
            [(xl * yy - yl * xy) / determinant, (yl * xx - xl * xy) / determinant]
        }
        (true, false) => [xl / xx, 0.0],
        (false, true) => [0.0, yl / yy],
        _ => [0.0; 2],
    };
    slopes.map(|slope| slope.clamp(-STEEPEST, STEEPEST))
}
