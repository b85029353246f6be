//! Reads delimited text (CSV) into named columns of numbers.

use crate::error::{Fault, Place, ReadProblem};
use crate::formats::blocks::Blocks;
use crate::formats::cells::{Delimiter, sniff, split};
use crate::formats::number::parse_number;
use crate::formats::table::Table;
use crate::formats::text::Lines;
use crate::input::InputFile;
use crate::sheet::{Columns, Layout, Numbers, Sheet};
use crate::value_limit::ValueLimit;

/// A CSV, read block by block.
pub(crate) struct Csv<'a> {
    table: Table,
    /// The first lines, already read from the blocks.
    head: String,
    start: Start,
    blocks: Blocks<'a>,
}

/// Where the rows of numbers begin.
struct Start {
    byte: usize,
    /// Number of lines before the rows.
    line: usize,
    /// Whether a comment before the rows contains "simulated".
    simulated: bool,
}

impl<'a> Csv<'a> {
    /// Detects delimiter and header.
    pub(crate) fn open(opened: InputFile<'a>, limit: ValueLimit) -> Result<Self, Fault> {
        let mut blocks = Blocks::new(opened.stream(), limit);
        let head = blocks.head()?;
        let (table, start) = layout(&head)?;
        Ok(Self { table, head, start, blocks })
    }
}

/// Returns the layout of a file that begins with the lines `head`, and where its rows begin.
fn layout(head: &str) -> Result<(Table, Start), Fault> {
    let mut lines = Lines::new(head);
    let here = |lines: &Lines<'_>| Start {
        byte: head.len() - lines.rest.len(),
        line: lines.number,
        simulated: lines.simulated,
    };
    let before = here(&lines);
    let first = lines.next_row()?.ok_or(ReadProblem::Empty)?;
    let (comment, after) = (lines.comment, here(&lines));
    let delimiter = sniff(first, lines.next_row()?.unwrap_or(first));
    let mut cells = Vec::new();
    split(first, delimiter, &mut cells);
    let width = cells.len();
    let is_name = |cell: &&str| parse_number(cell).is_none() && !cell.is_empty();
    let (header, start) = if cells.iter().any(is_name) {
        (Some(cells), after)
    } else {
        // Without a line of names, the first line is already numbers and is read again.
        (commented_header(comment, delimiter, width), before)
    };
    let columns = match header {
        Some(names) => Columns::new(names.into_iter().map(str::to_owned), None),
        None => Columns::unnamed(width),
    };
    Ok((Table::new(columns, delimiter), start))
}

/// Returns the header that `numpy.savetxt` writes: the comment just before the numbers, if it has
/// the same number of cells.
fn commented_header(
    comment: Option<&str>,
    delimiter: Delimiter,
    width: usize,
) -> Option<Vec<&str>> {
    let mut cells = Vec::new();
    split(comment?, delimiter, &mut cells);
    (width > 1 && cells.len() == width).then_some(cells)
}

impl Sheet for Csv<'_> {
    fn columns(&self) -> &Columns {
        &self.table.columns
    }

    fn layout(&self) -> Layout {
        Layout::Text
    }

    /// The cells of unwanted columns are only counted.
    fn numbers(&mut self, wanted: &[usize]) -> Result<Numbers, Fault> {
        let (table, limit) = (&mut self.table, self.blocks.limit);
        let mut columns = vec![Vec::new(); wanted.len()];
        let rows = &self.head[self.start.byte..];
        let mut lines = Lines::behind(rows, self.start.line, self.start.simulated);
        let mut read = table.block(&mut lines, wanted, &mut columns, limit);
        let (mut number, mut simulated) = (lines.number, lines.simulated);
        loop {
            read.or_else(|fault| Err(in_the_middle(fault, &mut self.blocks)?))?;
            let Some(text) = self.blocks.next(number)? else {
                break;
            };
            let mut lines = Lines::behind(text, number, simulated);
            read = table.block(&mut lines, wanted, &mut columns, limit);
            (number, simulated) = (lines.number, lines.simulated);
        }
        let rows = columns.first().map_or(0, Vec::len);
        if rows < 2 {
            return Err(ReadProblem::TooFewRows { rows }.into());
        }
        Ok(Numbers { columns, simulated, ..Numbers::default() })
    }

    fn place(&self, row: usize) -> Place {
        Place::Line(self.table.line_of_row(row))
    }
}

/// Converts the fault of a short row. The fault says that the file is cut off. If other rows follow
/// the block, it becomes a fault of a row with a wrong number of cells.
fn in_the_middle(fault: Fault, behind: &mut Blocks<'_>) -> Result<Fault, Fault> {
    match fault {
        Fault {
            place: Some(Place::Line(line)),
            problem: ReadProblem::CutOff { expected, got },
        } if behind.has_row(line)? => {
            Ok(ReadProblem::Ragged { expected, got }.at_place(Place::Line(line)))
        }
        other => Ok(other),
    }
}
