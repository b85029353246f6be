//! Draws a measured response: magnitude, phase and coherence over frequency.

use htex_author::report::{Axis, Plot, Series, series_color, stacked};

use super::measure::MeasuredResponse;

/// Size of the magnitude plot, and height of the other two plots, pixels.
const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 280.0;
const LOW_HEIGHT: f64 = 170.0;
/// Colour of the standard deviation.
const DEVIATION: &str = "#a0a0a0";

/// Draws one SVG that shows the magnitude in decibels and its standard deviation, the phase in
/// degrees, and the coherence.
#[must_use]
pub fn response_picture(measured: &MeasuredResponse, title: &str) -> String {
    let plots = [magnitude(measured, title), phase(measured), coherence(measured)];
    stacked(&format!("Frequency response: {title}"), &plots)
}

fn magnitude(measured: &MeasuredResponse, title: &str) -> Plot {
    let curve = |factor: &dyn Fn(f64) -> f64| {
        let both = measured.magnitude.iter().zip(&measured.relative_error);
        let level = both.map(|(magnitude, error)| decibels(magnitude * factor(*error)));
        points(measured, level)
    };
    let mut plot = plot(measured, title, Axis::linear("magnitude / dB"), HEIGHT);
    plot.legend = true;
    let above = Series::line("one standard deviation", curve(&|error| 1.0 + error));
    let below = Series::line("", curve(&|error| 1.0 - error));
    plot.series.push(above.behind().colored(DEVIATION));
    plot.series.push(below.behind().colored(DEVIATION));
    let name = format!("{} of {} averages", measured.estimator, measured.averages);
    plot.series.push(Series::line(&name, curve(&|_| 1.0)).colored(series_color(0)));
    if let Some(peak) = &measured.peak {
        let name = format!("largest: {:.2} dB at {:.2} Hz", peak.magnitude_db, peak.frequency_hz);
        let point = vec![(peak.frequency_hz, peak.magnitude_db)];
        plot.series.push(Series::scatter(&name, point).colored(series_color(1)));
    }
    plot
}

fn phase(measured: &MeasuredResponse) -> Plot {
    let degrees = measured.phase_rad.iter().map(|phase| phase.to_degrees());
    let mut plot = plot(measured, "", Axis::linear("phase / °"), LOW_HEIGHT);
    let series = Series::line("phase", points(measured, degrees));
    plot.series.push(series.colored(series_color(0)));
    plot
}

fn coherence(measured: &MeasuredResponse) -> Plot {
    let axis = Axis::linear("coherence").with_range(0.0, 1.02);
    let mut plot = plot(measured, "", axis, LOW_HEIGHT);
    let values = measured.coherence.iter().copied();
    let series = Series::line("coherence", points(measured, values));
    plot.series.push(series.colored(series_color(0)));
    plot
}

fn plot(measured: &MeasuredResponse, title: &str, y: Axis, height: f64) -> Plot {
    let ends = [measured.frequency_hz.first(), measured.frequency_hz.last()];
    let x = match ends {
        [Some(low), Some(high)] => {
            Axis::log("frequency / Hz").with_range(low.max(measured.resolution_hz), *high)
        }
        _ => Axis::log("frequency / Hz"),
    };
    let mut plot = Plot::new(title, x, y);
    (plot.width, plot.height, plot.legend) = (WIDTH, height, false);
    plot
}

fn points(measured: &MeasuredResponse, values: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    measured.frequency_hz.iter().copied().zip(values).collect()
}

/// Returns decibels. For a magnitude of 0 the result is not finite, so the plot has a gap at this
/// frequency.
fn decibels(magnitude: f64) -> f64 {
    20.0 * libm::log10(magnitude)
}
