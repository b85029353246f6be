//! Lines of text, with their numbers.

use crate::error::{Fault, Place, ReadProblem};

/// The longest line that is read, bytes; a row of forces has a few tens.
const MAX_LINE: usize = 64 << 10;

/// Removes a byte order mark.
pub(crate) fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// Returns bytes as text and refuses NUL and invalid UTF-8. `before` is the number of lines before
/// them.
pub(crate) fn checked(bytes: &[u8], before: usize) -> Result<&str, Fault> {
    let refuse = |position: usize, what| {
        let line = before + 1 + bytes[..position].iter().filter(|byte| **byte == b'\n').count();
        ReadProblem::NotText { what }.at_place(Place::Line(line))
    };
    if bytes.contains(&0) {
        let position = bytes.iter().position(|byte| *byte == 0).unwrap_or(0);
        return Err(refuse(position, "a NUL byte"));
    }
    std::str::from_utf8(bytes)
        .map_err(|error| refuse(error.valid_up_to(), "a byte sequence that is not UTF-8"))
}

/// The lines that contain cells; skips blank lines and `#` comments.
#[derive(Debug, Clone)]
pub(crate) struct Lines<'a> {
    /// The text after the last returned or skipped line.
    pub(crate) rest: &'a str,
    /// Number of the last returned or skipped line, counted from 1.
    pub(crate) number: usize,
    /// The last skipped comment, without its `#`.
    pub(crate) comment: Option<&'a str>,
    /// Whether a comment contains "simulated".
    pub(crate) simulated: bool,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(text: &'a str) -> Self {
        Self::behind(text, 0, false)
    }

    /// Continues with the text after `number` lines, which may have contained "simulated".
    pub(crate) fn behind(text: &'a str, number: usize, simulated: bool) -> Self {
        Self { rest: text, number, comment: None, simulated }
    }

    /// Returns the next line that contains cells, without its line end; `None` at the end of the
    /// file.
    pub(crate) fn next_row(&mut self) -> Result<Option<&'a str>, Fault> {
        while !self.rest.is_empty() {
            let line = self.take_line()?;
            if let Some(comment) = line.trim_start().strip_prefix('#') {
                self.simulated |= comment.to_ascii_lowercase().contains("simulated");
                self.comment = Some(comment.trim());
            } else if !line.trim_ascii().is_empty() {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }

    /// Skips the next line if `parse` can read it. `parse` gets the remaining text and returns the
    /// text after the line, from the line feed on.
    pub(crate) fn pass_line(&mut self, parse: impl FnOnce(&[u8]) -> Option<&[u8]>) -> bool {
        let Some(left) = parse(self.rest.as_bytes()) else {
            return false;
        };
        let length = self.rest.len() - left.len();
        // The slower parser reads the same line again and reports its length.
        if length > MAX_LINE {
            return false;
        }
        self.rest = self.rest.get(length + 1..).unwrap_or_default();
        self.number += 1;
        true
    }

    fn take_line(&mut self) -> Result<&'a str, Fault> {
        let (line, rest) = self.rest.split_once('\n').unwrap_or((self.rest, ""));
        self.rest = rest;
        self.number += 1;
        if line.len() > MAX_LINE {
            let problem = ReadProblem::LongLine { bytes: line.len(), limit: MAX_LINE };
            return Err(problem.at_place(Place::Line(self.number)));
        }
        Ok(line.strip_suffix('\r').unwrap_or(line))
    }
}
