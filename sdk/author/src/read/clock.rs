//! The sample rate of a table: from its time column, or from the user.

use super::ReadError;
use super::table::Table;
use crate::recording::check_rate;

/// Steps this much longer than the median are gaps, and say nothing of the rate.
const GAP: f64 = 1.5;
/// Unevenness of the steps (rms over median) from which on a warning is due.
const JITTER: f64 = 0.01;
/// Difference between column and option from which on a warning is due.
const DISAGREE: f64 = 1e-3;
/// Within this of a whole number of hertz, the whole number is meant: times are printed rounded.
const WHOLE: f64 = 1e-5;

/// The rate in hertz; `given` wins over the time column `time_s`.
pub(crate) fn rate(
    table: &Table<'_>,
    time_s: Option<&[f64]>,
    given: Option<f64>,
    warnings: &mut Vec<String>,
) -> Result<f64, ReadError> {
    let measured = match (time_s, given) {
        (None, None) => {
            return Err(ReadError::NoRate {
                file: table.file.to_owned(),
            });
        }
        (None, Some(given)) => return Ok(given),
        (Some(time_s), _) => measure(table, time_s, warnings),
    };
    match (measured, given) {
        (measured, None) => measured,
        (Ok(measured), Some(given)) => {
            if (measured / given - 1.0).abs() > DISAGREE {
                warnings.push(format!(
                    "The time column runs at {measured:.6} Hz, --rate says {given} Hz: --rate is used."
                ));
            }
            Ok(given)
        }
        (Err(error), Some(given)) => {
            warnings.push(format!("The time column is not used, --rate is: {error}."));
            Ok(given)
        }
    }
}

/// One over the mean of the steps that are no gaps: like their median where the clock is even, and
/// right too where rounding makes the steps alternate.
fn measure(
    table: &Table<'_>,
    time_s: &[f64],
    warnings: &mut Vec<String>,
) -> Result<f64, ReadError> {
    let steps = || time_s.windows(2).map(|pair| pair[1] - pair[0]);
    if let Some(row) = steps().position(|step| step <= 0.0) {
        return Err(ReadError::Time {
            file: table.file.to_owned(),
            line: table.line_of_row(row + 1),
            before: time_s[row],
            after: time_s[row + 1],
        });
    }
    let longest = GAP * median(steps().collect()) * (1.0 + 1e-6);
    let (mut sum, mut squares, mut count, mut gaps) = (0.0, 0.0, 0.0, 0_usize);
    for step in steps() {
        if step <= longest {
            sum += step;
            squares += step * step;
            count += 1.0;
        } else {
            gaps += 1;
        }
    }
    let mean: f64 = sum / count;
    let jitter = (squares / count / (mean * mean) - 1.0).max(0.0).sqrt();
    if jitter > JITTER {
        warnings.push(format!(
            "The time steps are uneven by {:.1} % (rms).",
            100.0 * jitter
        ));
    }
    if let Some((row, gap)) = steps().enumerate().find(|(_, step)| *step > longest) {
        warnings.push(format!(
            "{gaps} gap(s) in the time column; the first, of {:.6} s, ends on line {}. Samples are taken as evenly spaced.",
            gap,
            table.line_of_row(row + 1)
        ));
    }
    let rate_hz = snap(1.0 / mean);
    check_rate(rate_hz).map_err(|source| ReadError::Recording {
        file: table.file.to_owned(),
        source,
    })?;
    Ok(rate_hz)
}

fn median(mut steps: Vec<f64>) -> f64 {
    let middle = (steps.len() - 1) / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

fn snap(rate_hz: f64) -> f64 {
    let whole = rate_hz.round();
    if (rate_hz - whole).abs() <= WHOLE * whole {
        whole
    } else {
        rate_hz
    }
}
