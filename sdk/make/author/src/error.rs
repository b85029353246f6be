//! The error of this crate.

use std::io;
use std::path::PathBuf;

use htex_base::finding::{Finding, Hint, listed};
use htex_format::Quantity;
use htex_host::HostError;
use htex_recording::{ReadError, hertz};

/// An error that occurs while textures are read, fitted, made, compared or simulated. Each message
/// says what is wrong, where, and what to do. [`Self::kind`] returns what an error is about.
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
        /// Sample rate of the recording, hertz.
        rate_hz: f64,
        /// Nyquist frequency of the recording, hertz.
        nyquist_hz: f64,
    },
    /// The recording is shorter than one segment.
    #[error(
        "{source_name}: {samples} samples are less than one segment of 0.2 s ({needed} samples)"
    )]
    TooShort {
        source_name: String,
        samples: usize,
        /// Number of samples in a segment.
        needed: usize,
    },
    /// No sweep is long enough to hold a segment.
    #[error(
        "{source_name}: no complete sweep of 0.2 s or more (a sweep cut off by the beginning or the end does not count); \
         choose windows for a recording without back-and-forth sweeps"
    )]
    NoSegments { source_name: String },
    /// The frequency response of the recording setup is zero or not finite in the band, so spectra
    /// cannot be divided by it.
    #[error(
        "setup response: its largest magnitude in the band is {largest:e}; a finite value above 0 is \
         needed at every frequency that is to be divided by it: measure the setup again"
    )]
    Response {
        /// The response's largest magnitude in the band; NaN if any magnitude is not a number.
        largest: f64,
    },
    /// The recordings of one condition have different bands.
    #[error(
        "recordings of one condition have different bands because of their sample rates; fit them separately"
    )]
    BandsDiffer,
    /// The recordings of one texture measure different quantities.
    #[error(
        "the recordings hold different quantities, such as forces and accelerations; fit them separately"
    )]
    QuantitiesDiffer,
    /// In every segment, the motion differs from the requested condition by more than the
    /// tolerance.
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
    /// The recording does not contain the finger's speed or force. A grid of conditions needs both.
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
    /// Speed and force are constant, so a grid of conditions cannot be made.
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
    /// The number of steady windows is too small for even a single condition.
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
    Read(#[from] ReadError),
    /// The parameters or the asset cannot be written.
    #[error(transparent)]
    Asset(#[from] htex_format::WriteError),
    /// The bytes are not a valid asset.
    #[error(transparent)]
    ReadAsset(#[from] htex_format::ReadError),
    /// A representation cannot be read or played.
    #[error(transparent)]
    Play(#[from] htex_play::Error),
    /// Saving an edited asset would lose data: entries of the file that the manifest does not name,
    /// or keys of the manifest that this program does not know.
    #[error("an edit would not keep all of it: {}; edit it with the program that wrote it", .lost.join("; "))]
    EditLoses { lost: Vec<String> },
    /// The asset and the recording describe different quantities.
    #[error("the asset holds {held}, the recording is read as {recorded}")]
    OtherQuantity {
        /// The asset's quantity.
        held: Quantity,
        /// The recording's quantity.
        recorded: Quantity,
    },

    /// A map of columns cannot be read.
    #[error("{keyword} {text}: {error}")]
    Map {
        /// Its name: `map` or `tracker_map`.
        keyword: &'static str,
        text: String,
        /// What is wrong with it.
        error: Box<ReadError>,
    },
    /// The number of trackers is neither one nor the number of recordings.
    #[error("{trackers} trackers for {recordings} recordings; give one for each, or one for all")]
    Trackers {
        /// Number of trackers that are given.
        trackers: usize,
        recordings: usize,
    },
    /// An option names a model that is not being fitted.
    #[error("option {model}.{name}: no such model is fitted; there are {}", .fitted.join(", "))]
    ModelNotFitted {
        /// The model that the option names.
        model: String,
        name: String,
        /// Short names of the models that are being fitted.
        fitted: Vec<String>,
    },
    /// An option is not of the form `MODEL.NAME=VALUE`.
    #[error("option {text}: it looks like MODEL.NAME=VALUE, e.g. ar.order=6")]
    OptionForm { text: String },
    /// An asset with these metadata would be invalid.
    #[error("{field}: {problem}")]
    Metadata {
        field: &'static str,
        /// What is wrong with it, and what to do.
        problem: String,
    },

    /// A file to embed is not a WASM module.
    #[error("{file}: only WASM modules can be embedded")]
    NoModule { file: PathBuf },
    /// A module to embed contains a model that was not fitted.
    #[error("{file}: {model} was not fitted; add it to the models to fit")]
    ModuleNotFitted { file: PathBuf, model: String },
    /// A module to embed cannot be read.
    #[error("cannot read {file}: {error}")]
    Module { file: PathBuf, error: io::Error },

    /// The model has no parameter of this name.
    #[error("{model} has no parameter {name:?}; it has {there}")]
    UnknownParameter {
        model: String,
        name: String,
        /// The model's parameters, with units and ranges.
        there: String,
    },
    /// A parameter has no value.
    #[error("{model} needs a value for {missing}")]
    MissingParameter {
        model: String,
        /// The parameters without a value, with units and ranges.
        missing: String,
    },
    /// A value is outside its parameter's range, or the parameter has too many values.
    #[error("{name} = {value}: {problem}")]
    ParameterValue {
        name: String,
        value: String,
        /// What is allowed.
        problem: String,
    },
    /// The level is not a valid number for its quantity.
    #[error("a level of {level_rms} {unit}: it is from 0 to {most}")]
    LevelRange {
        /// The level, in the quantity's unit.
        level_rms: f64,
        unit: &'static str,
        /// The largest level allowed for the quantity.
        most: f64,
    },
    /// The model's parameters do not include the level, and no level is given.
    #[error(
        "{model} needs a level: the RMS of the texture in the band, in the unit of its quantity"
    )]
    NoLevel { model: String },
    /// The band is invalid.
    #[error("the band is {low_hz} to {high_hz} Hz; its edges ascend, above 0 and up to 20,000 Hz")]
    Band { low_hz: f64, high_hz: f64 },
    /// The texture has no model, or a model has no condition.
    #[error(
        "the texture has no model, or none has parameters at a condition; give one of each at least"
    )]
    NoParameters,
    /// A texture is made by hand, and only some of its conditions state a speed or a force.
    #[error(
        "some conditions have only a speed or only a force; give both for every condition, or neither"
    )]
    PartialConditions,
    /// The two textures cannot be mixed.
    #[error("{a} and {b} cannot be mixed: {problem}")]
    NotMixable {
        a: String,
        b: String,
        /// What differs.
        problem: String,
    },
    /// The weight of a mixture is not between 0 and 1.
    #[error(
        "a weight of {weight}: it is from 0, all of the first texture, to 1, all of the second"
    )]
    Weight { weight: f64 },

    /// The journal of a sweep of settings could not be written. The journal stores finished points.
    /// It still contains the points that were stored before the error.
    #[error("cannot keep finished points in {path}: {error}")]
    Journal { path: PathBuf, error: io::Error },
    /// No part of the recording can be held out to test a fit. There are too few blocks of time, or
    /// the blocks are silent or equal.
    #[error("{recording}: {reason}, so that nothing can be held out: record for 10 s")]
    NothingHeldOut { recording: String, reason: &'static str },
    /// In a sweep of settings, this setting cannot have this value.
    #[error("knob {name}: `{value}` is not one of its values")]
    Knob { name: String, value: String },

    /// No simulated surface has this name.
    #[error(
        "unknown surface {text:?}; the surfaces are sandpaper, fine-fabric, coarse-fabric, corrugated-paper and vinyl"
    )]
    UnknownSurface {
        /// The given name, at most 40 characters.
        text: String,
    },
    /// An option of a simulation is out of range.
    #[error("{option} is {value}; it must lie in {low}..={high}")]
    SimulationRange {
        /// Name of the option, including its unit.
        option: &'static str,
        value: f64,
        low: f64,
        high: f64,
    },
    /// The true spectrum of a simulation is known only for a free motion, not for sweeps of the
    /// finger.
    #[error(
        "the true spectrum is known for a free motion only; sweeps run over one fixed piece of the material"
    )]
    NoTruth,
    /// The spectrum changes during the simulation, so it has no single true value.
    #[error("the true spectrum is known without drift and lifts only; leave them out")]
    UnsteadyTruth,
}

