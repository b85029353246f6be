//! Reads lines of bounded length from a pipe, a port or a file. Without the bound, an input without
//! line breaks would fill the memory.

use std::io::{self, BufRead, Read};

/// Returns the lines of an input without their line breaks. A line that is longer than `most_bytes`
/// or is not UTF-8 is an error and ends the iteration.
///
/// ```
/// let lines: Vec<_> = htex_base::files::bounded_lines(&b"1 2\r\n3 4\n12345678"[..], 5).collect();
/// assert_eq!(lines[1].as_ref().ok().map(String::as_str), Some("3 4"));
/// assert!(lines.len() == 3 && lines[2].is_err());
/// ```
pub fn bounded_lines<R: BufRead>(
    input: R,
    most_bytes: usize,
) -> impl Iterator<Item = io::Result<String>> {
    Lines { input, most_bytes, has_ended: false }
}

struct Lines<R> {
    input: R,
    most_bytes: usize,
    has_ended: bool,
}

impl<R: BufRead> Iterator for Lines<R> {
    type Item = io::Result<String>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.has_ended {
            return None;
        }
        let line = self.line();
        self.has_ended = !matches!(line, Some(Ok(_)));
        line
    }
}

impl<R: BufRead> Lines<R> {
    fn line(&mut self) -> Option<io::Result<String>> {
        let mut bytes = Vec::new();
        // The limit includes the line break, which has up to two bytes.
        let most = self.most_bytes as u64 + 2;
        match self.input.by_ref().take(most).read_until(b'\n', &mut bytes) {
            Ok(0) => return None,
            Ok(_) => {}
            Err(error) => return Some(Err(error)),
        }
        if bytes.pop_if(|last| *last == b'\n').is_some() {
            bytes.pop_if(|last| *last == b'\r');
        }
        if bytes.len() > self.most_bytes {
            let words = format!("a line has more than {} bytes", self.most_bytes);
            return Some(Err(io::Error::new(io::ErrorKind::InvalidData, words)));
        }
        let text = String::from_utf8(bytes);
        Some(text.map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error)))
    }
}
