//! What can go wrong between a recording and an asset.

use std::path::PathBuf;

use htex_host::HostError;

use crate::hertz::hertz;

/// An error of the authoring pipeline; each message says what, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum AuthorError {
    /// The rate leaves nothing of the tactile band.
    #[error(
        "{source_name}: sampled at {} it holds nothing above {}, and a \
         texture's spectrum lies at 20 to 1000 Hz; record at 2 kHz or more (60 Hz is the least \
         that leaves anything)",
        hertz(*rate_hz), hertz(*nyquist_hz)
    )]
    RateTooLow {
        /// The recording.
        source_name: String,
        /// Its rate.
        rate_hz: f64,
        /// Half of it.
        nyquist_hz: f64,
    },
    /// Shorter than one segment.
    #[error(
        "{source_name}: {samples} samples are less than one segment of 0.2 s ({needed} samples)"
    )]
    TooShort {
        /// The recording.
        source_name: String,
        /// What there is.
        samples: usize,
        /// What is needed.
        needed: usize,
    },
    /// No sweep is long enough.
    #[error(
        "{source_name}: no whole sweep of 0.2 s or more (one that the beginning or the end cuts off does not count); \
         try `--segments windows` for a recording without back-and-forth sweeps"
    )]
    NoSegments {
        /// The recording.
        source_name: String,
    },
    /// A setup response that nothing can be divided by.
    #[error(
        "setup response: its largest magnitude in the band is {largest:e}; a finite one above 0 is \
         needed at every frequency that is to be divided by it: measure the setup again"
    )]
    Response {
        /// Its largest magnitude in the band; NaN if one is not a number.
        largest: f64,
    },
    /// Recordings of different bands were to be averaged.
    #[error(
        "recordings at one condition have different bands because of their rates; fit them apart"
    )]
    BandsDiffer,
    /// Recordings of one texture hold different quantities.
    #[error(
        "the recordings hold different quantities, such as forces and accelerations; fit them apart"
    )]
    QuantitiesDiffer,
    /// No segment keeps to the condition that was asked for.
    #[error(
        "{source_name}: all {segments} segments leave their target by more than 10 %: {told}; give the condition that \
         was recorded, scale a column with `--map`, or record again"
    )]
    OffTarget {
        /// The recording.
        source_name: String,
        /// How many segments there were.
        segments: usize,
        /// What was measured, and what was asked for.
        told: String,
    },
    /// The recording has findings, and `strict` was asked for.
    #[error("{source_name}: --strict refuses it (`htex explain CODE` says more):{}", lines(.findings))]
    Strict {
        /// The recording.
        source_name: String,
        /// Its errors and warnings.
        findings: Vec<htex_format::Finding>,
    },
    /// A speed or a force that no exploration has.
    #[error("{what} is {value}; {allowed}")]
    Condition {
        /// Speed or force.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A model could not be fitted or measured.
    #[error(transparent)]
    Model(#[from] HostError),
    /// Samples are no recording.
    #[error(transparent)]
    Recording(#[from] crate::recording::RecordingError),
    /// Some recordings have a condition and others have none.
    #[error(
        "scanning speed and normal force are both known for {known} of the {all} conditions only; \
         give them for each recording: `--at speed=80,force=0.4`, once a recording, in their order"
    )]
    UnknownConditions {
        /// How many are known.
        known: usize,
        /// How many there are.
        all: usize,
    },
    /// No model could be fitted.
    #[error("no model could be fitted: {reasons}")]
    NothingFitted {
        /// Why, model by model.
        reasons: String,
    },
    /// A recording could not be read.
    #[error(transparent)]
    Read(#[from] crate::read::ReadError),
    /// The asset could not be made.
    #[error(transparent)]
    Asset(#[from] htex_format::WriteError),
    /// A file could not be written.
    #[error("cannot write {path}: {error}")]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        error: std::io::Error,
    },
}

/// Findings, one a line.
fn lines(findings: &[htex_format::Finding]) -> String {
    let line = |f: &htex_format::Finding| {
        format!("\n  {} {}", f.severity, htex_format::plain(&f.to_string()))
    };
    findings.iter().map(line).collect()
}
