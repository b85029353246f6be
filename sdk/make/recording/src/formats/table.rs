//! Parsing rows of numbers in delimited text.
//!
//! This module splits the cells itself and does not use the crate `csv`, for two reasons. Rows are
//! plain numbers, so one pass can split and parse them in half the time that the crate takes. In
//! addition, error messages need the line numbers that an editor shows.

use crate::error::{Fault, Place, ReadProblem, cell};
use crate::formats::cells::{Delimiter, split};
use crate::formats::number::{parse_number, parse_plain_row};
use crate::formats::text::Lines;
use crate::sheet::Columns;
use crate::value_limit::ValueLimit;

/// Longest part of a cell that is shown in a message, characters.
const MAX_SHOWN: usize = 40;

/// The layout of a delimited file, and the line numbers of its rows.
#[derive(Debug)]
pub(crate) struct Table {
    pub(crate) columns: Columns,
    delimiter: Delimiter,
    /// Pairs of a row and its line number, for rows that are not on the line right after the
    /// previous row. The first row is always listed.
    runs: Vec<(usize, usize)>,
}

impl Table {
    pub(crate) fn new(columns: Columns, delimiter: Delimiter) -> Self {
        Self { columns, delimiter, runs: Vec::new() }
    }

    /// Reads the rows of a block, up to the limit on numbers.
    pub(crate) fn block(
        &mut self,
        lines: &mut Lines<'_>,
        wanted: &[usize],
        columns: &mut [Vec<f64>],
        limit: ValueLimit,
    ) -> Result<(), Fault> {
        let mut row = vec![0.0; self.columns.width()];
        let mut count = columns.first().map_or(0, Vec::len);
        while self.next_numbers(lines, wanted, &mut row)? {
            // A run takes as much memory as two numbers.
            let values = (count + 1) * wanted.len() + 2 * self.runs.len();
            limit.check(values as u64)?;
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

    /// Returns the line (counted from 1) of a row of numbers (counted from 0).
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
    ) -> Result<bool, Fault> {
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

    /// Reads the wanted cells of a row with cells that are not plain numbers; `lines` is already
    /// past that row.
    fn read_row(
        &self,
        line: &str,
        lines: &Lines<'_>,
        wanted: &[usize],
        row: &mut [f64],
    ) -> Result<(), Fault> {
        let mut cells = Vec::with_capacity(row.len());
        split(line, self.delimiter, &mut cells);
        if cells.len() != row.len() {
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

    fn wrong_width(&self, got: usize, mut lines: Lines<'_>) -> Fault {
        let (line, expected) = (lines.number, self.columns.width());
        let problem = if got < expected && matches!(lines.next_row(), Ok(None)) {
            ReadProblem::CutOff { expected, got }
        } else {
            ReadProblem::Ragged { expected, got }
        };
        problem.at_place(Place::Line(line))
    }

    fn bad_cell(&self, line: usize, column: usize, text: &str) -> Fault {
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
        cell(Place::Line(line), &self.columns.name(column), problem)
    }
}
