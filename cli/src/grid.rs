//! Shows a fitted grid of conditions as text and as a picture.

use std::fmt::Write;

use htex_author::report::{Axis, Plot, Series};
use htex_author::{CellStatus, GridCell, GridReport};

/// Classes of repeatability: upper limit in decibels, name and colour. The colours darken from good
/// to bad.
const CLASSES: [(f64, &str, &str); 4] = [
    (0.5, "repeats within 0.5 dB", "#009e73"),
    (1.0, "0.5 to 1 dB", "#0072b2"),
    (2.0, "1 to 2 dB", "#d55e00"),
    (f64::INFINITY, "above 2 dB", "#7d1f6b"),
];
const WINDOWS: &str = "#c4c4c4";
const MESH: &str = "#8a8a8a";
const THIN: &str = "#222222";

/// Formats a grid as a table of segments and repeatability, with a line for each speed and a column
/// for each force.
pub(crate) fn grid_text(grid: &GridReport) -> String {
    let mut text = format!(
        "grid: {} of {} windows of 0.2 s are steady; {} conditions, {} cells too thin\n",
        grid.steady,
        grid.windows,
        count(grid, |cell| cell.condition.is_some()),
        count(grid, |cell| cell.status == CellStatus::Thin),
    );
    if let (Some(grid), Some(one)) = (grid.left_out_rms_db, grid.one_condition_rms_db) {
        let _ = writeln!(
            text,
            "of blocks of time that were left out: {grid:.2} dB (third octaves, RMS); one condition for all motions: {one:.2} dB",
        );
    }
    text +=
        "segments, and repeatability in dB, by speed and force (+ with neighbours, - too thin):\n";
    let _ = write!(text, "  {:>10}", "mm/s");
    for force in &grid.force_n {
        let _ = write!(text, "  {:>11}", format!("{} N", short(*force)));
    }
    text.push('\n');
    for (i, speed) in grid.speed_mm_s.iter().enumerate() {
        let _ = write!(text, "  {:>10}", short(*speed));
        for j in 0..grid.force_n.len() {
            let _ = write!(text, "  {:>11}", grid.cell(i, j).map_or(String::new(), entry));
        }
        text.push('\n');
    }
    text
}

fn count(grid: &GridReport, is: impl Fn(&GridCell) -> bool) -> usize {
    grid.cells.iter().filter(|cell| is(cell)).count()
}

/// Formats a cell, e.g. `23   0.61 dB`.
fn entry(cell: &GridCell) -> String {
    let mark = match cell.status {
        CellStatus::Thin => return format!("{} -     ", cell.segments),
        CellStatus::Widened => "+",
        _ => " ",
    };
    let repeats = cell.repeatability_rms_db.map(|db| format!("{db:.2}"));
    format!("{}{mark} {:>5}", cell.averaged, repeats.unwrap_or("?".to_owned()))
}

/// Formats a number with three digits.
fn short(x: f64) -> String {
    match x {
        // The smallest number that rounds to 100.
        x if x >= 99.95 => format!("{x:.0}"),
        x if x >= 9.995 => format!("{x:.1}"),
        x => format!("{x:.2}"),
    }
}

/// Draws the steady windows over speed and force, the mesh, and the conditions, which have the
/// colour of their repeatability.
pub(crate) fn grid_plot(name: &str, grid: &GridReport) -> Plot {
    let mut plot = Plot::new(
        &format!("{name}: steady windows, conditions and mesh"),
        Axis::log("speed / mm/s"),
        Axis::log("normal force / N"),
    );
    (plot.width, plot.height) = (860.0, 560.0);
    let windows = grid.motions.iter().map(|[speed, force]| (*speed, *force));
    let mut windows =
        Series::scatter(&format!("{} steady windows", grid.steady), windows.collect())
            .colored(WINDOWS)
            .behind();
    windows.marker_radius_px = Some(1.6);
    plot.series.push(windows);
    plot.series.push(Series::line("mesh", mesh(grid)).colored(MESH).behind());
    let mut from_db = f64::NEG_INFINITY;
    for (to_db, name, color) in CLASSES {
        let within = |cell: &&GridCell| {
            // An unknown repeatability is in the worst class.
            let db = cell.repeatability_rms_db.unwrap_or(f64::INFINITY);
            cell.condition.is_some() && db > from_db && db <= to_db
        };
        push_cells(&mut plot, name, color, grid.cells.iter().filter(within));
        from_db = to_db;
    }
    let thin = grid.cells.iter().filter(|c| c.status == CellStatus::Thin);
    push_cells(&mut plot, "too thin: no condition", THIN, thin);
    if let Some(last) = plot.series.last_mut() {
        // Without thin cells, no series was added, and the last series is another one.
        last.marker_hollow = last.name.starts_with("too thin");
    }
    plot
}

/// Adds cells as dots with their numbers. Adds no series if there are no cells.
fn push_cells<'a>(
    plot: &mut Plot,
    name: &str,
    color: &str,
    cells: impl Iterator<Item = &'a GridCell>,
) {
    let cells: Vec<&GridCell> = cells.collect();
    if cells.is_empty() {
        return;
    }
    let points = cells.iter().map(|cell| (cell.speed_mm_s, cell.force_n));
    let mut series = Series::scatter(name, points.collect()).colored(color);
    series.marker_radius_px = Some(5.0);
    let note = |cell: &&GridCell| {
        let repeats = cell.repeatability_rms_db;
        let repeats = repeats.map_or(String::new(), |db| format!(", repeats within {db:.2} dB"));
        format!(
            "{} mm/s, {} N: {} segments inside, {} averaged{repeats}",
            short(cell.speed_mm_s),
            short(cell.force_n),
            cell.segments,
            cell.averaged
        )
    };
    series.notes = cells.iter().map(note).collect();
    plot.series.push(series);
}

/// Returns the outlines of the triangles, separated by points that are not drawn.
fn mesh(grid: &GridReport) -> Vec<(f64, f64)> {
    let conditions: Vec<(f64, f64)> = grid
        .cells
        .iter()
        .filter(|cell| cell.condition.is_some())
        .map(|cell| (cell.speed_mm_s, cell.force_n))
        .collect();
    let outline = |corners: &[usize; 3]| {
        let [a, b, c] = corners.map(|i| conditions.get(i).copied());
        [a, b, c, a, None].map(|place| place.unwrap_or((f64::NAN, f64::NAN)))
    };
    grid.triangles.iter().flat_map(outline).collect()
}
