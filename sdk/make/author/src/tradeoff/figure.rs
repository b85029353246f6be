//! Plots of error against cost.

use crate::report::{Axis, Line, Plot, RECORDING_COLOR, Series, model_color};
use htex_format::{By, Measure};
use htex_host::Registry;

use crate::tradeoff::against::{Against, Cost};
use crate::tradeoff::knee::along_front;
use crate::tradeoff::point::{Point, QUANTISED, RECORDING, errors, others};

pub(crate) fn mark_front(points: &mut [Point], against: Against) {
    let compared: Vec<usize> =
        (0..points.len()).filter(|&i| against.cost.compares(&points[i])).collect();
    let shown: Vec<&Point> = compared.iter().map(|&i| &points[i]).collect();
    let on_front = against.on_front(&shown);
    for (&i, on) in compared.iter().zip(on_front) {
        match against.cost {
            Cost::Bytes => points[i].on_front = on,
            Cost::Time => points[i].on_time_front = on,
        }
    }
}

/// Plots error against cost: all settings as small dots, the points on each model's own front as
/// larger dots, both baselines, the front of all models, and the error of a second recording as a
/// floor. Both axes are logarithmic.
pub(crate) fn figure(title: &str, points: &[&Point], models: &[String], against: Against) -> Plot {
    let shown: Vec<&Point> = points.iter().copied().filter(|p| against.cost.compares(p)).collect();
    let window = Window::new(points, against);
    let [low, high] = window.costs;
    let [least, most] = window.errors;
    let label = format!("{} / {}", against.error, against.error.unit());
    let mut plot = Plot::new(
        title,
        against.cost.axis().with_range(low, high),
        Axis::log(&label).with_range(least, most),
    );
    // Narrow, so that text stays readable on a phone.
    (plot.width, plot.height) = (440.0, 380.0);
    let front = along_front(&shown, against);
    let mut line = Series::line("front of all", steps(&front, against));
    line.line_width_px = 2.0;
    line.hover = false;
    plot.series.push(line.colored("#b8b8b8"));
    plot.series.extend(floor(&shown, against, window));
    let builtin = Registry::builtin_names();
    for model in models {
        let color = model_color(model, &builtin);
        let own: Vec<&Point> = shown.iter().copied().filter(|p| p.model == *model).collect();
        let places =
            |points: &[&Point]| points.iter().map(|p| against.place(p)).collect::<Vec<_>>();
        let mut dots = Series::scatter("", places(&own)).colored(color).behind();
        dots.marker_radius_px = Some(1.0);
        plot.series.push(dots);
        let best = along_front(&own, against);
        let mut best_dots = Series::scatter(model, places(&best)).colored(color);
        best_dots.notes = best.iter().map(|p| note(p)).collect();
        plot.series.push(best_dots);
    }
    // If the recording is too large to be shown in the plot, the floor represents it.
    let is_inside = |p: &&&Point| against.place(p).0 <= high;
    for point in shown.iter().filter(|p| p.is_baseline()).filter(is_inside) {
        let quantised = point.model == QUANTISED;
        let name = match point.setting.as_str() {
            "default" => point.model.replace('-', " "),
            other => format!("{} {other}", point.model.replace('-', " ")),
        };
        let color = if quantised { "#000000" } else { RECORDING_COLOR };
        let mut series = Series::scatter(&name, vec![against.place(point)]).colored(color);
        series.marker_radius_px = Some(5.0);
        series.line = Line::None;
        series.marker_hollow = !quantised || point.setting != "default";
        series.notes = vec![note(point)];
        plot.series.push(series);
    }
    plot
}

/// The costs and errors that a plot shows.
#[derive(Clone, Copy)]
struct Window {
    costs: [f64; 2],
    errors: [f64; 2],
}

