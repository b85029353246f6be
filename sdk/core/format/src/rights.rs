//! Licence and author of a texture, as text. Programs add this text to files that they make from
//! the texture.
//!
//! The text has two lines in the form of REUSE (<https://reuse.software>). Programs can find these
//! lines in any comment or description. Every export of an asset uses this module, so that all
//! files contain the same words.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use htex_base::files::{OwnFolder, read_regular};

use crate::{Manifest, replace_file};

/// The tag before the licence.
const LICENSE: &str = "SPDX-License-Identifier: ";
/// The tag before the author.
const AUTHOR: &str = "SPDX-FileCopyrightText: ";
/// Characters that would end a comment or a string that contains the text.
const ENDS: [&str; 3] = ["*/", "-->", "\""];
/// Largest size of a `.license` file that is read, bytes.
const MOST_FILE_BYTES: u64 = 1 << 16;
/// Largest length of a licence or an author that is written or read, bytes.
const MOST_BYTES: usize = 1000;

/// The licence and the author of a texture.
///
/// ```
/// use htex_format::Rights;
/// let rights = Rights::new(Some("CC-BY-4.0"), Some("Ada"));
/// assert_eq!(rights.to_text(), "SPDX-FileCopyrightText: Ada\nSPDX-License-Identifier: CC-BY-4.0\n");
/// assert_eq!(Rights::from_text("a hum. SPDX-License-Identifier: MIT OR Apache-2.0"), Rights::new(Some("MIT OR Apache-2.0"), None));
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Rights {
    /// SPDX licence expression.
    pub license: Option<String>,
    /// The person or group that made the texture.
    pub author: Option<String>,
}

impl Rights {
    /// Creates rights from a licence and an author. An empty text counts as missing.
    #[must_use]
    pub fn new(license: Option<&str>, author: Option<&str>) -> Self {
        Self { license: license.and_then(line), author: author.and_then(line) }
    }

    /// Returns the rights that an asset states.
    #[must_use]
    pub fn from_manifest(manifest: &Manifest) -> Self {
        Self::new(manifest.license.as_deref(), manifest.author.as_deref())
    }

    /// Combines the rights of several assets that play together. The result joins all licences with
    /// AND and names all authors.
    ///
    /// ```
    /// use htex_format::Rights;
    /// let both = ["MIT OR Apache-2.0", "CC0-1.0"].map(|license| Rights::new(Some(license), None));
    /// assert_eq!(Rights::of_all(both).license.as_deref(), Some("(MIT OR Apache-2.0) AND CC0-1.0"));
    /// ```
    #[must_use]
    pub fn of_all(all: impl IntoIterator<Item = Self>) -> Self {
        let (mut licenses, mut authors) = (Vec::new(), Vec::new());
        for one in all {
            licenses.extend(one.license.filter(|own| !licenses.contains(own)));
            authors.extend(one.author.filter(|own| !authors.contains(own)));
        }
        // In an SPDX expression, AND takes precedence over OR.
        if licenses.len() > 1 {
            for license in licenses.iter_mut().filter(|own| has_or(own)) {
                *license = format!("({license})");
            }
        }
        Self::new(Some(&licenses.join(" AND ")), Some(&authors.join(", ")))
    }

    /// Returns whether both the licence and the author are missing.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.license.is_none() && self.author.is_none()
    }

    /// Returns the line for the author and then the line for the licence, each with a line end. The
    /// text is empty if both are missing.
    #[must_use]
    pub fn to_text(&self) -> String {
        let author = self.author.iter().map(|own| format!("{AUTHOR}{own}\n"));
        let license = self.license.iter().map(|own| format!("{LICENSE}{own}\n"));
        author.chain(license).collect()
    }

    /// Returns the description, followed by the lines of [`Self::to_text`].
    #[must_use]
    pub fn described(&self, description: &str) -> String {
        let text = self.to_text();
        match (description.is_empty(), text.is_empty()) {
            (_, true) => description.to_owned(),
            (true, _) => text.trim_end().to_owned(),
            (false, false) => format!("{description}\n{}", text.trim_end()),
        }
    }

    /// Returns the lines of [`Self::to_text`] as comments of a programming language. `before` is
    /// written at the start of each line, e.g. `// `.
    #[must_use]
    pub fn commented(&self, before: &str) -> String {
        let text = self.to_text();
        text.lines().map(|line| format!("{before}{line}\n")).collect()
    }

    /// Reads the first licence and the first author in a text.
    #[must_use]
    pub fn from_text(text: &str) -> Self {
        Self::new(after(LICENSE, text), after(AUTHOR, text))
    }

    /// Returns these rights. A missing licence or a missing author is taken from `other`.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self { license: self.license.or(other.license), author: self.author.or(other.author) }
    }

    /// Returns the rights as a chunk of a WAV file: a `LIST` chunk of type `INFO`, with the licence
    /// as copyright (`ICOP`) and the author as artist (`IART`). The result is empty if both are
    /// missing.
    #[must_use]
    pub fn riff(&self) -> Vec<u8> {
        let mut list = b"INFO".to_vec();
        let author = self.author.as_ref().map(|own| (b"IART", own.clone()));
        let license = self.license.as_ref().map(|own| (b"ICOP", format!("{LICENSE}{own}")));
        for (id, text) in author.into_iter().chain(license) {
            list.extend(chunk(id, &[text.as_bytes(), &[0]].concat()));
        }
        if self.is_empty() { Vec::new() } else { chunk(b"LIST", &list) }
    }

    /// Appends the chunk of [`Self::riff`] to a WAV file. The samples do not change. Leaves the
    /// file unchanged if the chunk would make it larger than 4 GiB.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written.
    pub fn add_to_wav(&self, wav: &mut (impl Write + Seek)) -> io::Result<()> {
        let chunk = self.riff();
        if chunk.is_empty() {
            return Ok(());
        }
        let end = wav.seek(SeekFrom::End(0))?;
        // Chunks of RIFF begin at even bytes, but some writers of WAV files do not pad the last
        // chunk.
        let pad = end % 2;
        let Ok(riff) = u32::try_from(end + pad + chunk.len() as u64 - 8) else {
            return Ok(());
        };
        wav.write_all(&[0][..pad as usize])?;
        wav.write_all(&chunk)?;
        wav.seek(SeekFrom::Start(4))?;
        wav.write_all(&riff.to_le_bytes())?;
        wav.seek(SeekFrom::End(0)).map(drop)
    }

    /// Adds the rights to a finished file: appends a chunk to a WAV file, and writes a
    /// [`license_file`] next to any other file. An existing file is replaced only when the new file
    /// is complete. Does nothing if `path` is a device or a pipe.
    ///
    /// # Errors
    /// Returns an error if a file cannot be read or written.
    pub fn add_to_file(&self, path: &Path) -> io::Result<()> {
        if self.is_empty() || !std::fs::metadata(path)?.is_file() {
            return Ok(());
        }
        if !is_wav(path) {
            // The user did not choose this name, so if the folder contains a link of this name, the
            // program does not follow it.
            let (folder, name) = OwnFolder::of_file(&license_file(path))?;
            let text = self.to_text();
            return folder.replace(&name, |file| file.write_all(text.as_bytes()));
        }
        #[allow(clippy::disallowed_methods, reason = "the user named this file")]
        replace_file(path, |file| {
            io::copy(&mut File::open(path)?, file)?;
            self.add_to_wav(file)
        })
    }

    /// Returns the path of the licence file that [`Self::add_to_file`] writes next to `path`.
    /// Returns `None` if there are no rights to write, or if `path` is a WAV file.
    #[must_use]
    pub fn beside(&self, path: &Path) -> Option<PathBuf> {
        (!self.is_empty() && !is_wav(path)).then(|| license_file(path))
    }
}

