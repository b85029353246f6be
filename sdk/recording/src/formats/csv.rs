//! CSV as columns.

use crate::formats::blocks::Blocks;
use crate::formats::table::Table;
use crate::sheet::{Columns, Numbers, Place, Sheet};
use crate::{ReadError, ReadOptions};

/// A CSV, read block by block.
pub(crate) struct Csv<'a, 'b> {
    table: Table<'a>,
    columns: Columns,
    blocks: Blocks<'b>,
}

impl<'a, 'b> Csv<'a, 'b> {
    /// Makes columns of a file that begins with the lines `head`, which have been read from `blocks`.
    pub(crate) fn new(
        file: &'a str,
        head: &'a str,
        blocks: Blocks<'b>,
        options: &ReadOptions,
    ) -> Result<Self, ReadError> {
        if options.scale.is_some() {
            return Err(ReadError::Option {
                file: file.to_owned(),
                option: "scale",
                problem: "a scale is for files of samples; scale a CSV's columns in the column map, as in lateral=COLUMN:SCALE"
                    .into(),
            });
        }
        let table = Table::new(file, head)?;
        Ok(Self {
            columns: table.columns(),
            table,
            blocks,
        })
    }
}

impl Sheet for Csv<'_, '_> {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn rate_hz(&self, _: &[usize]) -> Result<Option<f64>, ReadError> {
        Ok(None)
    }

    fn numbers(&mut self, wanted: &[usize]) -> Result<Numbers, ReadError> {
        self.table.numbers(wanted, &mut self.blocks)
    }

    fn place(&self, row: usize) -> Place {
        Place::Line(self.table.line_of_row(row))
    }
}