impl Window {
    /// Shows the front of all models against bytes, and the floor. Otherwise, a model that is far
    /// worse than the front would take up most of the picture's height, and the size of the
    /// recording would take up most of its width. Both pictures show the same errors.
    fn new(points: &[&Point], against: Against) -> Self {
        let shown = |cost: Cost| points.iter().copied().filter(move |p| cost.compares(p));
        let models = shown(against.cost).filter(|p| p.model != RECORDING);
        let costs = models.map(|p| against.place(p).0).filter(|cost| cost.is_finite());
        let [low, high] = ends(costs);
        let by_bytes = Against { cost: Cost::Bytes, ..against };
        let compared: Vec<&Point> = shown(Cost::Bytes).collect();
        let front = along_front(&compared, by_bytes).into_iter();
        let baselines = compared.iter().copied().filter(|p| p.is_baseline());
        let errors = front.chain(baselines).map(|p| by_bytes.place(p).1);
        let [least, most] = ends(errors.filter(|error| *error > 0.0 && error.is_finite()));
        Self { costs: [low / MARGIN, high * MARGIN], errors: [least / MARGIN, most * MARGIN] }
    }
}

/// Space between the outermost points and the edges of a plot, as a ratio.
const MARGIN: f64 = 1.25;

fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, 0.0], |[low, high], x| [low.min(x), high.max(x)])
}

/// Returns a sentence about models that lie entirely above the plot; `None` if there are none.
pub(crate) fn above(points: &[&Point], models: &[String], against: Against) -> Option<String> {
    let shown: Vec<&Point> = points.iter().copied().filter(|p| against.cost.compares(p)).collect();
    let [_, most] = Window::new(points, against).errors;
    let outside = models.iter().filter_map(|model| {
        let own = shown.iter().filter(|p| p.model == *model);
        let errors = own.map(|p| against.place(p).1).filter(|error| error.is_finite());
        let [least, _] = ends(errors);
        let is_above = least > most && least.is_finite();
        is_above.then(|| format!("{model} (from {})", against.error.amount(least)))
    });
    let outside: Vec<String> = outside.collect();
    let name = against.cost.name();
    (!outside.is_empty())
        .then(|| format!("Above the picture against {name}: {}.", outside.join(", ")))
}

/// Returns a line at the difference between the recording's own halves, across all costs. Errors
/// below this line do not distinguish models.
fn floor(shown: &[&Point], against: Against, window: Window) -> Option<Series> {
    let recording = shown.iter().find(|p| p.model == RECORDING)?;
    let error = against.place(recording).1;
    let mut line =
        Series::line("floor: a second recording", window.costs.map(|x| (x, error)).to_vec())
            .colored(RECORDING_COLOR)
            .behind();
    line.line = Line::Dashed;
    Some(line)
}

/// Converts a front to steps: at the cost of each point, and at all higher costs, the error of this
/// point can be reached.
fn steps(front: &[&Point], against: Against) -> Vec<(f64, f64)> {
    let mut steps = Vec::new();
    for point in front {
        let place = against.place(point);
        if let Some(&(_, before)) = steps.last() {
            steps.push((place.0, before));
        }
        steps.push(place);
    }
    steps
}

fn note(p: &Point) -> String {
    let all = errors().chain(others());
    let held_out = p.held_out_error.map(|error| format!("held out {error:.2}"));
    let fitted = all.flat_map(|measure| measured(p, measure));
    let measures: Vec<String> = held_out.into_iter().chain(fitted).collect();
    format!(
        "{}: {} bytes, {:.1} ns a sample (±{:.0} %), first sample {:.0} µs, fit {:.2} ms; {}",
        p.name(),
        p.bytes,
        p.ns_per_sample,
        100.0 * p.spread,
        p.first_sample_us,
        p.fit_ms,
        measures.join(", ")
    )
}

/// Returns a measure as text, such as `nine bands 1.20 dB`, and also the measure of rendered
/// samples if it has a column.
fn measured(p: &Point, measure: Measure) -> impl Iterator<Item = String> {
    let row = measure.row();
    let words = |name: &str, by| {
        let text = format!("{name} {:.*} {}", row.decimals, p.get(by, measure), row.unit);
        text.trim_end().to_owned()
    };
    let own = row.column.map(|_| words(row.short, By::Magnitude));
    let played = row.played.map(|_| words(&format!("played {}", row.short), By::Samples));
    own.into_iter().chain(played)
}
