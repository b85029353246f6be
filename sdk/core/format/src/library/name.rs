//! Rules for the names of textures. Each name is also a valid relative file path on every system.

use std::collections::BTreeSet;

use htex_base::finding::steers;
use unicase::UniCase;
use unicode_normalization::UnicodeNormalization;

use crate::library::wire::TEXT_BYTES;

/// File extension of a texture.
const ENDING: &str = ".htex";
/// Largest length of a part, bytes. With the suffix [`ENDING`], a part has at most 255 bytes, which
/// is the limit of file systems for a file name.
const PART_BYTES: usize = 255 - ENDING.len();
/// Device names of Windows. No file can have one of these names.
const DEVICES: [&str; 6] = ["CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$"];
/// Device names of Windows that end with a digit. Windows also treats a superscript 1, 2 or 3 as a
/// digit.
const NUMBERED_DEVICES: [&str; 2] = ["COM", "LPT"];

/// The reason why a text is not a valid name of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidName {
    #[error("it is empty; write a name such as `wood/oak`")]
    Empty,
    #[error("it has {0} bytes and the most is 255; shorten it")]
    TooLong(usize),
    /// The name contains a character that has a special meaning for file systems or terminals.
    #[error(
        "it contains {0:?}; leave out control characters, invisible characters, and \\ : * ? \" < > |"
    )]
    Character(char),
    /// One of the parts between the slashes of the name is empty, `.` or `..`.
    #[error("a part of it is empty, `.` or `..`; write the parts with one `/` between them")]
    Part,
    /// A part of the name is too long for a file name.
    #[error("a part of it has {0} bytes and the most is 250; shorten it")]
    LongPart(usize),
    /// A folder in the name ends in `.htex`, like the name of a texture's file.
    #[error("a part of it before a `/` ends in .htex, as a texture's file; rename it")]
    Folder,
    /// A part of the name ends in a space or a dot, which Windows would remove.
    #[error("a part of it ends in a space or a dot; remove it")]
    End,
    /// A part of the name is reserved for a Windows device, such as `CON`.
    #[error("a part of it is a device of Windows, such as CON or COM1; rename it")]
    Device,
}

/// Checks the name of a texture: up to 255 bytes of UTF-8 whose parts are separated by `/`, so that
/// every name is a relative file path.
///
/// # Errors
/// Returns an error if the name breaks a rule. The error says which rule.
///
/// ```
/// use htex_format::library::check_name;
/// assert!(check_name("wood/oak, sanded").is_ok());
/// assert!(check_name("../outside").is_err());
/// ```
pub fn check_name(name: &str) -> Result<(), InvalidName> {
    if name.is_empty() {
        return Err(InvalidName::Empty);
    }
    if name.len() > TEXT_BYTES {
        return Err(InvalidName::TooLong(name.len()));
    }
    if let Some(character) = name.chars().find(|c| is_refused(*c)) {
        return Err(InvalidName::Character(character));
    }
    name.split('/').try_for_each(check_part)?;
    let mut folders = name.split('/').rev().skip(1);
    let has_ending = |folder: &str| folder.to_ascii_lowercase().ends_with(ENDING);
    if folders.any(has_ending) { Err(InvalidName::Folder) } else { Ok(()) }
}

/// Returns a form of the name without differences in case and Unicode normalisation. Some systems
/// treat two names with the same form as the same file. Two names have the same form if, and only
/// if, they are a canonical caseless match (The Unicode Standard, definition D145).
fn of_one_file(name: &str) -> String {
    // For ASCII, case folding is the conversion to lower case, and no character decomposes.
    if name.is_ascii() {
        return name.to_ascii_lowercase();
    }
    let decomposed: String = name.nfd().collect();
    UniCase::unicode(decomposed).to_folded_case().nfd().collect()
}

/// Returns the first 16 bytes of the hash of [`of_one_file`]. A set of names stores only these
/// bytes, because a library may have millions of names.
pub(crate) fn file_key(name: &str) -> [u8; 16] {
    let mut start = [0; 16];
    let mut hasher = blake3::Hasher::new();
    hasher.update(of_one_file(name).as_bytes());
    hasher.finalize_xof().fill(&mut start);
    start
}

/// A set of texture names that denote different files on every operating system. The packer, the
/// validator and the unpacker use this set to find names that denote the same file.
///
/// ```
/// let mut names = htex_format::library::Names::default();
/// assert!(names.insert("wood/café"));
/// assert!(!names.insert("WOOD/CAFE\u{301}"));
/// ```
#[derive(Debug, Default)]
pub struct Names {
    seen: BTreeSet<[u8; 16]>,
}

