//! Determines the sample rate of a table from the options or from the time column.

use htex_base::finding::{Findings, Notice};

use crate::error::{Fault, ReadProblem};
use crate::hertz::hertz;
use crate::recording::check_rate;
use crate::rules::{RECORDING_CLOCK_GAP, RECORDING_CLOCK_JITTER};
use crate::sheet::Sheet;

/// A step longer than this multiple of the median step is a gap, if the clock is otherwise even.
const GAP: f64 = 1.5;
/// A step longer than this multiple of the median step is a gap, if the clock is uneven. In such a
/// clock, short steps make up for a long one. In a Poisson process, one step in a thousand is
/// longer than the median by more than this factor.
const GAP_UNEVEN: f64 = 10.0;
/// A clock counts as uneven if the interquartile range of its steps, divided by their median, is
/// above this. If steps are normally distributed with this scatter, one step in 200,000 exceeds
/// [`GAP`].
const UNEVEN: f64 = 0.15;
/// The reader reports a jitter of the steps (standard deviation divided by mean) that is above this
/// value.
const JITTER: f64 = 0.01;
/// The reader warns if the rate of the time column differs from the given rate by more than this
/// fraction.
const DISAGREE: f64 = 1e-3;
/// A rate that differs from an integer by at most this fraction is rounded to the integer, because
/// printed times are rounded.
const WHOLE: f64 = 1e-5;

/// Returns the definition of the findings about a time column, for `spec/recording-findings.md`.
pub fn clock_definition() -> String {
    format!(
        "- `RECORDING_CLOCK_GAP`: a step of the time column exceeds {GAP} times the median of all steps, or {GAP_UNEVEN} times if the clock is uneven: if the distance \
         of the quartiles of the steps exceeds {UNEVEN} of their median. A step of up to one millionth more is none.\n\
         - `RECORDING_CLOCK_JITTER`: the standard deviation of the steps that are no gaps exceeds {JITTER} of their mean.\n"
    )
}

/// Warnings of the reader, and findings of the time column.
#[derive(Default)]
pub(crate) struct ReadNotices {
    pub(crate) warnings: Vec<Notice>,
    pub(crate) findings: Findings,
}

/// Returns the sample rate of a file without a time column: the given rate, or else the file's own.
pub(crate) fn given(
    own: Option<f64>,
    given: Option<f64>,
    noticed: &mut ReadNotices,
) -> Option<f64> {
    if let (Some(own), Some(given)) = (own, given)
        && (own / given - 1.0).abs() > DISAGREE
    {
        noticed.warnings.push(
            format!(
                "The file has a rate of {}, the given rate is {}; the given rate is used.",
                hertz(own),
                hertz(given)
            )
            .into(),
        );
    }
    given.or(own)
}

/// Returns the sample rate of a file in hertz: the rate `given`, or else the rate of the time
/// column `time_s`.
pub(crate) fn rate(
    file: &str,
    sheet: &dyn Sheet,
    time_s: Option<&[f64]>,
    given: Option<f64>,
    noticed: &mut ReadNotices,
) -> Result<f64, Fault> {
    let measured = match (time_s, given) {
        (None, None) => return Err(ReadProblem::NoRate.into()),
        (None, Some(given)) => return Ok(given),
        (Some(time_s), _) => measure(sheet, time_s, given, noticed),
    };
    match (measured, given) {
        (measured, None) => measured,
        (Ok(measured), Some(given)) => {
            if (measured / given - 1.0).abs() > DISAGREE {
                noticed.warnings.push(format!(
                    "The time column has a rate of {}, the given rate is {}; the given rate is used.",
                    hertz(measured),
                    hertz(given)
                ).into());
            }
            Ok(given)
        }
        (Err(fault), Some(given)) => {
            let error = fault.in_file(file);
            let sentence = format!("The given rate is used instead of the time column: {error}.");
            noticed.warnings.push(sentence.into());
            Ok(given)
        }
    }
}

/// Returns the sample rate of the time column: the number of steps divided by their total duration.
/// Gaps are left out of both.
fn measure(
    sheet: &dyn Sheet,
    time_s: &[f64],
    given: Option<f64>,
    noticed: &mut ReadNotices,
) -> Result<f64, Fault> {
    let steps = || time_s.windows(2).map(|pair| pair[1] - pair[0]);
    // Checked before gaps are looked for: with a median step that is not positive, every step would
    // count as a gap.
    if let Some(row) = steps().position(|step| step <= 0.0) {
        let (before, after) = (time_s[row], time_s[row + 1]);
        return Err(ReadProblem::Time { before, after }.at_place(sheet.place(row + 1)));
    }
    let longest = longest_step(steps().collect());
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
    // Gaps are left out, because they would lower the rate of all samples between them.
    let mean: f64 = sum / count;
    let rate_hz = snap(1.0 / mean);
    check_rate(rate_hz)?;
    let findings = &mut noticed.findings;
    if let Some((row, gap)) = steps().enumerate().find(|(_, step)| *step > longest) {
        findings.add(RECORDING_CLOCK_GAP, format!("/time/{}", row + 1), format!(
            "{gaps} gap{} in the time column; the first, of {gap:.6} s, ends on {}. Samples are taken as evenly \
             spaced; cut the recording there",
            if gaps == 1 { "" } else { "s" },
            sheet.place(row + 1)
        ));
    }
    // For an even clock, rounding can make the difference slightly negative.
    let jitter = (squares / count / (mean * mean) - 1.0).max(0.0).sqrt();
    if jitter > JITTER {
        let used = match given {
            None => format!("read at {}, the mean rate", hertz(rate_hz)),
            Some(_) => "the given rate is used".to_owned(),
        };
        findings.add(
            RECORDING_CLOCK_JITTER,
            "/time",
            format!(
                "the steps of the time column are uneven by {:.1} % (rms); {used}",
                100.0 * jitter
            ),
        );
    }
    Ok(rate_hz)
}

/// Returns the longest duration of a step that does not count as a gap.
fn longest_step(mut steps: Vec<f64>) -> f64 {
    let last = steps.len() - 1;
    let mut rank = |at: usize| *steps.select_nth_unstable_by(at, f64::total_cmp).1;
    // Each rank is selected on its own, because a selection takes linear time, and sorting millions
    // of steps takes longer.
    let [low, median, high] = [last / 4, last / 2, last - last / 4].map(&mut rank);
    let is_even = high - low <= UNEVEN * median;
    // A step that is too long only because of rounding is not a gap.
    let factor = if is_even { GAP } else { GAP_UNEVEN };
    factor * median * (1.0 + 1e-6)
}

/// Returns the integer closest to a rate if the rate is nearly equal to it, otherwise the rate.
pub(crate) fn snap(rate_hz: f64) -> f64 {
    let whole = rate_hz.round();
    if (rate_hz - whole).abs() <= WHOLE * whole { whole } else { rate_hz }
}
