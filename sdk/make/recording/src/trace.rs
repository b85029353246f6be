//! Motion traces as CSV: the finger's position and normal force over time.

use std::path::Path;

use htex_format::Quantity;

use crate::columns::map::Role;
use crate::columns::names::{Unit, base_unit, recognise};
use crate::error::{Fault, ReadError, ReadProblem};
use crate::formats::csv::Csv;
use crate::input::{InputFile, file_name};
use crate::sheet::{Columns, Sheet};
use crate::value_limit::ValueLimit;

/// Shortest time between two rows, seconds.
const SHORTEST_S: f64 = 1e-9;
/// Largest magnitude of a time (seconds), position (mm), speed (mm/s) or force (newtons).
const LARGEST: f64 = 1e9;

/// The columns of a motion trace. All columns have the same number of rows, at least two.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceColumns {
    /// Time, seconds, strictly ascending.
    pub t_s: Vec<f64>,
    /// Position along x, mm.
    pub x_mm: Vec<f64>,
    /// Position along y, mm.
    pub y_mm: Vec<f64>,
    /// Normal force, newtons.
    pub force_n: Vec<f64>,
    /// Sliding speed, mm/s, if the trace contains it.
    pub speed_mm_s: Option<Vec<f64>>,
    /// Warnings of the reader: assumed units and unused columns.
    pub warnings: Vec<String>,
}

/// Reads a trace from a CSV with the columns `t_s`, `x_mm`, `y_mm`, `force_n` and optionally
/// `speed_mm_s`. Other names and units are recognised as in a recording (`time [ms]`, `fz_n`).
///
/// # Errors
/// Returns the same errors as [`read_recording`](crate::read_recording) for a CSV. Also returns an
/// error if a time does not increase by at least a nanosecond, or if the magnitude of a number
/// exceeds 1e9. The error names the line.
pub fn read_trace(path: &Path) -> Result<TraceColumns, ReadError> {
    let read = InputFile::file(path).and_then(trace);
    read.map_err(|fault| fault.in_file(&file_name(path)))
}

/// Reads a trace from bytes in memory; `file` is the file's name in messages.
///
/// # Errors
/// Returns the same errors as [`read_trace`].
pub fn trace_from_bytes(file: &str, bytes: &[u8]) -> Result<TraceColumns, ReadError> {
    let read = InputFile::bytes(Path::new(file), bytes).and_then(trace);
    read.map_err(|fault| fault.in_file(file))
}

/// The columns of a stroke: speed and force over time. All columns have the same number of rows, at
/// least two.
#[derive(Debug, Clone, PartialEq)]
pub struct StrokeColumns {
    /// Time, seconds, strictly ascending.
    pub t_s: Vec<f64>,
    /// Sliding speed, mm/s, not negative.
    pub speed_mm_s: Vec<f64>,
    /// Normal force, newtons.
    pub force_n: Vec<f64>,
    /// Warnings of the reader: assumed units and unused columns.
    pub warnings: Vec<String>,
}

/// Reads a stroke from a CSV with time, speed and force (`t_s`, `speed_mm_s`, `force_n`). A file
/// without a speed is read as a trace, and the speed is computed from its positions.
///
/// # Errors
/// Returns the same errors as [`read_trace`].
pub fn read_stroke(path: &Path) -> Result<StrokeColumns, ReadError> {
    let read = InputFile::file(path).and_then(stroke);
    read.map_err(|fault| fault.in_file(&file_name(path)))
}

/// Reads a stroke from bytes in memory; `file` is the file's name in messages.
///
/// # Errors
/// Returns the same errors as [`read_stroke`].
pub fn stroke_from_bytes(file: &str, bytes: &[u8]) -> Result<StrokeColumns, ReadError> {
    let read = InputFile::bytes(Path::new(file), bytes).and_then(stroke);
    read.map_err(|fault| fault.in_file(file))
}

fn stroke(opened: InputFile<'_>) -> Result<StrokeColumns, Fault> {
    let mut csv = Csv::open(opened, ValueLimit::default())?;
    let columns = csv.columns();
    let mut warnings = Vec::new();
    if find(columns, Role::Speed, &mut warnings)?.is_none() {
        return Ok(along(traced(csv)?));
    }
    let mut found = Vec::new();
    for role in [Role::Time, Role::Speed, Role::Normal] {
        found.push(find(columns, role, &mut warnings)?.ok_or_else(|| missing(columns, role))?);
    }
    let wanted: Vec<usize> = found.iter().map(|(column, _)| *column).collect();
    let numbers = csv.numbers(&wanted)?.columns.into_iter().zip(&found);
    let mut columns = numbers.map(|(values, (_, scale))| scaled(values, *scale));
    let mut next = || columns.next().unwrap_or_default();
    let (t_s, mut speed_mm_s, force_n) = (next(), next(), next());
    check_time(&csv, &t_s)?;
    for column in [&t_s, &speed_mm_s, &force_n] {
        check_size(&csv, column)?;
    }
    speed_mm_s.iter_mut().for_each(|speed| *speed = speed.abs());
    // The columns are looked for twice if the file turns out to be a trace.
    warnings.dedup();
    Ok(StrokeColumns { t_s, speed_mm_s, force_n, warnings })
}

