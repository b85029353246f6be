//! Mixing of parameter sets: the weighted mean of each line.

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
        return Err(Error::argument(
            "filters of different model rates cannot be mixed",
        ));
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

/// Writes the weighted mean of the lines of a field. It stays between the sets, whatever rounding errors the weights have.
fn mean(
    sets: &[Values<'_>],
    weights: &[f64],
    field: usize,
    mixed: &mut [f64],
) -> Result<(), Error> {
    let (mut low, mut high) = ([f64::INFINITY; MAX_ORDER], [0.0f64; MAX_ORDER]);
    let mut lines = [0.0; MAX_ORDER];
    let lines = &mut lines[..mixed.len()];
    for (set, &weight) in sets.iter().zip(weights) {
        padded(set.list(field), field, lines)?;
        for (i, (sum, &line)) in mixed.iter_mut().zip(&*lines).enumerate() {
            *sum += weight * line;
            (low[i], high[i]) = (low[i].min(line), high[i].max(line));
        }
    }
    for (i, line) in mixed.iter_mut().enumerate() {
        *line = line.max(low[i]).min(high[i]);
    }
    Ok(())
}

/// Writes the lines of a polynomial, padded with zero coefficients to the length of `lines`.
fn padded(own: &[f64], field: usize, lines: &mut [f64]) -> Result<(), Error> {
    if own.len() == lines.len() {
        lines.copy_from_slice(own);
        return Ok(());
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
    let order = lines.len();
    let found = lines_of_reflection(&reflection[..order]);
    for (line, found) in lines.iter_mut().zip(found) {
        *line = found;
    }
    Ok(())
}
