//! Estimation of the filter coefficients.
//!
//! The fit makes no resonance narrower than a bin, because the spectrum cannot show such a
//! resonance. Without this limit, the Yule–Walker method would find a narrower resonance for a
//! tone. A voice with such a resonance would take hours to reach its level. The voice's spectrum at
//! the bins would be wrong by tens of decibels.

use alloc::vec::Vec;

use htex_dsp::decibel_fit::DecibelFit;
use htex_dsp::estimation::{burg, covariance};
use htex_dsp::grid::{Band, GRID_HZ, level_rms};
use htex_dsp::linear_prediction::{
    LinearPrediction, coefficients_to_reflection, levinson_durbin, reflection_to_coefficients,
    scale_poles, within_radius,
};
use htex_dsp::resample::Resampler;
use htex_model::{Error, Fit, FitInput, text};

use crate::{Filter, flat};

const ORDER: usize = 0;
const RATE: usize = 1;
const METHOD: usize = 2;
/// Equivalent noise bandwidth of a bin, hertz: magnitude² = 2 · P · bandwidth.
const BIN_ENBW_HZ: f64 = 1.5 * GRID_HZ;
/// Half-power width of the narrowest resonance of a fit, hertz. Bins can neither resolve narrower
/// resonances nor measure their level.
const NARROWEST_HZ: f64 = GRID_HZ;
/// The search in decibels starts with the poles of the Yule–Walker method, multiplied by this
/// factor. The search would hardly move a pole that is nearer to the unit circle.
const START: f64 = 0.98;

pub(crate) fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
    if input.magnitude.iter().all(|&m| m == 0.0) {
        return Err(Error::cannot_fit("the spectrum is silent: there is no filter to find"));
    }
    let order = input.options[ORDER] as usize;
    // A recording whose band ends below the tactile band was sampled at twice the band's upper
    // edge.
    let rate_hz = if input.band.high_hz < Band::TACTILE.high_hz {
        input.options[RATE].min(2.0 * input.band.high_hz)
    } else {
        input.options[RATE]
    };
    match input.options[METHOD] as u32 {
        0 => from_spectrum(input, order, rate_hz),
        1 => from_signal(input, rate_hz, |signal| burg(&[signal], order)),
        2 => from_signal(input, rate_hz, |signal| covariance(&[signal], order)),
        _ => from_decibels(input, order, rate_hz),
    }
}

/// Fits the coefficients by Yule–Walker on the power spectrum. The prediction error determines the
/// level.
fn from_spectrum(input: &FitInput<'_>, order: usize, rate_hz: f64) -> Result<Fit, Error> {
    let (model, largest) = yule_walker(input, order, rate_hz);
    let coefficients = resolved(&model.coefficients, rate_hz);
    let filter = Filter { coefficients: &coefficients, rate_hz };
    let level = filter.level(input.band)?;
    if coefficients != model.coefficients {
        // The prediction error belongs to the unchanged filter, so it cannot give the level.
        return Ok(Fit {
            parameters: flat(&coefficients, rate_hz),
            level_rms: recorded_level(input),
        });
    }
    // One-sided P = 2 E |H|² / rate, magnitude² = 2 P ENBW.
    let gain = htex_dsp::root::sqrt(4.0 * model.error * BIN_ENBW_HZ / rate_hz);
    Ok(Fit { parameters: flat(&coefficients, rate_hz), level_rms: largest * gain * level })
}

/// Returns the solution of the Yule–Walker equations, and the largest bin. The solution's error is
/// relative to the largest bin, so that no power overflows or underflows.
fn yule_walker(input: &FitInput<'_>, order: usize, rate_hz: f64) -> (LinearPrediction, f64) {
    let largest = input.magnitude.iter().fold(0.0f64, |a, &m| a.max(m));
    let lags: Vec<f64> = (0..=order)
        .map(|lag| autocorrelation(input, largest, lag as f64 / rate_hz, rate_hz))
        .collect();
    (levinson_durbin(&lags, order), largest)
}

/// Fits the coefficients to levels in decibels, starting from the Yule–Walker method.
///
/// The Yule–Walker method minimises the mean ratio of the recorded to the fitted power, so it
/// follows the strongest bins. Where the spectrum is 20 dB or more below its maximum, a filter of
/// low order may be several decibels too strong, because this hardly increases the mean ratio.
///
/// The search moves the inverse hyperbolic tangents of the reflection coefficients of a filter whose
/// poles are then scaled by `radius`. So every trial is stable, and has no resonance narrower than
/// [`NARROWEST_HZ`].
fn from_decibels(input: &FitInput<'_>, order: usize, rate_hz: f64) -> Result<Fit, Error> {
    let radius = narrowest_radius(rate_hz);
    let bins = input.frequency_hz.partition_point(|&f| f <= 0.5 * rate_hz);
    let (model, largest) = yule_walker(input, order, rate_hz);
    let power: Vec<f64> =
        input.magnitude[..bins].iter().map(|m| (m / largest) * (m / largest)).collect();
    let start = scale_poles(&model.coefficients, START);
    let mut search: Vec<f64> = match coefficients_to_reflection(&start) {
        Some(reflection) => reflection.iter().map(|&k| libm::atanh(k)).collect(),
        None => vec![0.0; order],
    };
    let filter = |search: &[f64]| {
        let reflection: Vec<f64> = search.iter().map(|&x| libm::tanh(x)).collect();
        scale_poles(&reflection_to_coefficients(&reflection), radius)
    };
    let turns: Vec<(f64, f64)> = input.frequency_hz[..bins]
        .iter()
        .map(|f| core::f64::consts::TAU * f / rate_hz)
        .map(|angle| (htex_dsp::trig::sin(angle), htex_dsp::trig::cos(angle)))
        .collect();
    let levels = DecibelFit::new(input.band, &input.frequency_hz[..bins], &power);
    levels.run(&mut search, |search, power| {
        let coefficients = filter(search);
        for (power, &turn) in power.iter_mut().zip(&turns) {
            *power = power_at(&coefficients, turn);
        }
    });
    // Rounding moves poles that lie close together, so the filter is checked again.
    let coefficients = resolved(&filter(&search), rate_hz);
    Filter { coefficients: &coefficients, rate_hz }.level(input.band)?;
    Ok(Fit { parameters: flat(&coefficients, rate_hz), level_rms: recorded_level(input) })
}

