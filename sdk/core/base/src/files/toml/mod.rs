//! Reads TOML. All programs of htex read TOML files with this module: recipes, studies,
//! calibrations and the profiles of actuators.
//!
//! The parser of the crate `toml` is recursive. The parser itself limits the nesting to 80 levels,
//! but counts the levels wrongly in two cases. After a syntax error, a closing bracket without an
//! opening bracket lowers the count. For example, 7,200 lines of `motion = { const']` overflowed a
//! stack of 8 MiB. The parser also counts the levels of each dotted key separately, so it accepts
//! 80 nested tables with 80 names each, which make 6,400 levels.
//!
//! Therefore this module counts the brackets and dots of a text before it parses the text
//! (`nesting.rs`). A text with more than [`MOST_LEVELS`] levels is an error. No other module may
//! call the crate `toml`: `clippy.toml` forbids the calls, and no other crate of htex depends on
//! `toml`.
#![allow(clippy::disallowed_methods)] // The one place that may call the crate `toml`.

mod nesting;

use std::fmt;

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, de};

pub use nesting::MOST_LEVELS;
use nesting::check_nesting;

/// An error in a TOML text, with its line and column. The error's text has the form `line 3, column
/// 5: …`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TomlError {
    /// The line, counted from 1.
    pub line: usize,
    /// The column in characters, counted from 1.
    pub column: usize,
    /// The problem, in one line.
    pub message: String,
}

impl fmt::Display for TomlError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { line, column, .. } = self;
        write!(f, "line {line}, column {column}: {}", self.message)
    }
}

impl std::error::Error for TomlError {}

impl TomlError {
    /// Creates an error at a byte of the text.
    fn at_byte(text: &str, byte: usize, message: String) -> Self {
        let (line, column) = place(text, byte);
        Self { line, column, message }
    }

    fn from_parser(text: &str, error: &de::Error) -> Self {
        let byte = error.span().map_or(0, |span| span.start);
        Self::at_byte(text, byte, error.message().replace('\n', "; "))
    }
}

/// Reads a TOML text into a value. The call needs less than 256 KiB of stack for any text.
///
/// ```
/// # use std::collections::BTreeMap;
/// let read = htex_base::files::toml::from_str::<BTreeMap<String, f64>>;
/// assert_eq!(read("gain = 2.5"), Ok(BTreeMap::from([("gain".to_owned(), 2.5)])));
/// let error = read("gain = 2.5\nlimit = { volts = 3").unwrap_err().to_string();
/// assert_eq!(error, "line 2, column 20: unclosed inline table, expected `}`");
/// ```
///
/// # Errors
/// Returns an error if the text is not TOML, contains a value of another type, or is nested deeper
/// than [`MOST_LEVELS`].
pub fn from_str<T: DeserializeOwned>(text: &str) -> Result<T, TomlError> {
    check_nesting(text)?;
    toml::from_str(text).map_err(|error| TomlError::from_parser(text, &error))
}

/// Returns the line of each key, counted from 1, or `None` if the text has no such key. A key is
/// given by its path: the names of the tables and the indices of the arrays that contain it, and
/// then its own name.
pub fn lines_of_keys<'p>(
    text: &str,
    paths: impl IntoIterator<Item = &'p [String]>,
) -> Vec<Option<usize>> {
    let table = check_nesting(text).ok().and_then(|()| DeTable::parse(text).ok());
    let line = |path| {
        let at = place_of_key(table.as_ref()?.get_ref(), path)?;
        Some(place(text, at).0)
    };
    paths.into_iter().map(line).collect()
}

/// Returns the byte at which a key begins.
fn place_of_key(table: &DeTable<'_>, path: &[String]) -> Option<usize> {
    let (key, folders) = path.split_last()?;
    let mut inside = table;
    let mut items: &[Spanned<DeValue<'_>>] = &[];
    for folder in folders {
        let value = match folder.parse::<usize>() {
            Ok(index) if index < items.len() => items.get(index),
            _ => inside.get(&folder[..]),
        };
        match value?.get_ref() {
            DeValue::Table(table) => (inside, items) = (table, &[]),
            DeValue::Array(array) => items = array,
            _ => return None,
        }
    }
    let (key, _) = inside.get_key_value(&key[..])?;
    Some(key.span().start)
}

/// Returns the line and column of a byte, counted from 1.
fn place(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    (line, before[start..].chars().count() + 1)
}

#[cfg(test)]
mod tests;
