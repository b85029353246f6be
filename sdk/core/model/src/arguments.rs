//! Checks of the arguments and results of models. The exported C functions make these checks. A
//! host makes the same checks if it calls a model directly, without C functions.

use alloc::vec::Vec;

use crate::abi::{MAX_BAND_HZ, MAX_RATE_HZ, MIN_BINS, MIN_RATE_HZ};
use crate::voices_1::MAX_VOICES;
use crate::{Band, Error, Fields, Fit, FitInput, Numbers, Status, Values, text};

/// Largest number of sets that [`interpolate`] mixes without allocating.
const FEW_SETS: usize = 8;

/// Checks the handles of voices that are rendered in one call: at most [`MAX_VOICES`], all
/// different.
pub(crate) fn check_handles(handles: &[i64]) -> Result<(), Error> {
    if handles.len() > MAX_VOICES {
        let count = handles.len();
        return Err(Error::argument(text![
            count,
            " voices in one call; at most ",
            MAX_VOICES,
            " are allowed",
        ]));
    }
    let again = |(i, handle)| handles[..i].contains(handle);
    match handles.iter().enumerate().find(|pair| again(*pair)) {
        None => Ok(()),
        Some((i, _)) => Err(Error::argument(text!["`voices`[", i, "] occurs twice",])),
    }
}

/// Makes a band from its two edges, hertz.
///
/// # Errors
/// Returns an error if the lower edge is not above 0 Hz, the upper edge is not above the lower
/// edge, or the upper edge is above 1 MHz.
pub fn band((low_hz, high_hz): (f64, f64)) -> Result<Band, Error> {
    if low_hz > 0.0 && low_hz < high_hz && high_hz <= MAX_BAND_HZ {
        return Ok(Band { low_hz, high_hz });
    }
    Err(Error::argument(text![
        "band ",
        low_hz,
        " to ",
        high_hz,
        " Hz: 0 < low < high <= 1 MHz is allowed",
    ]))
}

/// Checks the sample rate of a signal or a voice, hertz.
///
/// # Errors
/// Returns an error if the rate is not from 1 Hz to 10 MHz.
pub fn check_rate(rate_hz: f64) -> Result<(), Error> {
    if (MIN_RATE_HZ..=MAX_RATE_HZ).contains(&rate_hz) {
        return Ok(());
    }
    Err(Error::argument(text!["rate ", rate_hz, " Hz: 1 Hz to 10 MHz is allowed",]))
}

/// Checks that all numbers of an argument are finite.
///
/// # Errors
/// Returns an error if a number is not finite. The message names the argument and the index of the
/// first such number.
pub fn finite(name: &str, numbers: &[f64]) -> Result<(), Error> {
    match numbers.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(i) => Err(Error::argument(text!["`", name, "`[", i, "] is not a finite number",])),
    }
}

/// Checks the input of a fit against the model's descriptor.
///
/// # Errors
/// Returns an error if a number is not finite, the spectrum is too short, its frequencies do not
/// ascend, a magnitude is negative, the sample rate is invalid, or an option is missing or out of
/// range.
pub fn check_fit_input(input: &FitInput<'_>, descriptor: &dyn Fields) -> Result<(), Error> {
    check_recording(input)?;
    check_options(input.options, descriptor)
}

/// Checks the result of a model's fit.
///
/// # Errors
/// Returns an error if a parameter is out of range, or the level is not a valid number.
pub fn check_fit(fit: &Fit, descriptor: &dyn Fields) -> Result<(), Error> {
    Values::read(descriptor, &fit.parameters)?;
    if fit.level_rms.is_finite() && fit.level_rms >= 0.0 {
        Ok(())
    } else {
        Err(Error::cannot_fit("the fitted level is not a number"))
    }
}