/// Returns the power of the filter at a frequency, given as the sine and cosine of its angle.
fn power_at(coefficients: &[f64], (sine, cosine): (f64, f64)) -> f64 {
    // `sum A_k z^-k` by Horner's scheme.
    let (re, im) = coefficients.iter().rev().fold((0.0, 0.0), |(re, im), a| {
        let re = re + a;
        (re * cosine + im * sine, im * cosine - re * sine)
    });
    1.0 / ((1.0 - re) * (1.0 - re) + im * im)
}

/// Returns the autocorrelation at `lag_s` seconds, from the power in the bins up to the Nyquist
/// frequency.
fn autocorrelation(input: &FitInput<'_>, largest: f64, lag_s: f64, rate_hz: f64) -> f64 {
    let bins = input.frequency_hz.iter().zip(input.magnitude);
    bins.filter(|(f, _)| **f <= 0.5 * rate_hz)
        .map(|(f, m)| {
            let power = (m / largest) * (m / largest) / 3.0;
            power * htex_dsp::trig::cos(core::f64::consts::TAU * f * lag_s)
        })
        .sum()
}

/// Estimates the coefficients from the signal at the model rate. The level is the RMS of the
/// recording in the band, because overlap-adding the windowed segments changes their power.
fn from_signal(
    input: &FitInput<'_>,
    rate_hz: f64,
    estimate: impl Fn(&[f64]) -> LinearPrediction,
) -> Result<Fit, Error> {
    if input.signal.len() < 2 {
        return Err(Error::cannot_fit(
            "this method needs the recording's segments; only its spectrum was given",
        ));
    }
    let scale = input.signal.iter().fold(0.0f64, |a, x| a.max(x.abs()));
    if scale == 0.0 {
        return Err(Error::cannot_fit("the recording's segments are silent"));
    }
    let model = estimate(&resampled(input, rate_hz, scale)?);
    let coefficients = resolved(&model.coefficients, rate_hz);
    let filter = Filter { coefficients: &coefficients, rate_hz };
    filter.level(input.band)?;
    Ok(Fit { parameters: flat(&coefficients, rate_hz), level_rms: recorded_level(input) })
}

/// Returns the RMS of the recording in the band.
fn recorded_level(input: &FitInput<'_>) -> f64 {
    // The powers are relative to the largest bin, so that no power overflows or underflows.
    let largest = input.magnitude.iter().fold(0.0f64, |a, &m| a.max(m));
    let relative: Vec<f64> = input.magnitude.iter().map(|m| m / largest).collect();
    largest * level_rms(&relative)
}

/// Widens resonances that are narrower than [`NARROWEST_HZ`].
fn resolved(coefficients: &[f64], rate_hz: f64) -> Vec<f64> {
    within_radius(coefficients, narrowest_radius(rate_hz))
}

/// Returns the radius of a pole whose resonance is [`NARROWEST_HZ`] wide.
fn narrowest_radius(rate_hz: f64) -> f64 {
    libm::exp(-core::f64::consts::PI * NARROWEST_HZ / rate_hz)
}

fn unusable_rates(from_hz: f64, rate_hz: f64) -> Error {
    Error::argument(text![
        "no conversion from ",
        from_hz,
        " Hz to the model rate of ",
        rate_hz,
        " Hz: rates differ by a factor of at most 10,000",
    ])
}

/// Resamples the signal, divided by `scale`, to the model rate.
fn resampled(input: &FitInput<'_>, rate_hz: f64, scale: f64) -> Result<Vec<f64>, Error> {
    let from_hz = input.signal_rate_hz;
    let resampler = Resampler::new(from_hz, rate_hz, input.band.high_hz)
        .map_err(|_| unusable_rates(from_hz, rate_hz))?;
    let Some(mut resampler) = resampler else {
        return Ok(input.signal.iter().map(|x| x / scale).collect());
    };
    let mut at = 0;
    let mut source = |block: &mut [f32]| {
        for x in block {
            *x = input.signal.get(at).map_or(0.0, |s| (s / scale) as f32);
            at += 1;
        }
    };
    let len = (input.signal.len() as f64 * rate_hz / from_hz) as usize;
    let mut out = vec![0.0f32; len.max(2)];
    resampler.process(&mut out, &mut source);
    Ok(out.into_iter().map(f64::from).collect())
}
