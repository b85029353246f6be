//! The licence and the author of a texture as text, for files that are made of it: two lines of
//! REUSE (<https://reuse.software>), which are read out of any comment or description.
//!
//! Every way out of an asset takes its text from here, so that all carry the same words.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use htex_files::{OwnFolder, read_regular};

use crate::{Manifest, replace_file};

/// What precedes the licence.
const LICENSE: &str = "SPDX-License-Identifier: ";
/// What precedes the author.
const AUTHOR: &str = "SPDX-FileCopyrightText: ";
/// What ends a comment or a string in which the text may stand.
const ENDS: [&str; 3] = ["*/", "-->", "\""];
/// Most bytes of a file of rights that is read.
const MOST_FILE_BYTES: u64 = 1 << 16;
/// Most bytes of a licence or an author that are written or read.
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
    /// Who made it.
    pub author: Option<String>,
}

impl Rights {
    /// Rights of these words; an empty word counts as missing.
    #[must_use]
    pub fn new(license: Option<&str>, author: Option<&str>) -> Self {
        Self { license: license.and_then(line), author: author.and_then(line) }
    }

    /// The rights that an asset states.
    #[must_use]
    pub fn of(manifest: &Manifest) -> Self {
        Self::new(manifest.license.as_deref(), manifest.author.as_deref())
    }

    /// The rights of what several assets are played in: all licences apply, and all authors are
    /// named.
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
        if licenses.len() > 1 {
            for license in licenses.iter_mut().filter(|own| own.contains(" OR ")) {
                *license = format!("({license})");
            }
        }
        Self::new(Some(&licenses.join(" AND ")), Some(&authors.join(", ")))
    }

    /// Whether nothing is stated.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.license.is_none() && self.author.is_none()
    }

    /// Its lines: the author's, then the licence's, each with its end; empty if nothing is stated.
    #[must_use]
    pub fn to_text(&self) -> String {
        let author = self.author.iter().map(|own| format!("{AUTHOR}{own}\n"));
        let license = self.license.iter().map(|own| format!("{LICENSE}{own}\n"));
        author.chain(license).collect()
    }

    /// A description, followed by the lines.
    #[must_use]
    pub fn described(&self, description: &str) -> String {
        let text = self.to_text();
        match (description.is_empty(), text.is_empty()) {
            (_, true) => description.to_owned(),
            (true, _) => text.trim_end().to_owned(),
            (false, false) => format!("{description}\n{}", text.trim_end()),
        }
    }

    /// The lines as comments of a language, each after `before`.
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

    /// The words of this, completed by the words of another.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self { license: self.license.or(other.license), author: self.author.or(other.author) }
    }

    /// Its chunk of a WAV file: `LIST` of `INFO`, with the licence as copyright (`ICOP`) and the
    /// author as artist (`IART`); empty if nothing is stated.
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

    /// Adds the chunk to the end of a WAV file; the samples stay as they are. A file that would
    /// have more than 4 GiB stays as it is.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn add_to_wav(&self, wav: &mut (impl Write + Seek)) -> io::Result<()> {
        let chunk = self.riff();
        let end = wav.seek(SeekFrom::End(0))?;
        let pad = end % 2;
        let Ok(riff) = u32::try_from(end + pad + chunk.len() as u64 - 8) else {
            return Ok(());
        };
        if chunk.is_empty() {
            return Ok(());
        }
        wav.write_all(&[0][..pad as usize])?;
        wav.write_all(&chunk)?;
        wav.seek(SeekFrom::Start(4))?;
        wav.write_all(&riff.to_le_bytes())?;
        wav.seek(SeekFrom::End(0)).map(drop)
    }

    /// Adds the rights to a file that is written: the chunk to a WAV, else [`license_file`] beside
    /// it. The file is replaced when it is complete. A device or a pipe has none.
    ///
    /// # Errors
    /// When a file cannot be read or written.
    pub fn add_to_file(&self, path: &Path) -> io::Result<()> {
        if self.is_empty() || !std::fs::metadata(path)?.is_file() {
            return Ok(());
        }
        if !is_wav(path) {
            // The name is ours: no link in the folder is followed.
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

    /// The file that [`Self::add_to_file`] writes beside `path`, if it does.
    #[must_use]
    pub fn beside(&self, path: &Path) -> Option<PathBuf> {
        (!self.is_empty() && !is_wav(path)).then(|| license_file(path))
    }
}

/// The file of the rights of a file that has no place for them: its name with `.license` behind it.
#[must_use]
pub fn license_file(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".license");
    name.into()
}

/// Reads `FILE.license`, the rights beside a file; `None` if it is missing.
///
/// # Errors
/// When it cannot be read, is no regular file or too long.
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

/// The words after a tag, up to the end of the line or of what it stands in.
fn after<'a>(tag: &str, text: &'a str) -> Option<&'a str> {
    let rest = &text[text.find(tag)? + tag.len()..];
    let rest = rest.lines().next()?;
    let end = ENDS.iter().filter_map(|end| rest.find(end)).min();
    rest.get(..end.unwrap_or(rest.len()))
}

/// One line without control characters and without what would end a comment; `None` if nothing is
/// left.
fn line(words: &str) -> Option<String> {
    let mut plain: String = words.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    for end in ENDS {
        plain = plain.replace(end, " ");
    }
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
