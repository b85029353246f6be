//! Reads files in blocks of whole lines. One small buffer is reused for all blocks. Reusing it
//! takes less memory and time than a buffer as large as the file.

use std::io::Read;

use crate::error::Fault;
use crate::formats::text::{Lines, checked, without_mark};
use crate::value_limit::ValueLimit;

/// Size of a block, bytes; longer than any valid line.
const BLOCK: usize = 256 << 10;

/// A reader that splits its data at line ends.
pub(crate) struct Blocks<'a> {
    /// Limit on the numbers that are kept in memory.
    pub(crate) limit: ValueLimit,
    source: Box<dyn Read + 'a>,
    buffer: Vec<u8>,
    /// Number of bytes in the buffer that were already returned, and number of bytes filled.
    taken: usize,
    filled: usize,
    ended: bool,
}

impl<'a> Blocks<'a> {
    pub(crate) fn new(source: impl Read + 'a, limit: ValueLimit) -> Self {
        Self {
            limit,
            source: Box::new(source),
            buffer: vec![0; BLOCK],
            taken: 0,
            filled: 0,
            ended: false,
        }
    }

    /// Returns the first remaining bytes: a block, or everything if less than a block is left.
    pub(crate) fn front(&mut self) -> Result<&[u8], Fault> {
        self.buffer.copy_within(self.taken..self.filled, 0);
        (self.taken, self.filled) = (0, self.filled - self.taken);
        while !self.ended && self.filled < self.buffer.len() {
            let read = match self.source.read(&mut self.buffer[self.filled..]) {
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
                read => read?,
            };
            self.filled += read;
            self.ended = read == 0;
        }
        Ok(&self.buffer[..self.filled])
    }

    /// Returns the next lines; `before` is the number of lines before them. `None` at the end. A
    /// line longer than a block is returned in pieces; its first piece already exceeds the limit
    /// for a line.
    pub(crate) fn next(&mut self, before: usize) -> Result<Option<&str>, Fault> {
        self.front()?;
        let filled = &self.buffer[..self.filled];
        let line_end = filled.iter().rposition(|byte| *byte == b'\n');
        self.taken = match line_end {
            _ if self.ended => self.filled,
            Some(last) => last + 1,
            // A block may end inside a character, whose other bytes come with the next block.
            None => whole_characters(filled),
        };
        let block = checked(&self.buffer[..self.taken], before)?;
        Ok((!block.is_empty()).then_some(block))
    }

    /// Returns the first lines, without a byte order mark. If the file has at least two rows, these
    /// lines contain two rows.
    pub(crate) fn head(&mut self) -> Result<String, Fault> {
        let (mut head, mut rows, mut before) = (String::new(), 0, 0);
        while rows < 2 {
            let Some(block) = self.next(before)? else {
                break;
            };
            let block = if before == 0 { without_mark(block) } else { block };
            head.push_str(block);
            let mut lines = Lines::behind(block, before, false);
            // A line that is too long is reported later, when it is parsed.
            while rows < 2 && !matches!(lines.next_row(), Ok(None)) {
                rows += 1;
            }
            before = lines.number;
        }
        Ok(head)
    }

    /// Whether another row follows; `before` is the number of lines before it.
    pub(crate) fn has_row(&mut self, mut before: usize) -> Result<bool, Fault> {
        while let Some(block) = self.next(before)? {
            let mut lines = Lines::behind(block, before, false);
            if !matches!(lines.next_row(), Ok(None)) {
                return Ok(true);
            }
            before = lines.number;
        }
        Ok(false)
    }
}

/// Returns the length of the bytes up to the last complete character.
fn whole_characters(bytes: &[u8]) -> usize {
    match std::str::from_utf8(bytes) {
        Err(error) if error.error_len().is_none() && error.valid_up_to() > 0 => error.valid_up_to(),
        _ => bytes.len(),
    }
}
