//! A file of any format as named columns of numbers.

use crate::error::{Fault, Place, ReadProblem, cell};

/// The columns of a file, before their numbers are read.
#[derive(Debug, Clone, Default)]
pub(crate) struct Columns {
    /// Names in the order of the file; empty for a column without a name.
    names: Vec<String>,
    /// For each name, the byte at which its last part begins: `fx` in `/run1/fx`.
    parts: Vec<usize>,
    /// Whether the file names its columns.
    pub(crate) are_named: bool,
}

impl Columns {
    /// Makes columns from their names. The last part of a name follows the last `separator`, if the
    /// name has one.
    pub(crate) fn new(names: impl IntoIterator<Item = String>, separator: Option<char>) -> Self {
        let names: Vec<String> = names.into_iter().collect();
        let part = |name: &String| {
            let separator = separator.and_then(|c| name.rfind(c));
            separator.map_or(0, |at| at + 1)
        };
        Self { parts: names.iter().map(part).collect(), names, are_named: true }
    }

    /// Makes columns from names, each with the byte at which its last part begins.
    pub(crate) fn with_parts(names: Vec<(String, usize)>) -> Self {
        let (names, parts) = names.into_iter().unzip();
        Self { names, parts, are_named: true }
    }

    /// Makes columns that have numbers instead of names.
    pub(crate) fn unnamed(width: usize) -> Self {
        Self { are_named: false, ..Self::new(vec![String::new(); width], None) }
    }

    /// Returns the number of columns.
    pub(crate) fn width(&self) -> usize {
        self.names.len()
    }

    /// Returns the column's whole name. A column without a name is called by its number, such as
    /// `#3`.
    pub(crate) fn name(&self, column: usize) -> String {
        match self.names.get(column) {
            Some(name) if !name.is_empty() => htex_base::finding::plain(name).into_owned(),
            _ => format!("#{}", column + 1),
        }
    }

    /// Returns the last part of the column's name, which says what the column holds.
    pub(crate) fn last_part(&self, column: usize) -> &str {
        let name = self.names.get(column).map_or("", String::as_str);
        &name[self.parts.get(column).copied().unwrap_or(0)..]
    }

    /// Returns the name without its last part: the group of the column.
    pub(crate) fn group(&self, column: usize) -> &str {
        let name = self.names.get(column).map_or("", String::as_str);
        &name[..self.parts.get(column).copied().unwrap_or(0)]
    }

    /// Returns the columns with exactly this name. If there are none, returns columns with the name
    /// in another case, or else columns whose last part is this name.
    pub(crate) fn by_name(&self, name: &str) -> Vec<usize> {
        let all = 0..self.width();
        let exact = |column: &usize| self.names[*column] == name;
        let alike = |column: &usize| self.names[*column].eq_ignore_ascii_case(name);
        let part = |column: &usize| self.last_part(*column) == name;
        // In this order, so that an exact name stays unambiguous even if other columns have similar
        // names.
        let tests: [&dyn Fn(&usize) -> bool; 3] = [&exact, &alike, &part];
        let mut found = tests.map(|test| all.clone().filter(test).collect::<Vec<_>>()).into_iter();
        found.find(|columns| !columns.is_empty()).unwrap_or_default()
    }

    /// Returns the problem of columns whose roles are unclear.
    pub(crate) fn refuse(&self, problem: String) -> ReadProblem {
        ReadProblem::Columns { problem, columns: self.list() }
    }

    /// Returns all names, for messages.
    pub(crate) fn list(&self) -> String {
        self.list_of(&(0..self.width()).collect::<Vec<_>>())
    }

    /// Returns the names of some columns, for messages.
    pub(crate) fn list_of(&self, columns: &[usize]) -> String {
        const MANY: usize = 20;
        let mut names: Vec<_> =
            columns.iter().take(MANY).map(|column| self.name(*column)).collect();
        if columns.len() > MANY {
            names.push(format!("and {} more", columns.len() - MANY));
        }
        names.join(", ")
    }
}

/// The numbers of some columns of a file.
#[derive(Debug, Default)]
pub(crate) struct Numbers {
    /// One vector per wanted column.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Whether a comment contains "simulated".
    pub(crate) simulated: bool,
    /// What the reader observed, each as a full sentence.
    pub(crate) warnings: Vec<String>,
}

/// The kind of columns that a file has. It decides which options apply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Layout {
    /// Cells of text.
    Text,
    /// Channels without names, in a fixed order; integers are read as fractions of full scale.
    Channels { are_integers: bool },
    /// Columns with names.
    Named,
}

/// An opened file with its columns: the trait that every format implements.
pub(crate) trait Sheet {
    fn columns(&self) -> &Columns;

    fn layout(&self) -> Layout {
        Layout::Named
    }

    /// Returns the sample rate in hertz that the file states for the wanted columns, if it states
    /// one.
    fn rate_hz(&self, _wanted: &[usize]) -> Result<Option<f64>, Fault> {
        Ok(None)
    }

    /// Reads the wanted columns; each index must be below the width. The columns may differ in
    /// length and contain numbers that are not finite.
    fn numbers(&mut self, wanted: &[usize]) -> Result<Numbers, Fault>;

    /// Returns the place of a row; rows are counted from 0.
    fn place(&self, row: usize) -> Place {
        Place::Row(row + 1)
    }
}

/// Reads columns that must have equal lengths, at least two rows, and only finite numbers.
pub(crate) fn even_numbers(sheet: &mut dyn Sheet, wanted: &[usize]) -> Result<Numbers, Fault> {
    let numbers = sheet.numbers(wanted)?;
    let columns = sheet.columns();
    let mut lengths = wanted.iter().zip(numbers.columns.iter().map(Vec::len));
    let Some((first, rows)) = lengths.next() else {
        return Ok(numbers);
    };
    if let Some((other, got)) = lengths.find(|(_, length)| *length != rows) {
        let (first, other) = (columns.name(*first), columns.name(*other));
        let problem = ReadProblem::Lengths { first, rows, other, got };
        return Err(problem.into());
    }
    if rows < 2 {
        return Err(ReadProblem::TooFewRows { rows }.into());
    }
    for (column, values) in wanted.iter().zip(&numbers.columns) {
        if let Some(row) = values.iter().position(|value| !value.is_finite()) {
            let problem = if values[row].is_nan() {
                "it is not a number, or empty".to_owned()
            } else {
                format!("{} is not finite", values[row])
            };
            return Err(cell(sheet.place(row), &columns.name(*column), problem));
        }
    }
    Ok(numbers)
}