/// What an [`AuthorError`] is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum AuthorErrorKind {
    /// A recording, or a combination of recordings.
    Recording,
    /// A setting, parameter or option that the caller gave.
    Setting,
    /// A model, or all models.
    Model,
    /// An asset.
    Asset,
    /// The system: a file cannot be read or written.
    File,
}

impl AuthorError {
    /// Returns what the error is about.
    pub fn kind(&self) -> AuthorErrorKind {
        match self {
            Self::Model(_) | Self::NothingFitted { .. } => AuthorErrorKind::Model,
            Self::Asset(_) | Self::ReadAsset(_) | Self::Play(_) | Self::EditLoses { .. } => {
                AuthorErrorKind::Asset
            }
            Self::Module { .. } | Self::Journal { .. } => AuthorErrorKind::File,
            Self::RateTooLow { .. }
            | Self::TooShort { .. }
            | Self::NoSegments { .. }
            | Self::Response { .. }
            | Self::BandsDiffer
            | Self::QuantitiesDiffer
            | Self::OffTarget { .. }
            | Self::Strict { .. }
            | Self::Condition { .. }
            | Self::NoMotion { .. }
            | Self::NothingSteady { .. }
            | Self::GridConstant { .. }
            | Self::GridFew { .. }
            | Self::GridEmpty { .. }
            | Self::Recording(_)
            | Self::UnknownConditions { .. }
            | Self::Read(_) => AuthorErrorKind::Recording,
            _ => AuthorErrorKind::Setting,
        }
    }

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
