//! Delimited text files as named columns of numbers.
//!
//! The cells are split here instead of by the `csv` crate: rows are plain numbers, one pass splits and parses
//! them in less time than that crate needs to split them, and messages need line numbers as in an editor.

use crate::ReadError;
use crate::formats::blocks::Blocks;
use crate::formats::number::{parse_number, parse_plain_row};
use crate::formats::text::Lines;
use crate::sheet::{Columns, Numbers, Place};
use crate::value_limit::ValueLimit;

/// Longest part of a cell in a message, characters.
const MAX_SHOWN: usize = 40;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Delimiter {
    Byte(u8),
    Whitespace,
}

/// The layout of a delimited file: its column names and the start of its rows.
#[derive(Debug)]
pub(crate) struct Table<'a> {
    /// File name for messages.
    pub(crate) file: &'a str,
    /// Column names as written, trimmed; `None` without a header row.
    pub(crate) header: Option<Vec<&'a str>>,
    /// Number of columns, at least 1.
    pub(crate) width: usize,
    delimiter: Delimiter,
    /// Lines from the first row of numbers on.
    rows: Lines<'a>,
    /// Rows whose line is not the one after the previous row, with their lines; the first row is always listed.
    runs: Vec<(usize, usize)>,
}

impl<'a> Table<'a> {
    /// Detects delimiter and header.
    pub(crate) fn new(file: &'a str, text: &'a str) -> Result<Self, ReadError> {
        let mut lines = Lines::new(file, text);
        let before = lines.clone();
        let Some(first) = lines.next_row()? else {
            return Err(ReadError::Empty {
                file: file.to_owned(),
            });
        };
        let comment = lines.comment;
        let after = lines.clone();
        let delimiter = sniff(first, lines.next_row()?.unwrap_or(first));
        let mut cells = Vec::new();
        split(first, delimiter, &mut cells);
        let width = cells.len();
        let is_header = cells
            .iter()
            .any(|cell| parse_number(cell).is_none() && !cell.is_empty());
        let (header, rows) = if is_header {
            (Some(cells), after)
        } else {
            (commented_header(comment, delimiter, width), before)
        };
        Ok(Self {
            file,
            header,
            width,
            delimiter,
            rows,
            runs: Vec::new(),
        })
    }

    /// Returns the column's name, or `#` and its number when it has none.
    pub(crate) fn name(&self, column: usize) -> String {
        match self.header.as_ref().and_then(|names| names.get(column)) {
            Some(name) if !name.is_empty() => htex_format::plain(name).into_owned(),
            _ => format!("#{}", column + 1),
        }
    }

    /// Returns all column names, for messages.
    pub(crate) fn names(&self) -> String {
        self.columns().list()
    }

    /// Returns the columns.
    pub(crate) fn columns(&self) -> Columns {
        match &self.header {
            Some(names) => {
                Columns::new(self.file, names.iter().map(|name| (*name).to_owned()), None)
            }
            None => Columns::unnamed(self.file, self.width),
        }
    }

    /// Reads the wanted columns (counted from 0, each below `width`), from the text that the table was created from and
    /// the blocks that follow it; the other cells are only counted.
    pub(crate) fn numbers(
        &mut self,
        wanted: &[usize],
        behind: &mut Blocks<'_>,
    ) -> Result<Numbers, ReadError> {
        let mut columns = vec![Vec::new(); wanted.len()];
        let limit = behind.limit;
        let mut lines = self.rows.clone();
        let mut read = self.block(&mut lines, wanted, &mut columns, limit);
        let (mut number, mut simulated) = (lines.number, lines.simulated);
        loop {
            read.or_else(|error| Err(in_the_middle(error, behind)?))?;
            let Some(text) = behind.next(number)? else {
                break;
            };
            let mut lines = Lines::behind(self.file, text, number, simulated);
            read = self.block(&mut lines, wanted, &mut columns, limit);
            (number, simulated) = (lines.number, lines.simulated);
        }
        let rows = columns.first().map_or(0, Vec::len);
        if rows < 2 {
            return Err(ReadError::TooFewRows {
                file: self.file.to_owned(),
                rows,
            });
        }
        Ok(Numbers {
            columns,
            simulated,
            ..Numbers::default()
        })
    }

    /// Reads the rows of a block, up to the limit of numbers.
    fn block(
        &mut self,
        lines: &mut Lines<'_>,
        wanted: &[usize],
        columns: &mut [Vec<f64>],
        limit: ValueLimit,
    ) -> Result<(), ReadError> {
        let mut row = vec![0.0; self.width];
        let mut count = columns.first().map_or(0, Vec::len);
        while self.next_numbers(lines, wanted, &mut row)? {
            // A run takes the memory of two numbers.
            let values = (count + 1) * wanted.len() + 2 * self.runs.len();
            limit.check(self.file, values as u64)?;
            for (values, &column) in columns.iter_mut().zip(wanted) {
                values.push(row[column]);
            }
            if self.line_of_row(count) != lines.number {
                self.runs.push((count, lines.number));
            }
            count += 1;
        }
        Ok(())
    }

    /// Returns the line, from 1, of a row of numbers, from 0.
    pub(crate) fn line_of_row(&self, row: usize) -> usize {
        let mut runs = self.runs.iter().rev();
        let run = runs.find(|(first, _)| *first <= row);
        run.map_or(0, |(first, line)| line + (row - first))
    }