/// Returns the path of the licence file that belongs to the file at `path`: `path` followed by
/// `.license`. Files that have no place for a licence need such a file.
#[must_use]
pub fn license_file(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".license");
    name.into()
}

/// Reads the licence file next to `path`. Returns `None` if there is no such file.
///
/// # Errors
/// Returns an error if the licence file cannot be read, is not a regular file or is too long.
pub fn read_license_file(path: &Path) -> io::Result<Option<String>> {
    match read_regular(&license_file(path), MOST_FILE_BYTES) {
        Ok(bytes) => Ok(Some(String::from_utf8_lossy(&bytes).into_owned())),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

fn is_wav(path: &Path) -> bool {
    let extension = path.extension();
    extension.is_some_and(|extension| extension.eq_ignore_ascii_case("wav"))
}

/// Returns whether an SPDX expression contains the operator OR, in upper or lower case.
fn has_or(license: &str) -> bool {
    let mut words = license.split(|c: char| !(c.is_ascii_alphanumeric() || "-.:".contains(c)));
    words.any(|word| word == "OR" || word == "or")
}

/// Returns the text after a tag, up to the end of the line or of the comment.
fn after<'a>(tag: &str, text: &'a str) -> Option<&'a str> {
    let rest = &text[text.find(tag)? + tag.len()..];
    let rest = rest.lines().next()?;
    let end = ENDS.iter().filter_map(|end| rest.find(end)).min();
    rest.get(..end.unwrap_or(rest.len()))
}

/// Turns words into a single line without control characters and without [`ENDS`]. Returns `None`
/// if the result would be empty.
fn line(words: &str) -> Option<String> {
    let mut plain: String = words.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    for end in ENDS {
        plain = plain.replace(end, " ");
    }
    // The text is shortened by whole characters, because the limit counts bytes and may lie inside
    // a character.
    while plain.len() > MOST_BYTES {
        plain.pop();
    }
    let plain = plain.trim();
    (!plain.is_empty()).then(|| plain.to_owned())
}

fn chunk(id: &[u8; 4], bytes: &[u8]) -> Vec<u8> {
    let length = (bytes.len() as u32).to_le_bytes();
    let pad = &[0][..bytes.len() % 2];
    [&id[..], &length, bytes, pad].concat()
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    #[test]
    fn alternatives_stay_together_in_either_case() {
        for either in ["MIT OR Apache-2.0", "MIT or Apache-2.0", "(MIT)or(Apache-2.0)"] {
            let both = [either, "CC0-1.0"].map(|license| Rights::new(Some(license), None));
            let expected = format!("({either}) AND CC0-1.0");
            assert_eq!(Rights::of_all(both).license, Some(expected));
        }
        let both = ["LicenseRef-or", "CC0-1.0"].map(|license| Rights::new(Some(license), None));
        assert_eq!(Rights::of_all(both).license.as_deref(), Some("LicenseRef-or AND CC0-1.0"));
    }

    #[test]
    fn no_rights_leave_a_file_of_any_length() {
        for bytes in [&b""[..], b"RIFF"] {
            let mut wav = Cursor::new(bytes.to_vec());
            assert!(Rights::default().add_to_wav(&mut wav).is_ok());
            assert_eq!(wav.into_inner(), bytes);
        }
    }
}