/// Computes the speed and force of a stroke from a trace.
fn along(trace: TraceColumns) -> StrokeColumns {
    let of = |position: &[f64]| crate::velocity(&trace.t_s, position, trace.t_s.iter().copied());
    let speeds = of(&trace.x_mm).into_iter().zip(of(&trace.y_mm));
    StrokeColumns {
        speed_mm_s: speeds.map(|(x, y)| libm::hypot(x, y)).collect(),
        t_s: trace.t_s,
        force_n: trace.force_n,
        warnings: trace.warnings,
    }
}

fn trace(opened: InputFile<'_>) -> Result<TraceColumns, Fault> {
    traced(Csv::open(opened, ValueLimit::default())?)
}

fn traced(mut csv: Csv<'_>) -> Result<TraceColumns, Fault> {
    let columns = csv.columns();
    let mut warnings = Vec::new();
    let mut found = Vec::new();
    for role in [Role::Time, Role::X, Role::Y, Role::Normal] {
        found.push(find(columns, role, &mut warnings)?.ok_or_else(|| missing(columns, role))?);
    }
    let speed = find(columns, Role::Speed, &mut warnings)?;
    found.extend(speed);
    warn_of_unused(columns, &found, &mut warnings);
    let wanted: Vec<usize> = found.iter().map(|(column, _)| *column).collect();
    let numbers = csv.numbers(&wanted)?.columns;
    let mut columns =
        numbers.into_iter().zip(&found).map(|(values, (_, scale))| scaled(values, *scale));
    let mut next = || columns.next().unwrap_or_default();
    let trace = TraceColumns {
        t_s: next(),
        x_mm: next(),
        y_mm: next(),
        force_n: next(),
        speed_mm_s: speed.map(|_| next()),
        warnings,
    };
    check_time(&csv, &trace.t_s)?;
    let motion = [&trace.t_s, &trace.x_mm, &trace.y_mm, &trace.force_n];
    for column in motion.into_iter().chain(&trace.speed_mm_s) {
        check_size(&csv, column)?;
    }
    Ok(trace)
}

/// Returns the column with a role, and the factor to the role's unit.
fn find(
    columns: &Columns,
    role: Role,
    warnings: &mut Vec<String>,
) -> Result<Option<(usize, f64)>, ReadProblem> {
    let named = |column: usize| match recognise(&columns.name(column), Quantity::LateralForce) {
        Some((known, unit)) if known == role => Some((column, unit)),
        _ => None,
    };
    let all: Vec<(usize, Unit)> = (0..columns.width()).filter_map(named).collect();
    let (column, unit) = match &all[..] {
        [] => return Ok(None),
        [one] => one,
        [one, other, ..] => {
            let (one, other) = (columns.name(one.0), columns.name(other.0));
            let problem = format!("{one:?} and {other:?} both match {role}; keep one of them");
            return Err(columns.refuse(problem));
        }
    };
    let (name, wanted) = (columns.name(*column), base_unit(role, Quantity::LateralForce));
    let scale = match unit {
        Unit::Scale(scale) => *scale,
        Unit::Unsaid => {
            warnings.push(format!("Column {name:?} ({role}) has no unit; {wanted} is assumed."));
            1.0
        }
        Unit::Volts | Unit::Unknown(_) => {
            let problem =
                format!("column {name:?} is not in a unit known for {role}; write it in {wanted}");
            return Err(columns.refuse(problem));
        }
    };
    Ok(Some((*column, scale)))
}

fn missing(columns: &Columns, role: Role) -> ReadProblem {
    let problem = if columns.are_named {
        format!("there is no column for {role}; a trace's header is t_s,x_mm,y_mm,force_n")
    } else {
        "there is no header row; write t_s,x_mm,y_mm,force_n".to_owned()
    };
    columns.refuse(problem)
}

fn warn_of_unused(columns: &Columns, found: &[(usize, f64)], warnings: &mut Vec<String>) {
    let unused = |column: &usize| found.iter().all(|(used, _)| used != column);
    let names: Vec<String> =
        (0..columns.width()).filter(unused).map(|column| columns.name(column)).collect();
    if !names.is_empty() {
        warnings.push(format!("Columns not used: {}.", names.join(", ")));
    }
}

fn scaled(mut values: Vec<f64>, scale: f64) -> Vec<f64> {
    if scale != 1.0 {
        values.iter_mut().for_each(|value| *value *= scale);
    }
    values
}

fn check_size(csv: &Csv<'_>, values: &[f64]) -> Result<(), Fault> {
    match values.iter().position(|value| value.abs() > LARGEST) {
        None => Ok(()),
        Some(row) => {
            let problem = format!("{} is beyond {LARGEST}; correct its unit", values[row]);
            Err(ReadProblem::Invalid(problem).at_place(csv.place(row)))
        }
    }
}

fn check_time(csv: &Csv<'_>, t_s: &[f64]) -> Result<(), Fault> {
    let Some(row) = t_s.windows(2).position(|pair| pair[1] - pair[0] < SHORTEST_S) else {
        return Ok(());
    };
    let (before, after) = (t_s[row], t_s[row + 1]);
    let problem = format!(
        "the time after {before} s is {after} s; it must increase on every row by a nanosecond or more (a column with too \
         few decimals repeats values)"
    );
    Err(ReadProblem::Invalid(problem).at_place(csv.place(row + 1)))
}