impl Names {
    /// Adds a name. Returns false if the name differs from an earlier name only in case or in
    /// Unicode normalisation. Some operating systems treat two such names as the same file.
    pub fn insert(&mut self, name: &str) -> bool {
        self.seen.insert(file_key(name))
    }
}

/// Checks the name of a library: up to 255 bytes of UTF-8 without characters that control a
/// terminal. It may be empty.
pub(crate) fn check_library_name(name: &str) -> Result<(), InvalidName> {
    if name.len() > TEXT_BYTES {
        return Err(InvalidName::TooLong(name.len()));
    }
    let refused = name.chars().find(|c| steers(*c));
    refused.map_or(Ok(()), |c| Err(InvalidName::Character(c)))
}

fn is_refused(c: char) -> bool {
    steers(c) || matches!(c, '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|')
}

fn check_part(part: &str) -> Result<(), InvalidName> {
    if matches!(part, "" | "." | "..") {
        return Err(InvalidName::Part);
    }
    if part.ends_with([' ', '.']) {
        return Err(InvalidName::End);
    }
    if part.len() > PART_BYTES {
        return Err(InvalidName::LongPart(part.len()));
    }
    if is_device(part) {
        return Err(InvalidName::Device);
    }
    Ok(())
}

/// Returns whether a part is a device name of Windows, with or without an extension. Windows
/// ignores spaces before the extension.
fn is_device(part: &str) -> bool {
    let stem = part.split('.').next().unwrap_or(part).trim_end_matches(' ');
    let is = |stem: &str, names: &[&str]| names.iter().any(|name| stem.eq_ignore_ascii_case(name));
    let is_number = |c: char| c.is_ascii_digit() || matches!(c, '¹' | '²' | '³');
    let numbered = stem.strip_suffix(is_number);
    is(stem, &DEVICES) || numbered.is_some_and(|stem| is(stem, &NUMBERED_DEVICES))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_relative_paths_everywhere() {
        for name in ["a", "wood/oak 2", "布/綿", "a..b/.c", "console/com10", "com⁴", "a.htex"] {
            assert_eq!(check_name(name), Ok(()), "{name}");
        }
        for (name, error) in [
            ("", InvalidName::Empty),
            ("a//b", InvalidName::Part),
            ("/a", InvalidName::Part),
            ("a/", InvalidName::Part),
            ("a/../b", InvalidName::Part),
            (".", InvalidName::Part),
            ("a\\b", InvalidName::Character('\\')),
            ("C:a", InvalidName::Character(':')),
            ("a\nb", InvalidName::Character('\n')),
            ("a\u{85}b", InvalidName::Character('\u{85}')),
            ("a./b", InvalidName::End),
            ("a ", InvalidName::End),
            ("x/con", InvalidName::Device),
            ("Lpt1.htex", InvalidName::Device),
            ("a/COM².x", InvalidName::Device),
            ("a\u{202e}gnp.oak", InvalidName::Character('\u{202e}')),
            ("a\u{200d}b", InvalidName::Character('\u{200d}')),
            ("\u{feff}a", InvalidName::Character('\u{feff}')),
            ("conin$", InvalidName::Device),
            ("CONOUT$ .b/c", InvalidName::Device),
            ("a.HTEX/b", InvalidName::Folder),
        ] {
            assert_eq!(check_name(name), Err(error), "{name:?}");
        }
        assert_eq!(check_name(&"é".repeat(128)), Err(InvalidName::TooLong(256)));
        assert_eq!(check_name(&"é".repeat(125)), Ok(()));
        assert_eq!(check_name(&"a".repeat(251)), Err(InvalidName::LongPart(251)));
        assert_eq!(check_library_name("a\u{2066}b"), Err(InvalidName::Character('\u{2066}')));
    }

    #[test]
    fn names_of_one_file_on_some_system_are_alike() {
        for (one, other) in [
            ("Straße/σ", "STRASSE/ς"),
            ("café", "cafe\u{301}"),
            ("K", "\u{212a}"),
            ("Å", "\u{212b}"),
            ("CAFÉ", "cafe\u{301}"),
            // A character whose folded form decomposes in another order.
            ("\u{1fb3}\u{301}", "\u{3b1}\u{301}\u{345}"),
        ] {
            let mut names = Names::default();
            assert!(names.insert(one) && !names.insert(other), "{one} {other}");
        }
        let mut names = Names::default();
        assert!(["a", "b", "á", "ａ", "aa"].iter().all(|name| names.insert(name)));
    }
}
