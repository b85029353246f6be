//! Journal of a sweep. It stores finished steps, so that an interrupted sweep can continue.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use htex_base::files::OwnFolder;
use serde::{Deserialize, Serialize};

use crate::AuthorError;
use crate::tradeoff::measurement::Measurement;
use crate::tradeoff::timing::Times;

/// Start of a journal's first line; the key follows.
const HEAD: &str = "htex tradeoff ";

/// Result of measuring a contender on a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) enum Outcome {
    Measured(Box<Measurement>),
    Failed { reason: String },
}

/// A finished step. A contender is identified by its id within its recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) enum Entry {
    /// The result of measuring a contender on a recording.
    Measured { recording: usize, contender: String, outcome: Outcome },
    /// The times of all contenders for a recording.
    Timed { recording: usize, times: Vec<(String, Times)> },
}

/// A file of finished steps, one in each line. The first line contains a key: a hash of the sweep's
/// inputs.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: Option<Mutex<File>>,
    pub(crate) entries: Vec<Entry>,
}

impl Journal {
    /// Creates a journal for the file `path`. This function does not read the file; the first sweep
    /// that uses the journal does.
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_owned(), file: None, entries: Vec::new() }
    }

    /// Reads the entries of a file with this key, up to a truncated line. A file with another key
    /// is overwritten.
    pub(crate) fn open(&mut self, key: &str) -> Result<(), AuthorError> {
        let key = &format!("{HEAD}{key}");
        self.entries = self.with_path(self.read(key))?;
        // The rest of a truncated line must go: appending to it would spoil the next entry too.
        let file = self.with_path(self.rewrite(key))?;
        self.file = Some(Mutex::new(file));
        Ok(())
    }

    /// Reads the file. A file that is not a journal is an error and is not changed.
    fn read(&self, key: &str) -> io::Result<Vec<Entry>> {
        let (own, name) = self.place()?;
        let file = match own.open(&name) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            opened => opened?,
        };
        let mut lines = BufReader::new(file).lines().map_while(Result::ok);
        let first = lines.next().unwrap_or_default();
        // An empty file is taken over: a program may have stopped before it wrote the first line.
        if !first.is_empty() && !first.starts_with(HEAD) {
            return Err(io::Error::other(
                "it exists and is not the journal of an interrupted sweep; move it, or name another output",
            ));
        }
        if first != key {
            return Ok(Vec::new());
        }
        // An interrupted program leaves a part of a line. Whatever follows such a line is measured
        // again.
        let entries = lines.map_while(|line| serde_json::from_str(&line).ok());
        Ok(entries.collect())
    }

    /// Rewrites the file with the entries that were read, and keeps it open for more.
    fn rewrite(&self, key: &str) -> io::Result<File> {
        let (own, name) = self.place()?;
        own.replace(&name, |file| {
            let mut file = io::BufWriter::new(file);
            writeln!(file, "{key}")?;
            for entry in &self.entries {
                writeln!(file, "{}", serde_json::to_string(entry)?)?;
            }
            file.flush()
        })?;
        own.open_to_append(&name)
    }

    /// Appends a finished entry. Each line is a single write, so only the last line can be
    /// truncated.
    pub(crate) fn keep(&self, entry: &Entry) -> Result<(), AuthorError> {
        let write = |file: &Mutex<File>| {
            let line = serde_json::to_string(entry)? + "\n";
            let mut file = file.lock().map_err(|_| io::Error::other("a thread panicked"))?;
            file.write_all(line.as_bytes())
        };
        self.with_path(self.file.as_ref().map_or(Ok(()), write))
    }

    /// Removes the journal's file. Call this after the results have been written elsewhere.
    ///
    /// # Errors
    /// Returns an error when the file cannot be removed.
    pub fn discard(self) -> Result<(), AuthorError> {
        let removed = self.place().and_then(|(own, name)| own.remove(&name));
        self.with_path(removed)
    }

    /// The file's folder, which must exist, and the file's name in it.
    fn place(&self) -> io::Result<(OwnFolder, PathBuf)> {
        let (own, name) = OwnFolder::of_file(&self.path)?;
        if own.path().is_dir() {
            Ok((own, name))
        } else {
            Err(io::Error::new(
                io::ErrorKind::NotFound,
                "its folder does not exist; create it first",
            ))
        }
    }

    /// Adds the file's name to an error.
    fn with_path<T>(&self, result: io::Result<T>) -> Result<T, AuthorError> {
        result.map_err(|error| AuthorError::Journal { path: self.path.clone(), error })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // A failed unwrap is a failed test.
mod tests {
    use super::*;

    fn entry(contender: &str) -> Entry {
        Entry::Measured {
            recording: 0,
            contender: contender.to_owned(),
            outcome: Outcome::Failed { reason: "why".to_owned() },
        }
    }

    #[test]
    fn what_was_finished_is_found_again_under_its_key() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part");
        let open = |key: &str| {
            let mut journal = Journal::new(&path);
            journal.open(key).unwrap();
            journal
        };
        let journal = open("one");
        journal.keep(&entry("a")).unwrap();
        journal.keep(&entry("b")).unwrap();
        // As if interrupted while writing.
        let mut text = std::fs::read_to_string(&path).unwrap();
        text += "{\"Measured\":{\"recor";
        std::fs::write(&path, text).unwrap();
        let journal = open("one");
        assert_eq!(journal.entries, [entry("a"), entry("b")]);
        journal.keep(&entry("c")).unwrap();
        assert_eq!(open("one").entries.len(), 3);
        assert!(open("other").entries.is_empty());
        let journal = open("one");
        assert!(journal.entries.is_empty());
        journal.discard().unwrap();
        assert!(!path.exists());
    }

    #[test]
    fn an_entry_with_other_keys_is_not_read() {
        let entry = |keys: &str| {
            let text = format!(r#"{{"Timed": {{"recording": 0, "times": []{keys}}}}}"#);
            serde_json::from_str::<Entry>(&text)
        };
        assert!(entry("").is_ok());
        assert!(entry(r#", "tims": []"#).is_err());
    }
}
