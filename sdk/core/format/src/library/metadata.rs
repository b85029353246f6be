//! The metadata of a library, such as its version, description and authors.

use htex_base::finding::steers;
use serde::{Deserialize, Deserializer, Serialize};

use crate::library::wire::TEXT_BYTES;

/// Largest size of a library's metadata as JSON, bytes. With metadata of this size, the root page
/// of a large library still ends within the first 16 KiB of the file.
pub(crate) const METADATA_BYTES: usize = 8 << 10;

/// The metadata of a library, such as its version, description and authors. Everything may be
/// absent.
///
/// ```
/// use htex_format::library::LibraryMetadata;
/// let metadata = LibraryMetadata { version: Some("1.2".to_owned()), ..LibraryMetadata::default() };
/// assert!(metadata.check().is_ok());
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(default)]
pub struct LibraryMetadata {
    /// Version of the library, such as `1.2.0`.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "text")]
    pub version: Option<String>,
    /// What the library contains, in words. May have several lines.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "text")]
    pub description: Option<String>,
    /// Who made the library.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub authors: Vec<String>,
    /// Address of a page about the library.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "text")]
    pub homepage: Option<String>,
    /// Where the recordings or the recipe of the library are, such as the address of a repository.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "text")]
    pub source: Option<String>,
    /// What changed since earlier versions, or the address of a page that describes the changes.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "text")]
    pub changelog: Option<String>,
    /// Date of this version: `YYYY-MM-DD`.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "text")]
    pub date: Option<String>,
}

impl LibraryMetadata {
    /// Names of the entries.
    pub const NAMES: [&str; 7] =
        ["version", "description", "authors", "homepage", "source", "changelog", "date"];

    /// Returns whether all entries are absent.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Sets an entry by its name. An empty text removes the entry. Several authors are separated by
    /// `;`.
    ///
    /// # Errors
    /// Returns an error if there is no such entry.
    pub fn set(&mut self, name: &str, text: &str) -> Result<(), String> {
        let value = Some(text.to_owned()).filter(|text| !text.is_empty());
        match name {
            "version" => self.version = value,
            "description" => self.description = value,
            "authors" => {
                let authors = text.split(';').map(str::trim).filter(|author| !author.is_empty());
                self.authors = authors.map(str::to_owned).collect();
            }
            "homepage" => self.homepage = value,
            "source" => self.source = value,
            "changelog" => self.changelog = value,
            "date" => self.date = value,
            _ => {
                let names = Self::NAMES.join(", ");
                return Err(format!("a library has no entry {name}; there are {names}"));
            }
        }
        Ok(())
    }

    /// Checks that the entries contain no control characters and no invisible characters, and that
    /// each entry except the description and the changelog is one line.
    ///
    /// # Errors
    /// Returns an error if an entry breaks a rule. The text names the entry.
    pub fn check(&self) -> Result<(), String> {
        let lines = [
            ("version", &self.version),
            ("homepage", &self.homepage),
            ("source", &self.source),
            ("date", &self.date),
        ];
        let lines = lines.iter().filter_map(|(name, text)| Some((*name, text.as_deref()?)));
        for (name, text) in lines.chain(self.authors.iter().map(|text| ("authors", &text[..]))) {
            if text.len() > TEXT_BYTES {
                let bytes = text.len();
                return Err(format!("{name} has {bytes} bytes and the most is 255; shorten it"));
            }
            check_characters(name, text, false)?;
        }
        for (name, text) in [("description", &self.description), ("changelog", &self.changelog)] {
            check_characters(name, text.as_deref().unwrap_or_default(), true)?;
        }
        if self.date.as_deref().is_some_and(|date| !is_date(date)) {
            return Err("date is no date; write it as 2026-05-31".to_owned());
        }
        let bytes = serde_json::to_string(self).map_or(0, |json| json.len());
        if bytes > METADATA_BYTES {
            return Err(format!(
                "all entries together have {bytes} bytes and the most is {METADATA_BYTES}; shorten the description, or give the changelog as an address"
            ));
        }
        Ok(())
    }
}

/// Reads a text. `null` is none.
fn text<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<String>, D::Error> {
    String::deserialize(deserializer).map(Some)
}

fn check_characters(name: &str, text: &str, may_have_lines: bool) -> Result<(), String> {
    match text.chars().find(|c| steers(*c) && !(may_have_lines && *c == '\n')) {
        Some(c) => Err(format!(
            "{name} contains {c:?}; leave out control characters and invisible characters"
        )),
        None => Ok(()),
    }
}

/// Returns whether a text is a date of the Gregorian calendar as `YYYY-MM-DD`.
fn is_date(text: &str) -> bool {
    let bytes = text.as_bytes();
    let has_form = bytes.len() == 10
        && bytes.iter().enumerate().all(|(i, byte)| match i {
            4 | 7 => *byte == b'-',
            _ => byte.is_ascii_digit(),
        });
    let number = |range: std::ops::Range<usize>| text.get(range).and_then(|t| t.parse().ok());
    let (Some(year), Some(month), Some(day)) = (number(0..4), number(5..7), number(8..10)) else {
        return false;
    };
    let year: u32 = year;
    let is_multiple = |of| year.is_multiple_of(of);
    let is_leap = is_multiple(4) && (!is_multiple(100) || is_multiple(400));
    let days = match month {
        1u32 | 3 | 5 | 7 | 8 | 10 | 12 => 31,
        4 | 6 | 9 | 11 => 30,
        2 if is_leap => 29,
        2 => 28,
        _ => 0,
    };
    has_form && (1..=days).contains(&day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_checked() {
        let with = |name: &str, text: &str| {
            let mut metadata = LibraryMetadata::default();
            metadata.set(name, text).map(|()| metadata)
        };
        for (name, text) in [
            ("version", "2.0"),
            ("description", "Two\nlines"),
            ("authors", "Ann; Bo"),
            ("date", "2024-02-29"),
        ] {
            assert_eq!(with(name, text).unwrap().check(), Ok(()), "{name}");
        }
        assert_eq!(with("authors", "Ann; Bo").unwrap().authors, ["Ann", "Bo"]);
        assert!(with("date", "").unwrap().is_empty());
        for (name, text) in [
            ("version", "2\n"),
            ("homepage", "a\u{202e}b"),
            ("description", "a\u{0}"),
            ("date", "2026-02-29"),
            ("date", "2026-13-01"),
            ("date", "+026-01-01"),
            ("source", &"x".repeat(256)),
            ("description", &"x".repeat(9000)),
        ] {
            let problem = with(name, text).unwrap().check().unwrap_err();
            assert!(problem.contains(name) || text.len() > 999, "{problem}");
        }
        assert!(with("licence", "CC0-1.0").unwrap_err().contains("version, description"));
    }
}
