//! Calibration of six-axis force sensors.

use std::path::Path;

use htex_base::files::FileError;
use serde::Deserialize;

use crate::error::LabError;

/// Axes of a six-axis sensor.
pub(crate) const AXES: usize = 6;
/// Names and units of the axes.
const NAMES: [(&str, &str); AXES] =
    [("fx", "N"), ("fy", "N"), ("fz", "N"), ("tx", "N m"), ("ty", "N m"), ("tz", "N m")];
/// Longest file, bytes.
const MOST_BYTES: u64 = 1 << 16;

/// The calibration matrix of a six-axis force sensor. The matrix, multiplied by the voltages of the
/// sensor's six channels, gives forces (N) and torques (N m).
///
/// ```
/// # use htex_lab::record::Calibration;
/// # use std::path::Path;
/// let text = "2,0,0,0,0,0\n0,2,0,0,0,0\n0,0,-3,0,0,0\n0,0,0,1,0,0\n0,0,0,0,1,0\n0,0,0,0,0,1\n";
/// let calibration = Calibration::parse(Path::new("nano17.csv"), text)?;
/// assert_eq!(calibration.forces([1.0, 0.5, -0.1, 0.0, 0.0, 0.0])[..3], [2.0, 1.0, 0.30000000000000004]);
/// # Ok::<(), htex_lab::LabError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    rows: [[f64; AXES]; AXES],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    matrix: Vec<Vec<f64>>,
}

impl Calibration {
    /// Reads a calibration file: CSV with six lines of six numbers (`#` starts a comment), or TOML
    /// with `matrix = [[…], …]`.
    ///
    /// # Errors
    /// Returns [`LabError::File`] if the file cannot be read, or does not contain a matrix of full
    /// rank.
    pub fn read(path: &Path) -> Result<Self, LabError> {
        in_calibration(path, text_of(path).and_then(|text| Self::from_text(path, &text)))
    }

    /// Parses the text of a calibration file. The extension of `path` determines the format, and
    /// error messages contain `path`.
    ///
    /// # Errors
    /// Returns the errors of [`Self::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, LabError> {
        in_calibration(path, Self::from_text(path, text))
    }

    fn from_text(path: &Path, text: &str) -> Result<Self, Problem> {
        let is_toml = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        let matrix = if is_toml {
            htex_base::files::toml::from_str::<File>(text)?.matrix
        } else {
            lines(text)?
        };
        let width = matrix.iter().position(|row| row.len() != AXES);
        if let (true, Some(row)) = (matrix.len() == AXES, width) {
            let (number, len) = (row + 1, matrix[row].len());
            return Err(format!("row {number} has {len} numbers, not {AXES}").into());
        }
        let mut rows = [[0.0; AXES]; AXES];
        if matrix.len() != AXES {
            return Err(format!("{} rows of numbers, not {AXES}", matrix.len()).into());
        }
        for (to, from) in rows.iter_mut().flatten().zip(matrix.iter().flatten()) {
            *to = *from;
        }
        if let Some(at) = rows.iter().flatten().position(|v| !v.is_finite()) {
            let (row, number) = (at / AXES + 1, at % AXES + 1);
            return Err(format!("row {row}, number {number} is not finite").into());
        }
        if rank(rows) < AXES {
            return Err("the matrix is singular: an axis is missing, or two are the same; copy it again from the sensor's file".into());
        }
        Ok(Self { rows })
    }

    /// Returns forces and torques from the voltages of the six channels.
    #[must_use]
    pub fn forces(&self, volts: [f64; AXES]) -> [f64; AXES] {
        self.rows.map(|row| row.iter().zip(volts).map(|(m, v)| m * v).sum())
    }

    /// Returns the names and units of the axes. With several sensors, the names end with the
    /// sensor's number, counted from 1: `fx1`.
    pub(crate) fn names(sensor: Option<usize>) -> [(String, String); AXES] {
        let number = sensor.map(|n| n.to_string()).unwrap_or_default();
        NAMES.map(|(name, unit)| (format!("{name}{number}"), unit.to_owned()))
    }

    /// Returns all numbers of the matrix, row by row.
    pub(crate) fn numbers(&self) -> Vec<f64> {
        self.rows.iter().flatten().copied().collect()
    }
}

fn text_of(path: &Path) -> Result<String, Problem> {
    let length = std::fs::metadata(path)?.len();
    if length > MOST_BYTES {
        return Err(format!("{length} bytes are no matrix of six by six numbers").into());
    }
    Ok(std::fs::read_to_string(path)?)
}

fn lines(text: &str) -> Result<Vec<Vec<f64>>, String> {
    let mut rows = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let cells = line.split([',', ';', '\t', ' ']).filter(|cell| !cell.is_empty());
        let number = |cell: &str| cell.trim().parse::<f64>().ok();
        let row = cells.map(|cell| {
            number(cell).ok_or_else(|| format!("line {}: {cell:?} is not a number", index + 1))
        });
        rows.push(row.collect::<Result<_, _>>()?);
    }
    Ok(rows)
}

/// Computes the rank by elimination with pivots. A pivot below 1e-12 times the largest number
/// counts as zero.
fn rank(mut rows: [[f64; AXES]; AXES]) -> usize {
    let largest = rows.iter().flatten().fold(0.0_f64, |a, v| a.max(v.abs()));
    for column in 0..AXES {
        let pivot =
            (column..AXES).max_by(|a, b| rows[*a][column].abs().total_cmp(&rows[*b][column].abs()));
        let pivot = pivot.unwrap_or(column);
        if rows[pivot][column].abs() <= 1e-12 * largest {
            return column;
        }
        rows.swap(column, pivot);
        let top = rows[column];
        for row in &mut rows[column + 1..] {
            let factor = row[column] / top[column];
            for (value, above) in row.iter_mut().zip(top) {
                *value -= factor * above;
            }
        }
    }
    AXES
}

/// What is wrong with a calibration.
type Problem = Box<dyn std::error::Error>;

/// Adds the file's name and a description of the format to an error.
fn in_calibration<T>(path: &Path, result: Result<T, Problem>) -> Result<T, LabError> {
    let advice = "a calibration is six rows of six numbers, N and N m for a volt of each channel";
    let result = result.map_err(|problem| format!("{problem}; {advice}"));
    Ok(result.map_err(FileError::in_file(path))?)
}
