//! Fits a map that has a single row. If this row is played at the speed of the recording, its waves
//! have the recording's spectrum.

use alloc::vec::Vec;

use htex_dsp::grid::level_rms;
use htex_dsp::uniform::Uniform;
use htex_model::{Error, Fit, FitInput};

use crate::{FORCE_N, MOST_GREY, MOST_SIDE, SPEED_MM_S};

/// Assumed speed of a recording of unknown speed, mm/s.
const USUAL_SPEED_MM_S: f64 = 100.0;
/// Number of pixels in the shortest wave.
const FINEST: f64 = 4.0;

pub(crate) fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
    let largest = input.magnitude.iter().copied().fold(0.0, f64::max);
    if largest <= 0.0 {
        return Err(Error::cannot_fit("the spectrum is silent: there is nothing to fit"));
    }
    let known = input.condition.speed_mm_s.filter(|speed| *speed > 0.0);
    // The speed is rounded to 32 bits, as in an asset, because a line may be exactly on an edge of
    // the band.
    let speed_mm_s = known.unwrap_or(USUAL_SPEED_MM_S).clamp(SPEED_MM_S.0, SPEED_MM_S.1);
    let speed_mm_s = f64::from(speed_mm_s as f32);
    let force_n = input.condition.force_n.unwrap_or(0.0).clamp(FORCE_N.0, FORCE_N.1);
    let pitch_mm = f64::from((speed_mm_s / (FINEST * input.band.high_hz)) as f32);
    let heights = heights(input, largest, speed_mm_s / (MOST_SIDE as f64 * pitch_mm));
    let most = heights.iter().fold(0.0, |most: f64, height| most.max(height.abs()));
    if most <= 0.0 {
        return Err(Error::cannot_fit("the spectrum has nothing that 255 pixels can hold"));
    }
    let grey = |height: &f64| libm::round(0.5 * MOST_GREY * (1.0 + height / most));
    let grey: Vec<f64> = heights.iter().map(grey).collect();
    let rms = crate::rms(MOST_SIDE, pitch_mm, speed_mm_s, &grey, input.band)?;
    let mut parameters = vec![
        MOST_SIDE as f64,
        pitch_mm,
        speed_mm_s,
        force_n,
        f64::from(rms as f32),
        MOST_SIDE as f64,
    ];
    parameters.extend(grey);
    Ok(Fit { parameters, level_rms: level_rms(input.magnitude) })
}

/// Returns the heights of a row with waves in the band. Each wave gets the power of the bins
/// nearest to it. The phases are random, but the same in every fit.
fn heights(input: &FitInput<'_>, largest: f64, fundamental_hz: f64) -> Vec<f64> {
    let mut phases = Uniform::new(1);
    let mut heights = vec![0.0; MOST_SIDE];
    for (waves, power) in powers(input, largest, fundamental_hz).iter().enumerate() {
        let phase = phases.next_unit();
        let amplitude = libm::sqrt(*power);
        for (x, height) in heights.iter_mut().enumerate() {
            let turns = phase + (waves * x) as f64 / MOST_SIDE as f64;
            *height += amplitude * libm::cos(core::f64::consts::TAU * turns);
        }
    }
    heights
}

/// Returns the powers of the waves with 0, 1, … periods in the row, relative to the square of the
/// largest magnitude. Each bin is assigned to the nearest wave in the band.
fn powers(input: &FitInput<'_>, largest: f64, fundamental_hz: f64) -> Vec<f64> {
    let first = libm::ceil(input.band.low_hz / fundamental_hz).max(1.0);
    let last = libm::floor(input.band.high_hz / fundamental_hz).min((MOST_SIDE / 2) as f64);
    let mut powers = vec![0.0; MOST_SIDE / 2 + 1];
    for (frequency_hz, magnitude) in input.frequency_hz.iter().zip(input.magnitude) {
        let nearest = libm::round(frequency_hz / fundamental_hz);
        let waves = nearest.min(last).max(first) as usize;
        if let Some(power) = powers.get_mut(waves) {
            *power += (magnitude / largest) * (magnitude / largest);
        }
    }
    powers
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::disallowed_methods)] // A failed unwrap is a failed test.
    use alloc::vec::Vec;

    use htex_dsp::grid::Band;
    use htex_model::{FitCondition, FitInput, Model, Values};

    use crate::FrictionMap;

    #[test]
    fn a_fitted_map_has_the_spectrum() {
        let frequency_hz = Band::TACTILE.grid_hz();
        let magnitude: Vec<f64> =
            frequency_hz.iter().map(|f| 1.0 / (1.0 + (f / 150.0).powi(2))).collect();
        let options = [];
        let input = FitInput {
            frequency_hz: &frequency_hz,
            magnitude: &magnitude,
            band: Band::TACTILE,
            condition: FitCondition { speed_mm_s: Some(80.0), force_n: Some(0.4) },
            signal: &[],
            signal_rate_hz: 0.0,
            options: &options,
        };
        let fit = FrictionMap::fit(&input).unwrap();
        let values = Values::read(&FrictionMap::DESCRIPTOR, &fit.parameters).unwrap();
        let mut seen = vec![0.0; frequency_hz.len()];
        FrictionMap::magnitude(&values, Band::TACTILE, &frequency_hz, &mut seen).unwrap();
        // Third octaves from 100 Hz on; the lines are 16 Hz apart.
        let mut low = 100.0;
        while low < 900.0 {
            let level = |all: &[f64], scale: f64| -> f64 {
                let inside =
                    frequency_hz.iter().zip(all).filter(|(f, _)| (low..1.26 * low).contains(*f));
                10.0 * inside.map(|(_, m)| scale * scale * m * m).sum::<f64>().log10()
            };
            let difference = level(&seen, fit.level_rms) - level(&magnitude, 1.0);
            assert!(difference.abs() < 2.0, "{low} Hz: {difference} dB");
            low *= 1.26;
        }
    }
}
