//! Interpolates parameter sets: computes the weighted mean of each line spectral frequency.

use htex_dsp::line_spectrum::{coefficients_of_lines, lines_of_reflection, zeros_of_lines};
use htex_dsp::linear_prediction::step_down_in_place;
use htex_model::{Error, Numbers, Values, mix};

use crate::{MAX_ORDER, MODEL_RATE, POLE_LINES, ZERO_LINES};

pub(crate) fn mix(
    sets: &[Values<'_>],
    weights: &[f64],
    out: &mut Numbers<'_>,
) -> Result<(), Error> {
    if let Some(set) = mix::sole(sets, weights) {
        out.extend(set.flat());
        return Ok(());
    }
    let rate_hz = sets.first().map_or(f64::NAN, |set| set.scalar(MODEL_RATE));
    if sets.iter().any(|set| set.scalar(MODEL_RATE) != rate_hz) {
        return Err(Error::argument("filters of different model rates cannot be mixed"));
    }
    for field in [POLE_LINES, ZERO_LINES] {
        let order = sets.iter().map(|set| set.list(field).len()).max();
        let mut mixed = [0.0; MAX_ORDER];
        let mixed = &mut mixed[..order.unwrap_or(0).min(MAX_ORDER)];
        mean(sets, weights, field, mixed)?;
        out.push(mixed.len() as f64);
        out.extend(mixed);
    }
    out.push(rate_hz);
    Ok(())
}

/// Writes the weighted means of the lines in a field. Each mean is limited to the range of the
/// sets' values, because the weights can have rounding errors.
fn mean(
    sets: &[Values<'_>],
    weights: &[f64],
    field: usize,
    mixed: &mut [f64],
) -> Result<(), Error> {
    let (mut low, mut high) = ([f64::INFINITY; MAX_ORDER], [0.0f64; MAX_ORDER]);
    let mut room = [0.0; MAX_ORDER];
    for (set, &weight) in sets.iter().zip(weights) {
        let lines = padded(set.list(field), field, &mut room[..mixed.len()])?;
        let ends = low.iter_mut().zip(&mut high);
        for ((sum, (low, high)), &line) in mixed.iter_mut().zip(ends).zip(lines) {
            *sum += weight * line;
            *low = if line < *low { line } else { *low };
            *high = if line > *high { line } else { *high };
        }
    }
    for (line, (low, high)) in mixed.iter_mut().zip(low.iter().zip(&high)) {
        *line = line.max(*low).min(*high);
    }
    Ok(())
}

/// Pads a polynomial with zero coefficients to the length of `room`, and returns its lines.
fn padded<'a>(own: &'a [f64], field: usize, room: &'a mut [f64]) -> Result<&'a [f64], Error> {
    if own.len() == room.len() {
        return Ok(own);
    }
    let convert = match field {
        POLE_LINES => coefficients_of_lines,
        _ => zeros_of_lines,
    };
    let mut reflection = [0.0; MAX_ORDER];
    let is_inside = convert(own, &mut reflection[..own.len()])
        && step_down_in_place(&mut reflection[..own.len()]);
    if !is_inside {
        return Err(Error::parameters(
            "a filter with a pole or zero on the unit circle cannot be mixed with one of another order",
        ));
    }
    let found = lines_of_reflection(&reflection[..room.len()]);
    for (line, found) in room.iter_mut().zip(found) {
        *line = found;
    }
    Ok(room)
}
