//! Preview of a file: the roles that a reader would assign to its columns. A program can show this
//! preview before it reads the file, so that the user can correct the roles.

use std::path::Path;

use crate::columns::map::Role;
use crate::columns::names::base_unit;
use crate::columns::select::{Selection, Values, select};
use crate::error::{Fault, ReadError};
use crate::formats;
use crate::input::{InputFile, file_name};
use crate::options::ReadOptions;
use crate::sheet::{Layout, Sheet};
use htex_format::Quantity;

/// Number of rows whose numbers are shown.
const ROWS: usize = 5;
/// Number of columns of a text file whose numbers are shown.
const MOST_READ: usize = 64;
/// Number of bytes at the start of a text file in which the preview looks for the first rows.
const FIRST_BYTES: usize = 64 << 10;

/// The columns of a file, with the role of each.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Preview {
    pub columns: Vec<PreviewColumn>,
    /// The sample rate that the file states, hertz. `None` if the rate has to be computed from a
    /// time column.
    pub rate_hz: Option<f64>,
    /// The roles as a column map ([`crate::ColumnMap`]), which the user may correct. Empty if no
    /// column has a role.
    pub map: String,
    /// The reason why the file cannot be read as a recording with these options; `None` if the file
    /// can be read.
    pub problem: Option<String>,
}

/// A column of a file.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PreviewColumn {
    /// The column's name. A column without a name is called by its number, such as `#3`.
    pub name: String,
    /// The role that the reader assigns to the column; `None` if the reader skips the column.
    pub role: Option<Role>,
    /// Factor that converts the column's numbers to the unit of the role. The factor is 1 if the
    /// column only occurs in an expression of the column map.
    pub scale: f64,
    /// Unit of the role; empty if there is no role.
    pub unit: &'static str,
    /// The column's first numbers, as they are in the file.
    pub first: Vec<f64>,
}

/// Returns the role that a reader would assign to each column of a file. `bytes` is the content of
/// the file. `path` supplies only the file's name and is not opened.
///
/// ```
/// use htex_recording::{ReadOptions, Role, preview};
/// let csv = "t_s,fx_n,extra\n0,0.1,7\n0.001,0.2,7\n";
/// let found = preview("felt.csv".as_ref(), csv.as_bytes(), &ReadOptions::default())?;
/// let roles: Vec<_> = found.columns.iter().map(|column| column.role).collect();
/// assert_eq!(roles, [Some(Role::Time), Some(Role::LateralX), None]);
/// assert_eq!(found.columns[1].first, [0.1, 0.2]);
/// assert_eq!(found.map, "time=#1:1,lateral_x=#2:1");
/// # Ok::<(), htex_recording::ReadError>(())
/// ```
///
/// # Errors
/// Returns an error if the file has no columns of numbers at all, or an option does not apply. A
/// column without a clear role is not an error: [`Preview::problem`] reports it.
pub fn preview(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Preview, ReadError> {
    let previewed = || {
        options.check()?;
        let sheet = formats::open(InputFile::bytes(path, bytes)?, options)?;
        let bytes = match sheet.layout() {
            Layout::Text => beginning(bytes),
            Layout::Channels { .. } | Layout::Named => bytes,
        };
        let first =
            first_numbers(&*sheet, || formats::open(InputFile::bytes(path, bytes)?, options));
        Ok(of_sheet(&*sheet, first, options))
    };
    previewed().map_err(|fault: Fault| fault.in_file(&file_name(path)))
}

/// Returns the first numbers of each column, or no numbers for a column of words. A sheet can be
/// read only once, so it is opened anew for each reading.
fn first_numbers<'a>(
    sheet: &dyn Sheet,
    open: impl Fn() -> Result<Box<dyn Sheet + 'a>, Fault>,
) -> Vec<Vec<f64>> {
    let read = |wanted: &[usize]| {
        let numbers = open().and_then(|mut sheet| sheet.numbers(wanted));
        let columns = numbers.unwrap_or_default().columns.into_iter();
        columns.map(|numbers| numbers.into_iter().take(ROWS).collect())
    };
    let all: Vec<usize> = (0..sheet.columns().width()).collect();
    match sheet.layout() {
        Layout::Text => {
            let one = |column: &usize| read(&[*column]).next().unwrap_or_default();
            all.iter().take(MOST_READ).map(one).collect()
        }
        Layout::Channels { .. } | Layout::Named => read(&all).collect(),
    }
}

