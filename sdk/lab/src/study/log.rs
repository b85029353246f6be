//! The file with the answers of one participant. Lines are only appended to this file. Each answer
//! is on disk before the next trial begins.

use std::collections::BTreeMap;
use std::fs::{File, TryLockError};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use htex_base::files::{AtFile, FileError, OwnFolder};

use crate::error::LabError;
use crate::study::Study;
use crate::study::lines::{DeviceUsed, Header, Line, SourceUsed, VERSION};
use crate::study::plan::ParticipantPlan;
use crate::study::read::files_of;

/// Returns the path of the file with a participant's answers, e.g. `FOLDER/P07.jsonl`.
pub fn participant_file(folder: &Path, participant: &str) -> PathBuf {
    folder.join(format!("{participant}.jsonl"))
}

/// An open file of answers. The file stays locked until the `Log` is dropped.
#[derive(Debug)]
pub struct Log {
    path: PathBuf,
    file: File,
    /// If a crash left an incomplete last line, the total length of all complete lines, bytes.
    whole: Option<u64>,
}

impl Log {
    /// Opens the file of a session's answers, or creates it if it does not exist. Also returns the
    /// lines after the header.
    ///
    /// Opening does not change an existing file. If a crash left the last line incomplete, the
    /// first [`Self::append`] removes this line. Opening does not remove the line, because the
    /// caller must first check that the complete lines belong to this session. A symbolic link is
    /// never followed.
    ///
    /// # Errors
    /// Returns [`LabError::OtherVersion`] if the file has another header. Returns
    /// [`LabError::Busy`] while another program has the file open. Returns [`LabError::Line`] if a
    /// line is damaged. Returns [`LabError::File`] for errors of the file system, or if the path is
    /// a link or a pipe.
    pub fn open(path: &Path, header: &Header) -> Result<(Self, Vec<Line>), LabError> {
        let (folder, name) = place(path).reading(path)?;
        let mut file = match folder.open_to_append(&name) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                begin(path, header)?;
                folder.open_to_append(&name)
            }
            opened => opened,
        }
        .reading(path)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(LabError::busy(path, "running this participant"));
            }
            Err(TryLockError::Error(error)) => return Err(FileError::reading(path, error).into()),
        }
        let mut bytes = Vec::new();
        let read = file.read_to_end(&mut bytes);
        read.reading(path)?;
        let whole = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |end| end + 1);
        let (begun, lines) = parse(path, &bytes[..whole])?;
        same_version(path, &begun, header)?;
        let log = Self {
            path: path.to_owned(),
            file,
            whole: (whole < bytes.len()).then_some(whole as u64),
        };
        Ok((log, lines))
    }

    /// Appends a line to the file. Returns after the line is on disk.
    ///
    /// # Errors
    /// [`LabError::File`]. The line in the file may then be incomplete. An incomplete line is
    /// removed when the session continues.
    pub fn append(&mut self, line: &Line) -> Result<(), LabError> {
        let text = text(line).writing(&self.path)?;
        let synced = self.whole_lines().and_then(|()| {
            self.file.write_all(text.as_bytes())?;
            self.file.sync_data()
        });
        Ok(synced.writing(&self.path)?)
    }

    /// Removes the incomplete line at the end of the file.
    fn whole_lines(&mut self) -> io::Result<()> {
        if let Some(whole) = self.whole {
            self.file.set_len(whole)?;
            self.file.sync_all()?;
            self.whole = None;
        }
        Ok(())
    }

    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Reads the header and the lines of a file of answers. Ignores an incomplete last line: a session
/// that is running or was killed may have written it.
pub(crate) fn read(path: &Path) -> Result<(Header, Vec<Line>), LabError> {
    let bytes = std::fs::read(path).reading(path)?;
    let whole = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |end| end + 1);
    parse(path, &bytes[..whole])
}

fn text(line: &Line) -> std::io::Result<String> {
    Ok(serde_json::to_string(line)? + "\n")
}

/// Returns the folder of a file of answers, and the file's name in that folder.
fn place(path: &Path) -> io::Result<(OwnFolder, PathBuf)> {
    let (folder, name) = OwnFolder::of_file(path)?;
    Ok((OwnFolder::private(folder.path()), name))
}

/// Creates the file with its header under a temporary name, and then renames it. Therefore, every
/// file has a header. Returns when the file is on disk.
fn begin(path: &Path, header: &Header) -> Result<(), LabError> {
    let begun = place(path).and_then(|(folder, name)| {
        let text = text(&Line::Header(Box::new(header.clone())))?;
        folder.replace(&name, |file| file.write_all(text.as_bytes()))
    });
    Ok(begun.writing(path)?)
}

