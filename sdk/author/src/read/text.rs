//! Files of bounded size, and the lines of a text with their numbers.

use std::fs::File;
use std::io::{Read, Take};
use std::path::Path;

use super::ReadError;

/// The largest file that is read, bytes. What is kept of it is bounded by [`super::MOST_VALUES`].
pub(crate) const MAX_BYTES: u64 = 4 << 30;
/// The longest line, bytes; a row of forces has some tens.
const MAX_LINE: usize = 64 << 10;

/// The file's name without its directory.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

/// A file of bounded size.
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
    // A pipe or a growing file tells no size before it ends.
    Ok(file.take(MAX_BYTES))
}

/// Without a byte order mark.
pub(crate) fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// The bytes as text, behind `before` lines; refuses NUL and what is not UTF-8.
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

/// The lines that hold cells: blank lines and `#` comments are passed over.
#[derive(Debug, Clone)]
pub(crate) struct Lines<'a> {
    file: &'a str,
    rest: &'a str,
    /// Number of the last line handed out or passed over, from 1.
    pub(crate) number: usize,
    /// The last comment passed over, without its `#`.
    pub(crate) comment: Option<&'a str>,
    /// Whether a comment said "simulated".
    pub(crate) simulated: bool,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(file: &'a str, text: &'a str) -> Self {
        Self::behind(file, text, 0, false)
    }

    /// Of a text behind some lines, which may have said "simulated".
    pub(crate) fn behind(file: &'a str, text: &'a str, number: usize, simulated: bool) -> Self {
        Self {
            file,
            rest: text,
            number,
            comment: None,
            simulated,
        }
    }

    /// The next line with cells, without its line end; `None` at the end of the file.
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

    /// Passes over the next line if `parse` can read it; `parse` is given the text from there on, and
    /// gives back what stands behind the line, from the line feed on.
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
