//! The finished part of a sweep, so that an interrupted one goes on where it stopped.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::{Deserialize, Serialize};

use crate::TradeoffError;
use crate::measured::Measured;
use crate::timing::Timed;

/// How the first line of a journal begins; the key stands behind it.
const HEAD: &str = "htex tradeoff ";

/// What was finished. A contender is named by its id within its recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum Entry {
    /// A contender was measured on a recording, or why it was not.
    Measured {
        recording: usize,
        contender: String,
        outcome: Result<Measured, String>,
    },
    /// The contenders of a recording were timed, side by side.
    Timed {
        recording: usize,
        times: Vec<(String, Timed)>,
    },
}

/// A file of finished entries, one a line, under the key of what they are results of.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: Option<Mutex<File>>,
    pub(crate) entries: Vec<Entry>,
}

impl Journal {
    /// A journal in a file, which is read by the first sweep that uses it.
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            file: None,
            entries: Vec::new(),
        }
    }

    /// Reads what was finished under `key`; a file of another key is begun anew. A line that was
    /// cut off is dropped, and with it what follows.
    pub(crate) fn open(&mut self, key: &str) -> Result<(), TradeoffError> {
        let key = &format!("{HEAD}{key}");
        self.entries = self.read(key).map_err(|error| self.error(error))?;
        let file = self.rewrite(key).map_err(|error| self.error(error))?;
        self.file = Some(Mutex::new(file));
        Ok(())
    }

    /// A file that is none of ours is left alone.
    fn read(&self, key: &str) -> io::Result<Vec<Entry>> {
        let Ok(file) = File::open(&self.path) else {
            return Ok(Vec::new());
        };
        let mut lines = BufReader::new(file).lines().map_while(Result::ok);
        let first = lines.next().unwrap_or_default();
        if !first.is_empty() && !first.starts_with(HEAD) {
            return Err(io::Error::other(
                "it is there, and no journal of an interrupted sweep; move it away, or name another output",
            ));
        }
        if first != key {
            return Ok(Vec::new());
        }
        let entries = lines.map_while(|line| serde_json::from_str(&line).ok());
        Ok(entries.collect())
    }

    /// The file with just what was read, open for more.
    fn rewrite(&self, key: &str) -> io::Result<File> {
        htex_format::replace_file(&self.path, |file| {
            let mut file = io::BufWriter::new(file);
            writeln!(file, "{key}")?;
            for entry in &self.entries {
                writeln!(file, "{}", serde_json::to_string(entry)?)?;
            }
            file.flush()
        })?;
        OpenOptions::new().append(true).open(&self.path)
    }

    /// Keeps a finished entry. A line is one write, so that only the last one can be cut off.
    pub(crate) fn keep(&self, entry: &Entry) -> Result<(), TradeoffError> {
        let write = |file: &Mutex<File>| {
            let line = serde_json::to_string(entry)? + "\n";
            let mut file = file
                .lock()
                .map_err(|_| io::Error::other("a thread panicked"))?;
            file.write_all(line.as_bytes())
        };
        self.file
            .as_ref()
            .map_or(Ok(()), write)
            .map_err(|error| self.error(error))
    }

    /// Removes the file: the results stand elsewhere.
    ///
    /// # Errors
    /// When it cannot be removed.
    pub fn discard(self) -> Result<(), TradeoffError> {
        match std::fs::remove_file(&self.path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(self.error(error)),
            _ => Ok(()),
        }
    }

    fn error(&self, error: io::Error) -> TradeoffError {
        TradeoffError::Journal {
            path: self.path.clone(),
            error,
        }
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
            outcome: Err("why".to_owned()),
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
        // Killed while it wrote.
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
}