/// Returns the whole lines at the beginning of a text.
fn beginning(text: &[u8]) -> &[u8] {
    let Some(first) = text.get(..FIRST_BYTES) else {
        return text;
    };
    match first.iter().rposition(|byte| *byte == b'\n') {
        Some(end) => &first[..=end],
        None => text,
    }
}

fn of_sheet(sheet: &dyn Sheet, first: Vec<Vec<f64>>, options: &ReadOptions) -> Preview {
    let (width, quantity) = (sheet.columns().width(), options.quantity);
    let mut first = first.into_iter();
    let mut columns: Vec<PreviewColumn> = (0..width)
        .map(|column| PreviewColumn {
            name: sheet.columns().name(column),
            role: None,
            scale: 1.0,
            unit: "",
            first: first.next().unwrap_or_default(),
        })
        .collect();
    let assigned = match (sheet.layout(), &options.map) {
        (Layout::Channels { .. }, None) => by_order(&mut columns, options),
        (_, map) => select(sheet.columns(), map.as_ref(), quantity)
            .map(|selection| by_name(&selection, &mut columns, quantity))
            .map_err(|problem| problem.to_string()),
    };
    let all: Vec<usize> = (0..width).collect();
    Preview {
        map: map_of(&columns),
        columns,
        rate_hz: sheet.rate_hz(&all).ok().flatten(),
        problem: assigned.err(),
    }
}

impl PreviewColumn {
    fn assign_role(&mut self, role: Role, scale: f64, quantity: Quantity) {
        self.role = Some(role);
        self.scale = scale;
        self.unit = base_unit(role, quantity);
    }
}

/// Assigns channels without names.
fn by_order(columns: &mut [PreviewColumn], options: &ReadOptions) -> Result<(), String> {
    use Role::{Lateral, LateralX, LateralY, Normal, Signal, SignalX, SignalY, SignalZ};
    let roles: &[Role] = match (options.quantity, columns.len()) {
        (Quantity::NormalForce, 1) => &[Normal],
        (Quantity::LateralForce, 1) => &[Lateral],
        (Quantity::LateralForce, 2 | 3) => &[LateralX, LateralY, Normal],
        (Quantity::Acceleration | Quantity::Velocity | Quantity::Displacement, 1) => &[Signal],
        (Quantity::Acceleration | Quantity::Velocity | Quantity::Displacement, 2 | 3) => {
            &[SignalX, SignalY, SignalZ]
        }
        (quantity, channels) => {
            return Err(format!(
                "{channels} channels of a {}; map the channels of the recording, as in lateral=#1:SCALE",
                quantity.words()
            ));
        }
    };
    let scale = options.scale.unwrap_or(1.0);
    for (column, role) in columns.iter_mut().zip(roles) {
        column.assign_role(*role, scale, options.quantity);
    }
    Ok(())
}

/// Assigns the columns that a map or their names select. For values computed from several columns,
/// the first of these columns gets the role.
fn by_name(selection: &Selection, columns: &mut [PreviewColumn], quantity: Quantity) {
    for chosen in &selection.chosen {
        let scale = match chosen.values {
            Values::Column(_) => chosen.scale,
            Values::Formula { .. } => 1.0,
        };
        let first = chosen.columns().first().copied().unwrap_or_default();
        if let Some(column) = columns.get_mut(first) {
            column.assign_role(chosen.role, scale, quantity);
        }
    }
}

/// Writes the roles as a column map. Columns are given by number, since a name may occur twice.
fn map_of(columns: &[PreviewColumn]) -> String {
    let entries = columns.iter().enumerate().filter_map(|(at, column)| {
        let role = column.role?;
        Some(format!("{role}=#{}:{}", at + 1, column.scale))
    });
    entries.collect::<Vec<_>>().join(",")
}