    /// Reads the wanted cells of the next row, if there is one.
    fn next_numbers(
        &self,
        lines: &mut Lines<'_>,
        wanted: &[usize],
        row: &mut [f64],
    ) -> Result<bool, ReadError> {
        if let Delimiter::Byte(delimiter) = self.delimiter
            && lines.pass_line(|text| parse_plain_row(text, delimiter, row))
        {
            return Ok(true);
        }
        match lines.next_row()? {
            Some(line) => self.read_row(line, lines, wanted, row).map(|()| true),
            None => Ok(false),
        }
    }

    /// Reads the wanted cells of a row that is not all plain numbers; `lines` is already past it.
    fn read_row(
        &self,
        line: &str,
        lines: &Lines<'_>,
        wanted: &[usize],
        row: &mut [f64],
    ) -> Result<(), ReadError> {
        let mut cells = Vec::with_capacity(self.width);
        split(line, self.delimiter, &mut cells);
        if cells.len() != self.width {
            return Err(self.wrong_width(cells.len(), lines.clone()));
        }
        for &column in wanted {
            row[column] = match parse_number(cells[column]) {
                Some(value) if value.is_finite() => value,
                _ => return Err(self.bad_cell(lines.number, column, cells[column])),
            };
        }
        Ok(())
    }

    fn wrong_width(&self, got: usize, mut lines: Lines<'_>) -> ReadError {
        let (file, line, expected) = (self.file.to_owned(), lines.number, self.width);
        if got < expected && matches!(lines.next_row(), Ok(None)) {
            ReadError::CutOff {
                file,
                line,
                expected,
                got,
            }
        } else {
            ReadError::Ragged {
                file,
                line,
                expected,
                got,
            }
        }
    }

    fn bad_cell(&self, line: usize, column: usize, text: &str) -> ReadError {
        let shown: String = text.chars().take(MAX_SHOWN).collect();
        let dots = if shown.len() < text.len() { "…" } else { "" };
        let problem = match parse_number(text) {
            _ if text.is_empty() => "the cell is empty".to_owned(),
            Some(_) => format!("{shown:?} is not finite"),
            None if text.contains(',') => {
                format!("{shown:?}{dots} is not a number (a decimal comma?)")
            }
            None => format!("{shown:?}{dots} is not a number"),
        };
        ReadError::Cell {
            file: self.file.to_owned(),
            place: Place::Line(line),
            column: self.name(column),
            problem,
        }
    }
}

/// Converts the error of a truncated row if other rows follow the block.
fn in_the_middle(error: ReadError, behind: &mut Blocks<'_>) -> Result<ReadError, ReadError> {
    match error {
        ReadError::CutOff {
            file,
            line,
            expected,
            got,
        } if behind.has_row(line)? => Ok(ReadError::Ragged {
            file,
            line,
            expected,
            got,
        }),
        other => Ok(other),
    }
}

/// Returns the header that `numpy.savetxt` writes: the comment before the numbers, with the same number of cells.
fn commented_header(
    comment: Option<&str>,
    delimiter: Delimiter,
    width: usize,
) -> Option<Vec<&str>> {
    let mut cells = Vec::new();
    split(comment?, delimiter, &mut cells);
    (width > 1 && cells.len() == width).then_some(cells)
}

/// Returns the delimiter that gives the first two rows the same number of cells, and the most of them.
fn sniff(first: &str, second: &str) -> Delimiter {
    let count = |line, delimiter| {
        let mut cells = Vec::new();
        split(line, delimiter, &mut cells);
        cells.len()
    };
    let bytes = [b'\t', b';', b','].map(Delimiter::Byte);
    let agreed = |delimiter: &Delimiter| {
        let cells = count(first, *delimiter);
        cells > 1 && cells == count(second, *delimiter)
    };
    let most = |delimiter: &Delimiter| count(first, *delimiter);
    if let Some(delimiter) = bytes.into_iter().filter(agreed).max_by_key(most) {
        return delimiter;
    }
    if agreed(&Delimiter::Whitespace) {
        return Delimiter::Whitespace;
    }
    bytes
        .into_iter()
        .max_by_key(most)
        .unwrap_or(Delimiter::Byte(b','))
}

fn split<'a>(line: &'a str, delimiter: Delimiter, cells: &mut Vec<&'a str>) {
    match delimiter {
        Delimiter::Whitespace => cells.extend(line.split_ascii_whitespace()),
        Delimiter::Byte(delimiter) => split_bytes(line, delimiter, cells),
    }
}

/// Splits at a one-byte delimiter outside double quotes and removes outer spaces and quotes.
fn split_bytes<'a>(line: &'a str, delimiter: u8, cells: &mut Vec<&'a str>) {
    let mut start = 0;
    let mut quoted = false;
    for (at, byte) in line.bytes().enumerate() {
        if byte == delimiter && !quoted {
            cells.push(bare(&line[start..at]));
            start = at + 1;
        } else if byte == b'"' {
            quoted = !quoted;
        }
    }
    cells.push(bare(&line[start..]));
}

fn bare(cell: &str) -> &str {
    let cell = cell.trim_ascii();
    match cell
        .strip_prefix('"')
        .and_then(|cell| cell.strip_suffix('"'))
    {
        Some(inner) => inner.trim_ascii(),
        None => cell,
    }
}
