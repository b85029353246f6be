//! Errors of the authoring pipeline.

use std::path::PathBuf;

use htex_base::finding::{Finding, Hint, listed};
use htex_host::HostError;

use htex_recording::hertz;

/// An error of the authoring pipeline. Each message says what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AuthorError {
    /// The sample rate is too low for the tactile band.
    #[error(
        "{source_name}: sampled at {} it holds nothing above {}, and a \
         texture's spectrum lies at 20 to 1000 Hz; record at 2 kHz or more (60 Hz is the least \
         that leaves anything)",
        hertz(*rate_hz), hertz(*nyquist_hz)
    )]
    RateTooLow {
        source_name: String,
        /// Its sample rate, hertz.
        rate_hz: f64,
        /// Its Nyquist frequency, hertz.
        nyquist_hz: f64,
    },
    /// The recording is shorter than one segment.
    #[error(
        "{source_name}: {samples} samples are less than one segment of 0.2 s ({needed} samples)"
    )]
    TooShort {
        source_name: String,
        samples: usize,
        /// Samples of a segment.
        needed: usize,
    },
    /// No sweep is long enough to hold a segment.
    #[error(
        "{source_name}: no complete sweep of 0.2 s or more (a sweep cut off by the beginning or the end does not count); \
         choose windows for a recording without back-and-forth sweeps"
    )]
    NoSegments { source_name: String },
    /// The setup's response is zero or not finite in the band, so spectra cannot be divided by it.
    #[error(
        "setup response: its largest magnitude in the band is {largest:e}; a finite value above 0 is \
         needed at every frequency that is to be divided by it: measure the setup again"
    )]
    Response {
        /// Its largest magnitude in the band; NaN if any magnitude is not a number.
        largest: f64,
    },
    /// The recordings of one condition have different bands.
    #[error(
        "recordings of one condition have different bands because of their sample rates; fit them separately"
    )]
    BandsDiffer,
    /// The recordings of one texture have different quantities.
    #[error(
        "the recordings hold different quantities, such as forces and accelerations; fit them separately"
    )]
    QuantitiesDiffer,
    /// No segment is within the tolerance of the requested condition.
    #[error(
        "{source_name}: all {segments} segments differ from their target by more than 10 %: {comparison}; give the condition that \
         was recorded, correct the scale of a column, or record again"
    )]
    OffTarget {
        source_name: String,
        segments: usize,
        /// The measured and the requested values.
        comparison: String,
    },
    /// The recording has errors or warnings, and the caller asked to refuse such recordings.
    #[error("{source_name}: refused because of findings that are errors or warnings:{}", listed(.findings))]
    Strict {
        source_name: String,
        /// The errors and warnings.
        findings: Vec<Finding>,
    },
    /// A speed or a force is out of range.
    #[error("{what} is {value}; {allowed}")]
    Condition {
        /// Speed or force.
        what: &'static str,
        value: f64,
        allowed: &'static str,
    },
    /// The text of a grid is invalid.
    #[error(
        "grid {text}: {problem}; it looks like auto, speed=40,80,160 (mm/s) or force=0.3,0.6 (N)"
    )]
    GridText {
        /// The text, at most 80 characters.
        text: String,
        problem: String,
    },
    /// The recording lacks the finger's speed or force, which a grid of conditions needs.
    #[error(
        "{source_name}: the {what} is not in the file, and a grid of conditions needs it at every sample: name the column of \
         {columns}, or give one {what} for the whole recording, or fit without a grid"
    )]
    NoMotion {
        source_name: String,
        /// Speed or force.
        what: &'static str,
        /// Columns that would supply it.
        columns: &'static str,
    },
    /// Speed and force are not steady in any window.
    #[error(
        "{source_name}: in none of {windows} windows of 0.2 s do speed and force stay within 10 % of their means while the \
         finger slides; stroke more evenly, or correct the columns of position, speed and normal force"
    )]
    NothingSteady {
        source_name: String,
        /// Number of windows.
        windows: usize,
    },
    /// Speed and force are constant, so there is no grid.
    #[error(
        "the motion is constant: {:.4} to {:.4} mm/s and {:.4} to {:.4} N; fit without a grid, which gives one condition",
        .speed_mm_s[0], .speed_mm_s[1], .force_n[0], .force_n[1]
    )]
    GridConstant {
        /// Range of the speed, mm/s.
        speed_mm_s: [f64; 2],
        /// Range of the force, newtons.
        force_n: [f64; 2],
    },
    /// There are too few steady windows even for a single condition.
    #[error(
        "only {segments} windows of 0.2 s are steady, and a condition needs {needed}; record for longer: one or two minutes of \
         strokes at all speeds and forces"
    )]
    GridFew {
        /// Number of steady windows.
        segments: usize,
        /// Fewest windows for one condition.
        needed: usize,
    },
    /// No cell of the grid has enough steady windows.
    #[error(
        "no cell of the grid has {needed} steady windows; {segments} are at {motion}: choose lines there, fewer lines, or \
         record for longer"
    )]
    GridEmpty {
        /// Number of steady windows.
        segments: usize,
        /// Fewest windows for one condition.
        needed: usize,
        /// The ranges of speed and force.
        motion: String,
    },
    /// The recording cannot be played at this rate.
    #[error(
        "{rate_hz} Hz: a loop has a rate above {least_hz} Hz, up to {most_hz} Hz, in steps of 10 Hz"
    )]
    LoopRate { rate_hz: f64, least_hz: f64, most_hz: f64 },
    /// A model could not be fitted or measured.
    #[error(transparent)]
    Model(#[from] HostError),
    /// The samples are not a valid recording.
    #[error(transparent)]
    Recording(#[from] htex_recording::RecordingError),
    /// Only some conditions have both speed and force.
    #[error(
        "scanning speed and normal force are both known for only {known} of {all} conditions; \
         give both for each recording, in their order"
    )]
    UnknownConditions {
        /// Number of conditions that have both speed and force.
        known: usize,
        /// Number of conditions.
        all: usize,
    },
    /// None of the models could be fitted.
    #[error("no model could be fitted: {reasons}")]
    NothingFitted {
        /// The reasons, one for each model.
        reasons: String,
    },
    /// A recording could not be read.
    #[error(transparent)]
    Read(#[from] htex_recording::ReadError),
    /// The asset could not be encoded.
    #[error(transparent)]
    Asset(#[from] htex_format::WriteError),
    /// A file could not be written.
    #[error("cannot write {path}: {error}")]
    Write { path: PathBuf, error: std::io::Error },
}

impl AuthorError {
    pub fn hint(&self) -> Hint {
        Hint::new(match self {
            Self::NoSegments { .. } => &["segments windows"],
            Self::OffTarget { .. } => &["speed", "force", "at", "map"],
            Self::NoMotion { .. } => &["map", "speed", "force", "grid"],
            Self::NothingSteady { .. } => &["map", "grid"],
            Self::GridConstant { .. } | Self::GridFew { .. } | Self::GridEmpty { .. } => &["grid"],
            Self::UnknownConditions { .. } => &["at speed=80,force=0.4"],
            Self::Strict { .. } => &["strict"],
            Self::Read(error) => return error.hint(),
            _ => &[],
        })
    }
}
