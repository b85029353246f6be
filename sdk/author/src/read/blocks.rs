//! A file of any length, text a block of whole lines at a time: memory that is used again costs less than memory
//! as large as the file.

use std::io::{BufReader, Cursor, Read};

use super::ReadError;
use super::room::Room;
use super::text::{Lines, checked, without_mark};

/// Bytes of a block; longer than any line may be.
const BLOCK: usize = 256 << 10;

/// What a reader gives, cut behind line ends.
pub(crate) struct Blocks<'a> {
    /// Its name, for messages.
    pub(crate) file: &'a str,
    /// For the numbers that are kept of it.
    pub(crate) room: Room,
    source: Box<dyn Read + 'a>,
    buffer: Vec<u8>,
    /// Of the buffer: what was handed out, and what is filled.
    taken: usize,
    filled: usize,
    ended: bool,
}

impl<'a> Blocks<'a> {
    pub(crate) fn new(file: &'a str, source: impl Read + 'a, room: Room) -> Self {
        Self {
            file,
            room,
            source: Box::new(source),
            buffer: vec![0; BLOCK],
            taken: 0,
            filled: 0,
            ended: false,
        }
    }

    /// The first bytes of what is left; all of them, where they are fewer than a block.
    pub(crate) fn front(&mut self) -> Result<&[u8], ReadError> {
        self.buffer.copy_within(self.taken..self.filled, 0);
        (self.taken, self.filled) = (0, self.filled - self.taken);
        while !self.ended && self.filled < self.buffer.len() {
            let read = match self.source.read(&mut self.buffer[self.filled..]) {
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
                read => read.map_err(|source| self.failed(source))?,
            };
            self.filled += read;
            self.ended = read == 0;
        }
        Ok(&self.buffer[..self.filled])
    }

    /// All that is left, as bytes.
    pub(crate) fn rest(mut self) -> Result<impl Read + 'a, ReadError> {
        self.front()?;
        self.buffer.truncate(self.filled);
        Ok(BufReader::new(Cursor::new(self.buffer).chain(self.source)))
    }

    /// The next lines, behind `before` others; `None` at the end. A line that is longer than a block comes in
    /// pieces, the first of which is too long.
    pub(crate) fn next(&mut self, before: usize) -> Result<Option<&str>, ReadError> {
        self.front()?;
        let filled = &self.buffer[..self.filled];
        let line_end = filled.iter().rposition(|byte| *byte == b'\n');
        self.taken = match line_end {
            _ if self.ended => self.filled,
            Some(last) => last + 1,
            None => whole_characters(filled),
        };
        let block = checked(self.file, &self.buffer[..self.taken], before)?;
        Ok((!block.is_empty()).then_some(block))
    }

    /// The first lines, without a byte order mark: as many as it takes to have two rows, if there are.
    pub(crate) fn head(&mut self) -> Result<String, ReadError> {
        let (mut head, mut rows, mut before) = (String::new(), 0, 0);
        while rows < 2 {
            let file = self.file;
            let Some(block) = self.next(before)? else {
                break;
            };
            let block = if before == 0 {
                without_mark(block)
            } else {
                block
            };
            head.push_str(block);
            let mut lines = Lines::behind(file, block, before, false);
            // A line that is too long is told by whoever reads it.
            while rows < 2 && !matches!(lines.next_row(), Ok(None)) {
                rows += 1;
            }
            before = lines.number;
        }
        Ok(head)
    }

    /// Whether a row is left, behind `before` lines.
    pub(crate) fn has_row(&mut self, mut before: usize) -> Result<bool, ReadError> {
        let file = self.file;
        while let Some(block) = self.next(before)? {
            let mut lines = Lines::behind(file, block, before, false);
            if !matches!(lines.next_row(), Ok(None)) {
                return Ok(true);
            }
            before = lines.number;
        }
        Ok(false)
    }

    fn failed(&self, source: std::io::Error) -> ReadError {
        ReadError::Io {
            file: self.file.to_owned(),
            source,
        }
    }
}

/// Length of the front of some bytes without a character that is cut off.
fn whole_characters(bytes: &[u8]) -> usize {
    match std::str::from_utf8(bytes) {
        Err(error) if error.error_len().is_none() && error.valid_up_to() > 0 => error.valid_up_to(),
        _ => bytes.len(),
    }
}
