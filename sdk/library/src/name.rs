//! Rules of the names of textures: each is also a relative path of a file, on every system.

use crate::wire::TEXT_BYTES;

/// Ending of a texture's file.
const ENDING: &str = ".htex";
/// Most bytes of a part: with [`ENDING`] the 255 that file systems allow in a file's name.
const PART_BYTES: usize = 255 - ENDING.len();
/// Names of devices of Windows, under which no file can be written.
const DEVICES: [&str; 6] = ["CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$"];
/// The same, followed by a digit or a superscript 1, 2 or 3, which Windows takes for digits.
const NUMBERED_DEVICES: [&str; 2] = ["COM", "LPT"];

/// Error: a text is not a name of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidName {
    #[error("it is empty; write a name such as `wood/oak`")]
    Empty,
    #[error("it has {0} bytes and the most is 255; shorten it")]
    TooLong(usize),
    /// It contains a character that file systems or terminals interpret.
    #[error("it contains {0:?}; leave out control characters and \\ : * ? \" < > |")]
    Character(char),
    /// A part between slashes is empty, `.` or `..`.
    #[error("a part of it is empty, `.` or `..`; write the parts with one `/` between them")]
    Part,
    /// A part is too long for the name of a file.
    #[error("a part of it has {0} bytes and the most is 250; shorten it")]
    LongPart(usize),
    /// A folder has the name of a texture's file.
    #[error("a part of it before a `/` ends in .htex, as a texture's file; rename it")]
    Folder,
    /// A part ends in a space or a dot, which Windows removes.
    #[error("a part of it ends in a space or a dot; remove it")]
    End,
    /// A part is a device of Windows.
    #[error("a part of it is a device of Windows, such as CON or COM1; rename it")]
    Device,
}

/// Checks a name: up to 255 bytes of UTF-8, parts separated by `/`, so that every name is a relative path of a file.
///
/// # Errors
/// The rule that it breaks.
///
/// ```
/// use htex_library::check_name;
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
    match folders.any(|folder| caseless(folder).ends_with(&caseless(ENDING))) {
        true => Err(InvalidName::Folder),
        false => Ok(()),
    }
}

/// Returns what names of one file have in common on systems that ignore case: each character's full upper case.
pub(crate) fn caseless(name: &str) -> String {
    name.to_uppercase()
}

/// Checks the name of a library: up to 255 bytes of UTF-8 without control characters; it may be empty.
pub(crate) fn check_library_name(name: &str) -> Result<(), InvalidName> {
    if name.len() > TEXT_BYTES {
        return Err(InvalidName::TooLong(name.len()));
    }
    let refused = name.chars().find(|c| c.is_control());
    refused.map_or(Ok(()), |c| Err(InvalidName::Character(c)))
}

fn is_refused(c: char) -> bool {
    c.is_control() || matches!(c, '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|')
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

/// Whether a part is a device of Windows, with or without an extension. Windows ignores spaces before the extension.
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
        for name in [
            "a",
            "wood/oak 2",
            "布/綿",
            "a..b/.c",
            "console/com10",
            "com⁴",
            "a.htex",
        ] {
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
            ("conin$", InvalidName::Device),
            ("CONOUT$ .b/c", InvalidName::Device),
            ("a.HTEX/b", InvalidName::Folder),
        ] {
            assert_eq!(check_name(name), Err(error), "{name:?}");
        }
        assert_eq!(check_name(&"é".repeat(128)), Err(InvalidName::TooLong(256)));
        assert_eq!(check_name(&"é".repeat(125)), Ok(()));
        assert_eq!(
            check_name(&"a".repeat(251)),
            Err(InvalidName::LongPart(251))
        );
        assert_eq!(caseless("Straße/σ"), caseless("STRASSE/ς"));
    }
}
