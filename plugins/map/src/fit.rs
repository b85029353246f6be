//! A map of one row whose waves are those of a spectrum at the speed of its recording.

use alloc::vec::Vec;

use htex_dsp::uniform::Uniform;
use htex_model::{Error, Fit, FitInput, Model, Values};

use crate::lines::Lines;
use crate::map::Map;
use crate::{FORCE_N, FrictionMap, MOST_GREY, MOST_SIDE, SPEED_MM_S};

/// Assumed speed of a recording of unknown speed, mm/s.
const USUAL_SPEED_MM_S: f64 = 100.0;
/// Pixels of the shortest wave.
const FINEST: f64 = 4.0;

pub(crate) fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
    let largest = input.magnitude.iter().copied().fold(0.0, f64::max);
    if largest <= 0.0 {
        return Err(Error::cannot_fit(
            "the spectrum is silent: there is nothing to fit",
        ));
    }
    let known = input.condition.speed_mm_s.filter(|speed| *speed > 0.0);
    let speed_mm_s = known
        .unwrap_or(USUAL_SPEED_MM_S)
        .clamp(SPEED_MM_S.0, SPEED_MM_S.1);
    let force_n = input
        .condition
        .force_n
        .unwrap_or(0.0)
        .clamp(FORCE_N.0, FORCE_N.1);
    // 32 bits, as assets store it.
    let pitch_mm = f64::from((speed_mm_s / (FINEST * input.band.high_hz)) as f32);
    let heights = heights(input, speed_mm_s / (MOST_SIDE as f64 * pitch_mm));
    let most = heights
        .iter()
        .fold(0.0, |most: f64, height| most.max(height.abs()));
    if !(most > 0.0) {
        return Err(Error::cannot_fit(
            "the spectrum has nothing that 255 pixels can hold",
        ));
    }
    let grey = |height: &f64| libm::round(0.5 * MOST_GREY * (1.0 + height / most));
    let mut parameters = vec![
        MOST_SIDE as f64,
        pitch_mm,
        speed_mm_s,
        force_n,
        1.0,
        MOST_SIDE as f64,
    ];
    parameters.extend(heights.iter().map(grey));
    let rms = {
        let values = Values::read(&FrictionMap::DESCRIPTOR, &parameters)?;
        Lines::of(&Map::new(&values)?, input.band)?.rms
    };
    parameters[4] = f64::from(rms as f32);
    let power: f64 = input.magnitude.iter().map(|m| m * m).sum();
    Ok(Fit {
        parameters,
        level_rms: libm::sqrt(power / 3.0),
    })
}

/// Waves of the spectrum's magnitudes at multiples of a frequency, with phases that are the same each time.
fn heights(input: &FitInput<'_>, fundamental_hz: f64) -> Vec<f64> {
    let mut phases = Uniform::new(1);
    let mut heights = vec![0.0; MOST_SIDE];
    for waves in 1..=MOST_SIDE / 2 {
        let phase = phases.next_unit();
        let amplitude = at(input, waves as f64 * fundamental_hz);
        for (x, height) in heights.iter_mut().enumerate() {
            let turns = phase + (waves * x) as f64 / MOST_SIDE as f64;
            *height += amplitude * libm::cos(core::f64::consts::TAU * turns);
        }
    }
    heights
}

/// Magnitude at a frequency, in a straight line between bins; 0 outside of them.
fn at(input: &FitInput<'_>, frequency_hz: f64) -> f64 {
    let next = input.frequency_hz.partition_point(|f| *f < frequency_hz);
    let (Some(&g), Some(&n)) = (input.frequency_hz.get(next), input.magnitude.get(next)) else {
        return 0.0;
    };
    match next.checked_sub(1) {
        None if g == frequency_hz => n,
        None => 0.0,
        Some(before) => {
            let (f, m) = (input.frequency_hz[before], input.magnitude[before]);
            m + (n - m) * (frequency_hz - f) / (g - f)
        }
    }
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
        let magnitude: Vec<f64> = frequency_hz
            .iter()
            .map(|f| 1.0 / (1.0 + (f / 150.0).powi(2)))
            .collect();
        let options = [];
        let input = FitInput {
            frequency_hz: &frequency_hz,
            magnitude: &magnitude,
            band: Band::TACTILE,
            condition: FitCondition {
                speed_mm_s: Some(80.0),
                force_n: Some(0.4),
            },
            signal: &[],
            signal_rate_hz: 0.0,
            options: &options,
        };
        let fit = FrictionMap::fit(&input).unwrap();
        let values = Values::read(&FrictionMap::DESCRIPTOR, &fit.parameters).unwrap();
        let mut seen = vec![0.0; frequency_hz.len()];
        FrictionMap::magnitude(&values, Band::TACTILE, &frequency_hz, &mut seen).unwrap();
        // Third octaves from 100 Hz on; lines lie 16 Hz apart.
        let mut low = 100.0;
        while low < 900.0 {
            let level = |all: &[f64], scale: f64| -> f64 {
                let inside = frequency_hz
                    .iter()
                    .zip(all)
                    .filter(|(f, _)| (low..1.26 * low).contains(*f));
                10.0 * inside
                    .map(|(_, m)| scale * scale * m * m)
                    .sum::<f64>()
                    .log10()
            };
            let difference = level(&seen, fit.level_rms) - level(&magnitude, 1.0);
            assert!(difference.abs() < 2.0, "{low} Hz: {difference} dB");
            low *= 1.26;
        }
    }
}
