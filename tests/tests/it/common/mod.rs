pub mod builds;
pub mod node;
pub mod playing;
pub mod scenes;

use htex_host::{Band, Fit, FitCondition, FitInput, LoadedModel};

/// Fits a model with options to a magnitude on the grid of a band, without a signal.
pub fn fit(
    model: &LoadedModel,
    band: Band,
    magnitude: &[f64],
    (signal_rate_hz, options): (f64, &[(&str, &str)]),
) -> Fit {
    let request = FitInput {
        band,
        frequency_hz: &band.grid_hz(),
        magnitude,
        signal: &[],
        signal_rate_hz,
        options: &model.options(options).unwrap(),
        condition: FitCondition::default(),
    };
    model.fit(&request).unwrap()
}
