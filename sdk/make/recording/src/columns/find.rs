//! Finding the columns that a map names.

use htex_format::Quantity;

use crate::columns::expression::Expression;
use crate::columns::map::Role;
use crate::columns::names::{Unit, base_unit};
use crate::columns::token::ColumnRef;
use crate::error::ReadProblem;
use crate::sheet::Columns;

/// Returns the column if the expression is a single column, or if the file has exactly one column
/// with the expression's text as its name.
pub(crate) fn whole_column(
    columns: &Columns,
    values: &Expression,
) -> Result<Option<usize>, ReadProblem> {
    if let Some(column) = values.column() {
        return find(columns, column).map(Some);
    }
    match &columns.by_name(values.text())[..] {
        [column] => Ok(Some(*column)),
        _ => Ok(None),
    }
}

pub(crate) fn find(columns: &Columns, column: &ColumnRef) -> Result<usize, ReadProblem> {
    let found: Vec<usize> = match column {
        ColumnRef::Number(number) => {
            (0..columns.width()).filter(|column| column + 1 == *number).collect()
        }
        ColumnRef::Name(name) => columns.by_name(name),
    };
    match found.as_slice() {
        [column] => Ok(*column),
        [] => Err(columns.refuse(format!("the map's column {column} does not exist"))),
        [one, other, ..] => {
            let (one, other) = (columns.name(*one), columns.name(*other));
            let advice =
                if one == other { "give the number, as in #2" } else { "give the whole name" };
            Err(columns.refuse(format!(
                "several columns have the name {column}, such as {one} and {other}; {advice}"
            )))
        }
    }
}

pub(crate) fn no_scale(name: &str, role: Role, unit: &Unit, quantity: Quantity) -> String {
    let target = base_unit(role, quantity);
    let unit = match unit {
        Unit::Volts => "volts".into(),
        Unit::Unknown(unit) => htex_base::finding::plain(unit),
        Unit::Scale(_) | Unit::Unsaid => "no unit".into(),
    };
    format!(
        "Column {name:?} is in {unit}, not {target}; map it with its scale to {target}: {role}={name}:SCALE"
    )
}

pub(crate) fn two_columns(columns: &Columns, role: Role, a: usize, b: usize) -> ReadProblem {
    let (a, b) = (columns.name(a), columns.name(b));
    columns
        .refuse(format!("{a:?} and {b:?} both match {role}; map one of them, as in {role}=COLUMN"))
}
