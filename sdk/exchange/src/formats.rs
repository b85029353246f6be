//! The formats, in one table: commands, help, messages and documents are made of it.

use serde::Serialize;

use crate::error::{ExchangeError, Fault, list};
use crate::export::{Job, Written};
use crate::profile::Profile;
use crate::{ahap, haptic, hjif, writers};

/// A format.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct Format {
    /// As `--to` has it.
    pub name: &'static str,
    /// What it is, in words.
    pub title: &'static str,
    /// Extensions of its files, in lower case.
    pub extensions: &'static [&'static str],
    /// Reads a file as a signal to fit, if it is imported.
    #[serde(rename = "reads", serialize_with = "is_there")]
    pub reads: Option<Reads>,
    /// Writes an asset, if it is exported.
    #[serde(rename = "writes", serialize_with = "is_there")]
    pub writes: Option<Writes>,
    /// What of a texture it keeps.
    pub keeps: &'static str,
    /// What it loses.
    pub loses: &'static str,
    /// The profile that is used where none is named.
    pub profile: &'static str,
}

/// Reads a file as a signal within ±1.
pub type Reads = fn(&[u8], &Context<'_>) -> Result<Signal, Fault>;
/// Writes what a job plays.
pub type Writes = fn(&Job<'_>) -> Result<Written, ExchangeError>;

/// What a file is read for.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    pub profile: &'a Profile,
    /// Rate of the signal, hertz.
    pub rate_hz: f64,
    /// Speed of a finger over a file that lies over space, mm/s.
    pub speed_mm_s: f64,
}

/// A signal within ±1.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    pub samples: Vec<f64>,
    /// What of the file was not read, each a sentence.
    pub left_out: Vec<String>,
}

fn is_there<T, S: serde::Serializer>(
    function: &Option<T>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_bool(function.is_some())
}

/// Every format.
pub const FORMATS: &[Format] = &[
    Format {
        name: "haptic",
        title: "Meta .haptic, version 1",
        extensions: &["haptic"],
        reads: Some(haptic::signal),
        writes: Some(writers::haptic),
        keeps: "level and one frequency over time",
        loses: "the spectrum, speed and force, the unit; frequencies are positions in an actuator's range",
        profile: "wide-lra",
    },
    Format {
        name: "ahap",
        title: "Apple .ahap, version 1",
        extensions: &["ahap"],
        reads: Some(ahap::signal),
        writes: Some(writers::ahap),
        keeps: "level and one sharpness over time",
        loses: "the spectrum, speed and force, the unit; how sharp a sharpness is",
        profile: "iphone",
    },
    Format {
        name: "android",
        title: "Android VibrationEffect, as JSON or Kotlin",
        extensions: &["json", "kt"],
        reads: None,
        writes: Some(writers::android),
        keeps: "level and one frequency over time, in as many points as the device takes",
        loses: "the spectrum, speed and force, the unit; what changes faster than the points",
        profile: "android",
    },
    Format {
        name: "hjif",
        title: "MPEG .hjif, ISO/IEC 23090-31",
        extensions: &["hjif"],
        reads: Some(hjif::signal),
        writes: Some(writers::hjif),
        keeps: "seven tones over way or time (vectorial), or the samples (wavelet)",
        loses: "how the spectrum follows speed and force, the unit; with tones what lies between them",
        profile: "wide-lra",
    },
    Format {
        name: "wav",
        title: "WAV that drives an actuator",
        extensions: &["wav"],
        reads: None,
        writes: Some(writers::wav),
        keeps: "the samples, as far as the actuator plays them",
        loses: "speed and force, the unit; what is outside the actuator's range",
        profile: "wide-lra",
    },
];

impl Format {
    /// Finds a format by its name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        FORMATS.iter().find(|format| format.name == name)
    }

    /// Finds the format that reads a file, by its extension.
    ///
    /// # Errors
    /// When none that is imported has it; the error lists those that are.
    pub fn of_file(file: &str) -> Result<&'static Self, ExchangeError> {
        let extension = file
            .rsplit_once('.')
            .map_or("", |(_, extension)| extension)
            .to_ascii_lowercase();
        let has =
            |format: &&Self| format.reads.is_some() && format.extensions.contains(&&extension[..]);
        FORMATS
            .iter()
            .find(has)
            .ok_or_else(|| ExchangeError::UnknownFormat {
                file: file.to_owned(),
                there: imported(),
            })
    }

    /// Its extensions, with their points.
    #[must_use]
    pub fn dotted(&self) -> String {
        let dotted: Vec<String> = self.extensions.iter().map(|e| format!(".{e}")).collect();
        dotted.join(", ")
    }
}

/// Returns what is imported, in words: `.haptic, .ahap and .hjif`.
#[must_use]
pub fn imported() -> String {
    list(
        FORMATS
            .iter()
            .filter(|format| format.reads.is_some())
            .map(Format::dotted),
    )
}

/// Returns the names of what is exported.
#[must_use]
pub fn exported() -> Vec<&'static str> {
    let written = FORMATS.iter().filter(|format| format.writes.is_some());
    written.map(|format| format.name).collect()
}

/// Returns the table of the formats in Markdown, for documents.
#[must_use]
pub fn formats_table() -> String {
    let mut text = String::from(
        "| name | format | files | in | out | keeps | loses |\n|---|---|---|---|---|---|---|\n",
    );
    let is = |there: bool| if there { "yes" } else { "" };
    for f in FORMATS {
        text += &format!(
            "| `{}` | {} | {} | {} | {} | {} | {} |\n",
            f.name,
            f.title,
            f.dotted(),
            is(f.reads.is_some()),
            is(f.writes.is_some()),
            f.keeps,
            f.loses
        );
    }
    text
}

/// Returns the table of the profiles in Markdown, for documents.
#[must_use]
pub fn profiles_table() -> String {
    let mut text = String::from(
        "| name | actuator | resonance | Q | range | strongest | latency | points |\n|---|---|---|---|---|---|---|---|\n",
    );
    for p in crate::PROFILES.iter() {
        let said = |value: &crate::Sourced, unit: &str| {
            let mark = if value.is_assumed() { "" } else { "*" };
            format!("{}{unit}{mark}", value.value)
        };
        text += &format!(
            "| `{}` | {} | {} | {} | {} to {} | {} | {} | {}, {} or longer |\n",
            p.name,
            p.title,
            said(&p.resonance_hz, " Hz"),
            said(&p.q, ""),
            said(&p.low_hz, ""),
            said(&p.high_hz, " Hz"),
            said(&p.strongest_m_s2, " m/s²"),
            said(&p.latency_ms, " ms"),
            said(&p.most_points, ""),
            said(&p.shortest_point_ms, " ms"),
        );
    }
    text
}
