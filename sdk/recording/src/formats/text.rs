//! Opening of files with a size limit, and numbered lines of text.

use std::fs::File;
use std::io::{Read, Take};
use std::path::Path;

use crate::ReadError;

/// The largest file that is read, bytes. The numbers kept of it are limited by [`crate::MOST_VALUES`].
pub(crate) const MAX_BYTES: u64 = 4 << 30;
/// The longest line, bytes; a row of forces has a few tens.
const MAX_LINE: usize = 64 << 10;

/// Returns the file's name without its directory.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

/// Opens a file with a size limit.
pub(crate) fn open(path: &Path) -> Result<Take<File>, ReadError> {
    let io = |source| ReadError::Io {
        file: file_name(path),
        source,
    };
    let file = File::open(path).map_err(io)?;
    let bytes = file.metadata().map_err(io)?.len();
    if bytes > MAX_BYTES {
        return Err(ReadError::TooLarge {
            file: file_name(path),
            bytes,
            limit: MAX_BYTES,
        });
    }
    // The size of a pipe or a growing file is not known in advance.
    Ok(file.take(MAX_BYTES))
}

/// Removes a byte order mark.
pub(crate) fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// Returns the bytes, which follow `before` lines, as text; refuses NUL and invalid UTF-8.
pub(crate) fn checked<'a>(
    file: &str,
    bytes: &'a [u8],
    before: usize,
) -> Result<&'a str, ReadError> {
    let refuse = |position: usize, what| {
        let line = before
            + 1
            + bytes[..position]
                .iter()
                .filter(|byte| **byte == b'\n')
                .count();
        ReadError::NotText {
            file: file.to_owned(),
            line,
            what,
        }
    };
    if bytes.contains(&0) {
        let position = bytes.iter().position(|byte| *byte == 0).unwrap_or(0);
        return Err(refuse(position, "a NUL byte"));
    }
    std::str::from_utf8(bytes)
        .map_err(|error| refuse(error.valid_up_to(), "a byte sequence that is not UTF-8"))
}

/// The lines that hold cells, without blank lines and `#` comments.
#[derive(Debug, Clone)]
pub(crate) struct Lines<'a> {
    file: &'a str,
    rest: &'a str,
    /// Number of the last returned or skipped line, from 1.
    pub(crate) number: usize,
    /// The last skipped comment, without its `#`.
    pub(crate) comment: Option<&'a str>,
    /// Whether a comment contains "simulated".
    pub(crate) simulated: bool,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(file: &'a str, text: &'a str) -> Self {
        Self::behind(file, text, 0, false)
    }

    /// Lines of a text that follows others, which may have contained "simulated".
    pub(crate) fn behind(file: &'a str, text: &'a str, number: usize, simulated: bool) -> Self {
        Self {
            file,
            rest: text,
            number,
            comment: None,
            simulated,
        }
    }

    /// Returns the next line with cells, without its line end; `None` at the end of the file.
    pub(crate) fn next_row(&mut self) -> Result<Option<&'a str>, ReadError> {
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

    /// Skips the next line if `parse` can read it. `parse` is given the remaining text and
    /// returns what follows the line, from the line feed on.
    pub(crate) fn pass_line(&mut self, parse: impl FnOnce(&[u8]) -> Option<&[u8]>) -> bool {
        let Some(left) = parse(self.rest.as_bytes()) else {
            return false;
        };
        let length = self.rest.len() - left.len();
        if length > MAX_LINE {
            return false;
        }
        self.rest = self.rest.get(length + 1..).unwrap_or_default();
        self.number += 1;
        true
    }

    fn take_line(&mut self) -> Result<&'a str, ReadError> {
        let (line, rest) = self.rest.split_once('\n').unwrap_or((self.rest, ""));
        self.rest = rest;
        self.number += 1;
        if line.len() > MAX_LINE {
            return Err(ReadError::LongLine {
                file: self.file.to_owned(),
                line: self.number,
                bytes: line.len(),
                limit: MAX_LINE,
            });
        }
        Ok(line.strip_suffix('\r').unwrap_or(line))
    }
}
