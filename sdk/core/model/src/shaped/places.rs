//! Linear interpolation of a curve from the grid of a band to the frequencies of a voice.

use alloc::sync::Arc;
use alloc::vec::Vec;

use htex_dsp::grid::{Band, GRID_HZ};
use htex_dsp::shaped_noise::ComponentsKey;
use htex_dsp::shared::Shared;

/// A table that states where each of a voice's frequencies lies between two bins of a band's grid.
/// Voices with the same rate and band share one table.
pub struct Places(Vec<BinPosition>);

/// Position between two neighbouring bins: the lower bin, and the distance from it as a fraction of
/// a bin.
struct BinPosition {
    below: u32,
    part: f64,
}

impl Places {
    /// Returns the positions of these frequencies, hertz. `key` identifies the list of frequencies:
    /// calls with the same key return the same table.
    pub fn shared(frequency_hz: &[f64], key: ComponentsKey, band: Band) -> Arc<Self> {
        static PLACES: Shared<ComponentsKey, Places> = Shared::new();
        PLACES.get(key, || Arc::new(Self::new(frequency_hz, band)))
    }

    fn new(frequency_hz: &[f64], band: Band) -> Self {
        let first = band.first_bin() as f64;
        let last = band.bins().saturating_sub(1) as f64;
        let place = |hz: &f64| {
            // An edge of the band need not be on the grid, so a frequency may lie beyond the
            // outermost bins.
            let place = (hz / GRID_HZ - first).clamp(0.0, last);
            BinPosition { below: place as u32, part: place - f64::from(place as u32) }
        };
        Self(frequency_hz.iter().map(place).collect())
    }

    /// Interpolates a curve that is given on the grid, and writes its value at each frequency.
    pub fn read(&self, grid: &[f64], values: &mut [f64]) {
        let last = grid.len().saturating_sub(1);
        for (value, place) in values.iter_mut().zip(&self.0) {
            let below = (place.below as usize).min(last);
            let (a, b) = (grid[below], grid[(below + 1).min(last)]);
            *value = a + place.part * (b - a);
        }
    }
}
