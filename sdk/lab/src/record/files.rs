//! Formats and names of the files of takes, and the outcomes of takes.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::LabError;

/// File format of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Text with the names and units of the signals, and with all digits of the values. `htex`
    /// reads this format without further settings.
    #[default]
    Csv,
    /// A NumPy array of 64-bit floats with the shape (frames, signals).
    Npy,
    /// 32-bit floats. The value 1 means one newton, or one unit of the signal.
    Wav,
}

#[cfg(feature = "clap")]
impl clap::ValueEnum for Format {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self::Csv, Self::Npy, Self::Wav]
    }

    fn to_possible_value(&self) -> Option<clap::builder::PossibleValue> {
        Some(self.extension().into())
    }
}

/// Outcome of a take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// The take kept to its target.
    Kept,
    /// The take left its target, and was moved to the folder `rejected`.
    Rejected,
    /// The take was cut short, and was moved to the folder `incomplete`.
    Incomplete,
}

impl Format {
    /// Returns an error if this format cannot store the sample rate.
    ///
    /// # Errors
    /// [`LabError::Setup`].
    pub(crate) fn check(self, rate_hz: f64) -> Result<(), LabError> {
        let is_whole = rate_hz.fract() == 0.0 && rate_hz <= f64::from(u32::MAX);
        if self == Self::Wav && !is_whole {
            Err(LabError::Setup {
                what: "the sample rate",
                value: rate_hz.to_string(),
                allowed: "a WAV has a whole number of hertz; record CSV or NPY",
            })
        } else {
            Ok(())
        }
    }

    pub(crate) fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Npy => "npy",
            Self::Wav => "wav",
        }
    }
}

impl Outcome {
    /// Returns the subfolder for takes with this outcome; empty for the folder itself.
    pub(crate) fn folder(self) -> &'static Path {
        Path::new(match self {
            Self::Kept => "",
            Self::Rejected => REJECTED,
            Self::Incomplete => INCOMPLETE,
        })
    }
}

/// Folder for takes that left their target.
pub(crate) const REJECTED: &str = "rejected";
/// Folder for takes that were cut short.
pub(crate) const INCOMPLETE: &str = "incomplete";
/// Extension of the file for a take that is being recorded.
const PART: &str = "part";

/// Pattern of the names that [`check_name`] allows.
pub(crate) const NAME_PATTERN: &str = "^[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}$";

/// Returns the file name of a take without extension: `vinyl-007`.
pub(crate) fn stem(name: &str, number: u32) -> String {
    format!("{name}-{number:03}")
}

/// Returns the path of a take's part file.
pub(crate) fn part_file(folder: &Path, name: &str, number: u32) -> PathBuf {
    folder.join(format!("{}.{PART}", stem(name, number)))
}

/// Returns an error for a name that cannot be part of a file name on every system.
pub(crate) fn check_name(name: &str) -> Result<(), LabError> {
    let allowed = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-' | b'.');
    let is_sound = name.bytes().all(allowed) && !name.starts_with(['.', '-']);
    if is_sound && (1..=100).contains(&name.len()) {
        Ok(())
    } else {
        Err(LabError::Setup {
            what: "the name of the takes",
            value: format!("{name:?}"),
            allowed: "it has 1 to 100 of the characters a-z, A-Z, 0-9, `_`, `-` and `.`, and begins with a letter, digit or `_`",
        })
    }
}

/// Returns the next free take number for this name. It counts all takes, whatever their outcome.
pub(crate) fn next_number(folder: &Path, name: &str) -> std::io::Result<u32> {
    let mut largest = 0;
    for folder in [folder.to_owned(), folder.join(REJECTED), folder.join(INCOMPLETE)] {
        largest = largest.max(largest_number(&files(&folder)?, name).unwrap_or(0));
    }
    Ok(largest.saturating_add(1))
}

/// Returns the largest number among the accepted takes with this name.
pub(crate) fn kept_number(folder: &Path, name: &str) -> Option<u32> {
    largest_number(&files(folder).ok()?, name)
}

fn largest_number(files: &[PathBuf], name: &str) -> Option<u32> {
    let stems = files.iter().filter_map(|file| file.file_stem());
    stems.filter_map(|stem| number(&stem.to_string_lossy(), name)).max()
}

fn number(stem: &str, name: &str) -> Option<u32> {
    stem.strip_prefix(name)?.strip_prefix('-')?.parse().ok()
}

/// Returns the part files of a folder, sorted by name.
pub(crate) fn part_files(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    // Hidden files are not takes, but unfinished files of `OwnFolder`.
    let is_part = |path: &PathBuf| {
        let is_hidden =
            path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        path.extension().is_some_and(|extension| extension == PART) && !is_hidden
    };
    let mut parts: Vec<PathBuf> = files(folder)?.into_iter().filter(is_part).collect();
    parts.sort();
    Ok(parts)
}

/// Returns the files of a folder, or an empty list if there is no such folder.
fn files(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let entries = match std::fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    entries.map(|entry| Ok(entry?.path())).collect()
}
