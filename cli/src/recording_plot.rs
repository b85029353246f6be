//! Draws a recording with the segments that are used and the segments that are left out.

use std::ops::Range;

use htex_author::report::{Axis, Line, Plot, Series, series_color};
use htex_author::{Recording, Segments};

/// Number of columns in the picture. Each column shows the lowest and the highest of its samples.
const COLUMNS: usize = 1000;
const READ: &str = "#0072b2";
const LEFT_OUT: &str = "#d55e00";
const QUIET: &str = "#b5b5b5";

/// Draws the signal's magnitude over time, and marks the segments that are used, the segments that
/// are left out, and the threshold by which sweeps are found.
pub(crate) fn recording_plot(recording: &Recording, segments: &Segments) -> Plot {
    let values: Vec<f64> = (0..recording.samples()).map(|at| recording.magnitude_at(at)).collect();
    let draw = |name: String, color: &str, parts: &[Range<usize>]| {
        let mut series = Series::line(&name, envelope(recording, &values, parts)).colored(color);
        (series.hover, series.line_width_px) = (false, 1.0);
        series
    };
    let mut plot = Plot::new(
        &recording.source,
        Axis::linear("time / s").with_range(recording.second(0), recording.second(values.len())),
        Axis::linear(&format!(
            "{}, magnitude / {}",
            recording.quantity.words(),
            recording.quantity.unit()
        )),
    );
    (plot.width, plot.height) = (960.0, 320.0);
    let whole = 0..values.len();
    plot.series.push(draw("recorded".to_owned(), QUIET, &[whole]));
    let left_out = left_out(segments, values.len());
    if !left_out.is_empty() {
        plot.series.push(draw(format!("left out ({})", left_out.len()), LEFT_OUT, &left_out));
    }
    let read = format!("read ({} segments)", segments.starts.len());
    plot.series.push(draw(read, READ, &segments.stretches()));
    let ends = [0, values.len()].map(|at| (recording.second(at), segments.threshold));
    let mut threshold =
        Series::line("mean: sweeps lie above", ends.to_vec()).colored(series_color(4));
    (threshold.line, threshold.hover) = (Line::Dashed, false);
    plot.series.push(threshold);
    plot
}

/// Returns the segments that are off their target. If the segments come from sweeps, also returns
/// the incomplete sweeps.
fn left_out(segments: &Segments, samples: usize) -> Vec<Range<usize>> {
    let cut_off = segments
        .sweeps
        .iter()
        .filter(|sweep| segments.from_sweeps && (sweep.start == 0 || sweep.end == samples))
        .map(|sweep| sweep.start..sweep.end);
    let off_target = segments.off_target.iter().map(|start| *start..start + segments.len);
    cut_off.chain(off_target).collect()
}

/// Returns the lowest and the highest value in each column of the picture, with a break after each
/// part.
fn envelope(recording: &Recording, values: &[f64], parts: &[Range<usize>]) -> Vec<(f64, f64)> {
    let column = values.len().div_ceil(COLUMNS);
    let mut points = Vec::new();
    for part in parts {
        for start in part.clone().step_by(column) {
            let samples = &values[start..(start + column).min(part.end)];
            let low = samples.iter().copied().fold(f64::INFINITY, f64::min);
            let high = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let at = recording.second(start);
            points.extend([(at, low), (at, high)]);
        }
        points.push((f64::NAN, f64::NAN));
    }
    points
}