fn parse(path: &Path, bytes: &[u8]) -> Result<(Header, Vec<Line>), LabError> {
    let damaged =
        |line: usize, problem: String| LabError::Line { file: path.to_owned(), line, problem };
    let mut lines = bytes
        .split(|b| *b == b'\n')
        .enumerate()
        .map(|(i, line)| Line::parse(line).map_err(|error| damaged(i + 1, error)));
    // The part after the last line end is an incomplete line, or empty.
    let count = bytes.iter().filter(|b| **b == b'\n').count();
    let Some(Line::Header(header)) = lines.next().transpose()?.filter(|_| count > 0) else {
        return Err(damaged(1, "this is not the header of answers".to_owned()));
    };
    // The filter above ensures that `count` is not 0.
    let rest = lines.take(count - 1).collect::<Result<Vec<Line>, _>>()?;
    match rest.iter().position(|line| matches!(line, Line::Header(_))) {
        Some(i) => Err(damaged(i + 2, "there is a second header".to_owned())),
        None => Ok((*header, rest)),
    }
}

/// Returns an error if two headers differ in anything except the program and the date.
fn same_version(path: &Path, begun: &Header, now: &Header) -> Result<(), LabError> {
    let changed = if begun.htex_answers != now.htex_answers {
        format!("the file has version {}", begun.htex_answers)
    } else if begun.participant != now.participant {
        format!("they belong to {}", begun.participant)
    } else if begun.simulated != now.simulated {
        let who = |header: &Header| match &header.simulated {
            Some(simulated) => format!("a simulated participant (seed {})", simulated.seed),
            None => "a participant".to_owned(),
        };
        format!("they come from {}, not from {}", who(begun), who(now))
    } else if let Some(name) = other_file(begun, now) {
        format!("{name} has changed since")
    } else if begun.device != now.device {
        begun.device.differences(&now.device).join("; ")
    } else if begun.source != now.source {
        other_source(begun.source.as_ref(), now.source.as_ref())
    } else {
        return Ok(());
    };
    Err(LabError::OtherVersion { file: path.to_owned(), changed })
}

/// Returns how two sources differ.
fn other_source(begun: Option<&SourceUsed>, now: Option<&SourceUsed>) -> String {
    let name = |source: Option<&SourceUsed>| match source {
        Some(source) => format!("{} at {} Hz", source.name, source.rate_hz),
        None => "not recorded".to_owned(),
    };
    let (was, is) = (name(begun), name(now));
    if was == is {
        format!(
            "a setting of the felt force's source ({was}) has changed since: the settings, map, calibration, quantity, tracker or format"
        )
    } else {
        format!("the felt force was {was}, and is {is}")
    }
}

/// Returns a file whose hashes in the two headers differ, or that occurs in only one of the
/// headers.
pub(crate) fn other_file<'a>(begun: &'a Header, now: &'a Header) -> Option<&'a str> {
    let mut names = begun.files.keys().chain(now.files.keys());
    let differs = |name: &&String| begun.files.get(*name) != now.files.get(*name);
    names.find(differs).map(String::as_str)
}

impl Header {
    /// Creates the header of a participant's session. `path` is the study file. The header contains
    /// hashes of the study file and of all files that the study names.
    ///
    /// # Errors
    /// Returns [`LabError::File`] if one of the files cannot be read.
    pub fn new(
        study: &Study,
        path: &Path,
        plan: &ParticipantPlan,
        device: DeviceUsed,
        tool: String,
    ) -> Result<Self, LabError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut files = BTreeMap::from([("study".to_owned(), file_hash(path)?)]);
        for file in files_of(study) {
            let name = format!("file {}", file.display());
            files.insert(name, file_hash(&folder.join(&file))?);
        }
        Ok(Self {
            htex_answers: VERSION.to_owned(),
            study: study.name.clone(),
            participant: plan.participant.clone(),
            files,
            device,
            begun: None,
            ratings: plan.trials.len() * study.attributes.len(),
            source: None,
            tool,
            simulated: None,
        })
    }
}

/// Returns the BLAKE3 hash of a file, hexadecimal.
pub(crate) fn file_hash(file: &Path) -> Result<String, LabError> {
    let bytes = std::fs::read(file).reading(file)?;
    Ok(blake3::hash(&bytes).to_hex().to_string())
}
