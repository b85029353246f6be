//! Errors of recording.

use std::path::PathBuf;

/// Error of a recording. What was recorded before it stays on disk.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The source or a tracker failed.
    #[error(transparent)]
    Source(#[from] htex_device::DeviceError),
    /// The channels do not fit the map, or a file cannot be read.
    #[error(transparent)]
    Read(#[from] htex_author::recording::ReadError),
    /// The source ended before the take was complete.
    #[error("the source ended {after_s:.3} s into a take of {seconds} s{}", with_place(.kept))]
    Ended {
        after_s: f64,
        /// Length of the take, seconds.
        seconds: f64,
        /// The file with what was recorded.
        kept: Option<PathBuf>,
    },
    /// The source stopped with an error during a take.
    #[error("{error}{}", with_place(.kept))]
    Interrupted {
        error: Box<RecordError>,
        /// The file with what was recorded.
        kept: Option<PathBuf>,
    },
    /// The source delivers nothing.
    #[error("the source has delivered nothing for {seconds} s; check its cable and its clock")]
    Silent { seconds: u64 },
    /// The user ended the session.
    #[error("the session was ended{}", with_place(.kept))]
    Left {
        /// The file with what was recorded.
        kept: Option<PathBuf>,
    },
    /// No attempt kept to the target.
    #[error("none of {attempts} takes kept to the target; the last: {reasons}. They are in {}", .folder.display())]
    OffTarget {
        attempts: u32,
        /// What the last attempt did wrong.
        reasons: String,
        /// The folder of rejected takes.
        folder: PathBuf,
    },
    /// A value is not finite.
    #[error(
        "{role} is {value} at {at_s:.4} s; check the map for a division by zero, and the sensor"
    )]
    NotFinite {
        role: String,
        value: f64,
        /// Time since the source was started, seconds.
        at_s: f64,
    },
    /// There is a target, but no signal that measures it.
    #[error("a target {what} is given, but the {what} is not measured; {advice}")]
    NotMeasured {
        /// `speed` or `force`.
        what: &'static str,
        advice: &'static str,
    },
    /// A value of the setup is out of range.
    #[error("{what} is {value}; {allowed}")]
    Setup { what: &'static str, value: String, allowed: &'static str },
    /// A calibration matrix, a part file or the JSON next to a recording cannot be used.
    #[error(transparent)]
    Content(#[from] htex_base::files::ContentError),
    /// A line of a tracker is not two numbers.
    #[error("tracker {name}, line {line}: {text:?} is not `x_mm y_mm` or `x_mm,y_mm`")]
    TrackerLine {
        name: String,
        /// Number of the line, from 1.
        line: usize,
        text: String,
    },
    /// Another program is recording this take.
    #[error("{}: another htex is recording into it; wait for it to end", .file.display())]
    Busy { file: PathBuf },
    /// The page cannot be served.
    #[error(transparent)]
    Page(#[from] crate::page::PageError),
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] htex_base::files::FileError),
}

fn with_place(file: &Option<PathBuf>) -> String {
    match file {
        Some(file) => format!("; what was recorded is in {}", file.display()),
        None => String::new(),
    }
}
