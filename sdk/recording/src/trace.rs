//! Motion traces as CSV: position and normal force of the finger over time.

use std::path::Path;

use htex_format::Quantity;

use crate::ReadError;
use crate::columns::map::Role;
use crate::columns::names::{Unit, base_unit, recognise};
use crate::formats::blocks::Blocks;
use crate::formats::table::Table;
use crate::formats::text::{file_name, open};
use crate::value_limit::ValueLimit;

/// Shortest time between two rows, seconds.
const SHORTEST_S: f64 = 1e-9;
/// Largest magnitude of time (seconds), position (mm), speed (mm/s) and force (newtons).
const LARGEST: f64 = 1e9;

/// The columns of a trace, of equal length, at least two rows.
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
    /// Sliding speed, mm/s, if the trace has it.
    pub speed_mm_s: Option<Vec<f64>>,
    /// Assumptions: units without a name, unused columns.
    pub warnings: Vec<String>,
}

/// Reads a trace from a CSV with the columns `t_s`, `x_mm`, `y_mm`, `force_n` and optionally
/// `speed_mm_s`. Other names and units are recognised as in a recording (`time [ms]`, `fz_n`).
///
/// # Errors
/// Those of [`read_recording`](crate::read_recording) for a CSV; and, with the line, a time that
/// does not increase by a nanosecond, or a number beyond 1e9.
pub fn read_trace(path: &Path) -> Result<TraceColumns, ReadError> {
    trace(Blocks::new(
        &file_name(path),
        open(path)?,
        ValueLimit::default(),
    ))
}

/// Reads a trace from bytes; `file` is its name.
///
/// # Errors
/// As [`read_trace`].
pub fn trace_from_bytes(file: &str, bytes: &[u8]) -> Result<TraceColumns, ReadError> {
    trace(Blocks::new(file, bytes, ValueLimit::default()))
}

fn trace(mut blocks: Blocks<'_>) -> Result<TraceColumns, ReadError> {
    let head = blocks.head()?;
    let mut table = Table::new(blocks.file, &head)?;
    let mut warnings = Vec::new();
    let mut found = Vec::new();
    for role in [Role::Time, Role::X, Role::Y, Role::Normal] {
        found.push(find(&table, role, &mut warnings)?.ok_or_else(|| missing(&table, role))?);
    }
    let speed = find(&table, Role::Speed, &mut warnings)?;
    found.extend(speed);
    warn_of_unused(&table, &found, &mut warnings);
    let wanted: Vec<usize> = found.iter().map(|(column, _)| *column).collect();
    let columns = table
        .numbers(&wanted, &mut blocks)?
        .columns
        .into_iter()
        .zip(&found);
    let mut columns = columns.map(|(values, (_, scale))| scaled(values, *scale));
    let mut next = || columns.next().unwrap_or_default();
    let trace = TraceColumns {
        t_s: next(),
        x_mm: next(),
        y_mm: next(),
        force_n: next(),
        speed_mm_s: speed.map(|_| next()),
        warnings,
    };
    check_time(&table, &trace.t_s)?;
    let motion = [&trace.t_s, &trace.x_mm, &trace.y_mm, &trace.force_n];
    for column in motion.into_iter().chain(&trace.speed_mm_s) {
        check_size(&table, column)?;
    }
    Ok(trace)
}

/// Returns the column with a role and the factor to its unit.
fn find(
    table: &Table<'_>,
    role: Role,
    warnings: &mut Vec<String>,
) -> Result<Option<(usize, f64)>, ReadError> {
    let named = |column: usize| match recognise(&table.name(column), Quantity::LateralForce) {
        Some((known, unit)) if known == role => Some((column, unit)),
        _ => None,
    };
    let all: Vec<(usize, Unit)> = (0..table.width).filter_map(named).collect();
    let (column, unit) = match &all[..] {
        [] => return Ok(None),
        [one] => one,
        [one, other, ..] => {
            let (one, other) = (table.name(one.0), table.name(other.0));
            let problem = format!("{one:?} and {other:?} both match {role}; keep one of them");
            return Err(refuse(table, problem));
        }
    };
    let (name, wanted) = (table.name(*column), base_unit(role, Quantity::LateralForce));
    let scale = match unit {
        Unit::Scale(scale) => *scale,
        Unit::Unsaid => {
            warnings.push(format!(
                "Column {name:?} ({role}) has no unit; {wanted} is assumed."
            ));
            1.0
        }
        Unit::Volts | Unit::Unknown(_) => {
            let problem =
                format!("column {name:?} is not in a unit known for {role}; write it in {wanted}");
            return Err(refuse(table, problem));
        }
    };
    Ok(Some((*column, scale)))
}

fn missing(table: &Table<'_>, role: Role) -> ReadError {
    let problem = match table.header {
        None => "there is no header row; write t_s,x_mm,y_mm,force_n".to_owned(),
        Some(_) => {
            format!("there is no column for {role}; a trace's header is t_s,x_mm,y_mm,force_n")
        }
    };
    refuse(table, problem)
}

fn refuse(table: &Table<'_>, problem: String) -> ReadError {
    ReadError::Columns {
        file: table.file.to_owned(),
        problem,
        columns: table.names(),
    }
}

fn warn_of_unused(table: &Table<'_>, found: &[(usize, f64)], warnings: &mut Vec<String>) {
    let unused = |column: &usize| found.iter().all(|(used, _)| used != column);
    let names: Vec<String> = (0..table.width)
        .filter(unused)
        .map(|column| table.name(column))
        .collect();
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

fn check_size(table: &Table<'_>, values: &[f64]) -> Result<(), ReadError> {
    match values.iter().position(|value| value.abs() > LARGEST) {
        None => Ok(()),
        Some(row) => Err(ReadError::Trace {
            file: table.file.to_owned(),
            line: table.line_of_row(row),
            problem: format!("{} is beyond {LARGEST}; correct its unit", values[row]),
        }),
    }
}

fn check_time(table: &Table<'_>, t_s: &[f64]) -> Result<(), ReadError> {
    let Some(row) = t_s
        .windows(2)
        .position(|pair| pair[1] - pair[0] < SHORTEST_S)
    else {
        return Ok(());
    };
    let (before, after) = (t_s[row], t_s[row + 1]);
    Err(ReadError::Trace {
        file: table.file.to_owned(),
        line: table.line_of_row(row + 1),
        problem: format!(
            "the time after {before} s is {after} s; it must increase on every row by a nanosecond or more (a column with too \
             few decimals repeats values)"
        ),
    })
}
