//! Checks of the magnitudes that a model returns for a list of frequencies.

use htex_host::Band;

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, Fitted};
use crate::model::checks::arrays;

/// Largest allowed difference between two results for the same frequency, relative to the largest
/// magnitude.
const TOLERANCE: f64 = 1e-9;

/// Step of the fine grid, hertz.
pub(crate) const FINE_HZ: f64 = 0.5;

/// Returns frequencies at every 0.5 Hz of the tactile band.
pub(crate) fn fine_grid() -> Vec<f64> {
    (40..=2000).map(|i| FINE_HZ * f64::from(i)).collect()
}

/// Checks that magnitudes are finite, not negative, and zero outside the band.
pub(crate) fn sane(case: &Case) -> CheckResult {
    let band = Band::TACTILE;
    let outside = [0.0, 1.0, 19.0, 1001.0, 5_000.0, 1e5];
    let mut asked = 0;
    arrays::magnitudes(case, &case.parameters()?)?;
    for Fitted { reference, parameters } in case.fitted()? {
        let say = |what: String| Finding::failed(format!("spectrum `{reference}`: {what}"));
        let mut largest: f64 = 0.0;
        for grid in [band.grid_hz(), fine_grid()] {
            // The host itself returns an error for magnitudes that are negative or not finite.
            let magnitude = case
                .model
                .magnitude(&parameters, band, &grid)
                .map_err(|error| say(error.to_string()))?;
            largest = magnitude.iter().copied().fold(largest, f64::max);
            asked += grid.len();
        }
        if largest == 0.0 {
            return Err(say("the magnitude is 0 everywhere".to_owned()));
        }
        let beyond = case
            .model
            .magnitude(&parameters, band, &outside)
            .map_err(|error| say(error.to_string()))?;
        if let Some(i) = beyond.iter().position(|&m| m != 0.0) {
            let (m, f) = (beyond[i], outside[i]);
            return Err(say(format!("{m} at {f} Hz, outside the band; it must be 0")));
        }
    }
    let message = format!("{asked} magnitudes are finite and not negative");
    Ok(Finding::passed(message).with("magnitudes", asked as f64))
}

/// Checks that a magnitude does not depend on the other frequencies in the call.
pub(crate) fn grid(case: &Case) -> CheckResult {
    let band = Band::TACTILE;
    let grid = band.grid_hz();
    let mut worst: f64 = 0.0;
    for Fitted { reference, parameters } in case.fitted()? {
        let ask = |grid: &[f64]| case.model.magnitude(&parameters, band, grid);
        let whole = ask(&grid)?;
        let largest = whole.iter().copied().fold(0.0, f64::max);
        let ways = [
            ("one by one", by_chunks(&grid, 1, ask)?),
            ("in reversed chunks of ten", by_chunks(&grid, 10, ask)?),
            // Every tenth frequency of the fine grid is one of the usual grid.
            ("within a 0.5 Hz grid", ask(&fine_grid())?.into_iter().step_by(10).collect()),
        ];
        for (way, magnitude) in ways {
            for ((m, w), f) in magnitude.iter().zip(&whole).zip(&grid) {
                let difference = (m - w).abs() / largest;
                worst = worst.max(difference);
                if difference > TOLERANCE {
                    let what = format!("{m} at {f} Hz {way}, {w} on the 5 Hz grid");
                    return Err(Finding::failed(format!("spectrum `{reference}`: {what}"))
                        .with("relative_difference", difference));
                }
            }
        }
    }
    let message = "magnitudes are equal on every grid";
    Ok(Finding::passed(message).with("relative_difference", worst))
}

/// Requests the grid in chunks, with the frequencies of each chunk in descending order. Returns the
/// magnitudes in the order of the grid.
fn by_chunks<E>(
    grid: &[f64],
    len: usize,
    ask: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
) -> Result<Vec<f64>, E> {
    let mut all = Vec::with_capacity(grid.len());
    for chunk in grid.chunks(len) {
        let reversed: Vec<f64> = chunk.iter().rev().copied().collect();
        all.extend(ask(&reversed)?.into_iter().rev());
    }
    Ok(all)
}
