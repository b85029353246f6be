//! Standard output and standard error.

#[cfg(feature = "check")]
use std::ffi::OsString;
use std::fmt::Display;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use htex_base::files::{AtFile, FileError, OwnFolder};
use htex_base::finding::{Notice, plain};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::failure::{Exit, Result, with_hint};
use crate::located::with_uris;
use crate::progress::is_quiet;

/// Prints a line on standard error. Unlike `eprintln!`, it does not panic if standard error is
/// closed.
macro_rules! tell {
    ($($words:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($words)*);
    }};
}
pub(crate) use tell;

/// Prints the result of a command: as JSON with `--json`, else as text.
pub(crate) fn show(result: &(impl Serialize + Display), is_json: bool) -> Result {
    if is_json {
        print_json(result)?
    } else {
        print(&result.to_string())?
    }
    Ok(Exit::SUCCESS)
}

/// Writes text to standard output. Control characters are escaped, because the text may quote
/// untrusted files. It is no error if the program that reads the output has ended (`| head`).
pub(crate) fn print(text: &str) -> Result<()> {
    let lines: String = text
        .split_inclusive('\n')
        .map(|line| match line.strip_suffix('\n') {
            Some(line) => plain(line) + "\n",
            None => plain(line),
        })
        .collect();
    write(&lines)
}

/// Writes text unchanged to standard output, except that remote files are shown by their URIs.
pub(crate) fn write(text: &str) -> Result<()> {
    write_bytes(with_uris(text).as_bytes())
}

/// Writes bytes to standard output.
pub(crate) fn write_bytes(bytes: &[u8]) -> Result<()> {
    let mut output = std::io::stdout().lock();
    match output.write_all(bytes).and_then(|()| output.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(FileError::writing("standard output", error).into())
        }
        _ => Ok(()),
    }
}

/// Writes a value as JSON with a line end. Writes characters that could control a terminal or
/// change the direction of text as JSON escapes. The value stays the same, because such characters
/// occur only in strings.
pub(crate) fn print_json(value: &impl Serialize) -> Result<()> {
    write(&(json_line(value)? + "\n"))
}

/// Returns a value as JSON on one line. Escapes every character that could control a terminal.
pub(crate) fn json_line(value: &impl Serialize) -> Result<String> {
    use std::fmt::Write as _;
    let text = serde_json::to_string(value)?;
    let mut escaped = String::with_capacity(text.len() + 1);
    for c in text.chars() {
        if steers(c) {
            // All of these characters are in the basic multilingual plane.
            let _ = write!(escaped, "\\u{:04x}", u32::from(c));
        } else {
            escaped.push(c);
        }
    }
    Ok(escaped)
}

/// Whether a character is a control character, changes the direction of text, or ends a line.
fn steers(c: char) -> bool {
    matches!(c, '\u{7F}'..='\u{9F}' | '\u{61C}' | '\u{200E}' | '\u{200F}' | '\u{2028}'..='\u{202E}' | '\u{2066}'..='\u{2069}')
}

/// Returns the value with control characters in its texts escaped.
pub(crate) fn tamed<T: Serialize + DeserializeOwned + Clone>(value: &T) -> T {
    let mut json = serde_json::to_value(value).unwrap_or_default();
    tame(&mut json);
    // If an escaped text is no valid value, `print` still escapes the original.
    serde_json::from_value(json).unwrap_or_else(|_| value.clone())
}

fn tame(value: &mut Value) {
    match value {
        Value::String(text) => *text = plain(text).into_owned(),
        Value::Array(list) => list.iter_mut().for_each(tame),
        Value::Object(map) => {
            let entries = std::mem::take(map).into_iter();
            *map = entries
                .map(|(key, mut value)| {
                    tame(&mut value);
                    (plain(&key).into_owned(), value)
                })
                .collect();
        }
        _ => {}
    }
}

pub(crate) fn warn<N: Clone + Into<Notice>>(warnings: &[N]) {
    tell_all("warning", warnings);
}

pub(crate) fn note<N: Clone + Into<Notice>>(notes: &[N]) {
    tell_all("note", notes);
}

fn tell_all<N: Clone + Into<Notice>>(kind: &str, notices: &[N]) {
    if is_quiet() {
        return;
    }
    for notice in notices {
        let Notice { text, hint } = notice.clone().into();
        tell!("{kind}: {}", plain(&with_uris(&with_hint(&text, hint))));
    }
}

/// A file that a command writes. Every command writes its files by [`Self::replace`], so this type
/// decides which links are followed.
#[derive(Clone, Copy)]
pub(crate) enum OutputFile<'a> {
    /// A file that the user named. A link is followed, because the user may have named it for that
    /// purpose.
    Named(&'a Path),
    /// A file whose name this program chose, in a folder that the user named or next to a file that
    /// the user named. Somebody else may have filled the folder, so no link in it is followed.
    Inside(&'a OwnFolder, &'a Path),
}

impl OutputFile<'_> {
    pub(crate) fn path(self) -> PathBuf {
        match self {
            Self::Named(path) => path.to_owned(),
            Self::Inside(folder, name) => folder.path().join(name),
        }
    }

    /// Writes the file under a temporary name next to it, and renames it.
    pub(crate) fn replace(
        self,
        write: impl FnOnce(&mut File) -> std::io::Result<()>,
    ) -> Result<(), FileError> {
        #[allow(clippy::disallowed_methods, reason = "the user named this file")]
        let written = match self {
            Self::Named(path) => htex_base::files::replace_file(path, write),
            Self::Inside(folder, name) => folder.replace(name, write),
        };
        written.writing(self.path())
    }

    pub(crate) fn write(self, bytes: &[u8]) -> Result<(), FileError> {
        self.replace(|file| file.write_all(bytes))
    }
}

/// Writes a file that the user named: first under a temporary name next to it, which is then
/// renamed.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    Ok(OutputFile::Named(path).write(bytes)?)
}

/// Returns a path for messages, with control characters escaped.
pub(crate) fn shown(path: &Path) -> String {
    plain(&path.display().to_string()).into_owned()
}

/// Returns a line that a POSIX shell splits into these arguments.
#[cfg(feature = "check")]
pub(crate) fn command_line(arguments: &[OsString]) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-+=.,:/@%".contains(c);
    let quoted = |argument: &OsString| {
        let text = plain(&argument.to_string_lossy()).into_owned();
        if !text.is_empty() && text.chars().all(is_plain) {
            return text;
        }
        format!("'{}'", text.replace('\'', r"'\''"))
    };
    arguments.iter().map(quoted).collect::<Vec<_>>().join(" ")
}