/// Checks the spectrum and the signal of a fit's input.
fn check_recording(input: &FitInput<'_>) -> Result<(), Error> {
    finite("frequency_hz", input.frequency_hz)?;
    finite("magnitude", input.magnitude)?;
    finite("signal", input.signal)?;
    let bins = input.frequency_hz.len();
    if bins < MIN_BINS || input.magnitude.len() != bins {
        return Err(Error::argument("a spectrum needs three bins or more"));
    }
    if !input.frequency_hz.is_sorted_by(|a, b| a < b) {
        return Err(Error::argument("`frequency_hz` does not ascend"));
    }
    if input.magnitude.iter().any(|&m| m < 0.0) {
        return Err(Error::argument("`magnitude` contains a negative number"));
    }
    if !input.signal.is_empty() {
        check_rate(input.signal_rate_hz)?;
    }
    Ok(())
}

fn check_options(values: &[f64], descriptor: &dyn Fields) -> Result<(), Error> {
    let invalid = |message| Err(Error::new(Status::InvalidOption, message));
    if values.len() != descriptor.option_count() {
        let (want, got) = (descriptor.option_count(), values.len());
        return invalid(text![got, " option values; ", want, " are required"]);
    }
    for (i, &value) in values.iter().enumerate() {
        let (option, integer) = descriptor.option(i);
        // Without `std`, `fract` does not exist.
        let whole = !integer || value as i64 as f64 == value;
        if !(option.min..=option.max).contains(&value) || !whole {
            let kind = if integer { "whole numbers " } else { "" };
            return invalid(text![
                "option `",
                option.name,
                "` is ",
                value,
                "; ",
                kind,
                option.min,
                " to ",
                option.max,
                " ",
                option.unit,
                " is allowed",
            ]);
        }
    }
    Ok(())
}

fn check_weights(weights: &[f64]) -> Result<(), Error> {
    let sum: f64 = weights.iter().sum();
    let sane = weights.iter().all(|w| (0.0..=1.0).contains(w)) && (sum - 1.0).abs() < 1e-6;
    if sane {
        return Ok(());
    }
    Err(Error::argument("weights must lie in 0 to 1 and sum to 1"))
}

/// A model's function that interpolates parameter sets.
type Interpolation<'a> = dyn Fn(&[Values<'_>], &[f64], &mut Numbers<'_>) -> Result<(), Error> + 'a;

/// Interpolates concatenated parameter sets with a model's function, and checks the result. Returns
/// the length of the result.
///
/// # Errors
/// Returns an error if weights or sets are invalid, if the model returns an error, or if its result
/// is invalid.
pub fn interpolate(
    descriptor: &dyn Fields,
    own: &Interpolation<'_>,
    flat: &[f64],
    weights: &[f64],
    parameters: &mut [f64],
) -> Result<i64, Error> {
    check_weights(weights)?;
    // Hosts interpolate two or three sets, and may do this on the render thread. Therefore, few
    // sets need no allocation.
    let (mut few, mut many) = ([Values::NONE; FEW_SETS], Vec::new());
    let sets = match few.get_mut(..weights.len()) {
        Some(few) => few,
        None => {
            // Each set has at least one number, so the length of the caller's array limits the
            // memory.
            many.resize(weights.len().min(flat.len()), Values::NONE);
            &mut many[..]
        }
    };
    read_sets(descriptor, flat, sets)?;
    let mut mixed = Numbers::new(parameters);
    own(sets, weights, &mut mixed)?;
    // If the buffer was too small, the caller calls again, and the complete result is checked in
    // that call.
    if mixed.count() == mixed.written().len() {
        Values::read(descriptor, mixed.written())?;
    }
    Ok(mixed.count() as i64)
}

fn read_sets<'a>(
    descriptor: &dyn Fields,
    mut flat: &'a [f64],
    sets: &mut [Values<'a>],
) -> Result<(), Error> {
    for set in sets {
        let used;
        (*set, used) = Values::read_first(descriptor, flat)?;
        flat = &flat[used..];
    }
    if !flat.is_empty() {
        return Err(Error::argument("numbers follow the last parameter set"));
    }
    Ok(())
}
