//! Measures of how well a spectrum agrees with a recorded spectrum: a table with one row for each
//! measure.
//!
//! From these rows, the project generates the keys of `quality`, with their checks, schema and
//! rounding. From the same rows come the columns of tables and reports, and the tables in the
//! documents. The crate `htex-author` contains the functions that compute the measures.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::Quality;

/// The kind of a measure: the range of its values, and its best value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeasureKind {
    /// A correlation from -1 to 1; 1 is best.
    Correlation,
    /// An error that is not negative; 0 is best.
    Error,
    /// A difference, positive or negative; 0 is best.
    Difference,
}

impl MeasureKind {
    /// Returns whether a measure can have this value.
    pub fn accepts(self, value: f64) -> bool {
        match self {
            Self::Correlation => (-1.0..=1.0).contains(&value),
            Self::Error => value.is_finite() && value >= 0.0,
            Self::Difference => value.is_finite(),
        }
    }
}

/// The data from which a measure is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// The model's magnitudes, as a measurement of the voice's output would give them.
    Magnitude,
    /// The spectrum of rendered samples.
    Samples,
}

/// A row of the table of measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasureRow {
    /// Key in JSON.
    pub key: &'static str,
    /// JSON key under which the measure is stored if it was computed from rendered samples:
    /// `samples_` followed by the key.
    pub samples_key: &'static str,
    /// Definition, in one sentence.
    pub meaning: &'static str,
    /// Definition for rendered samples; `None` if the measure is computed only from magnitudes.
    pub of_samples: Option<&'static str>,
    /// The case in which a comparison has no value for this measure, such as "for a silent
    /// reference". Generated documentation puts the word "`None` " before this text. This field is
    /// `None` if every comparison has a value.
    pub lacking: Option<&'static str>,
    /// Name in running text.
    pub name: &'static str,
    /// Short name for narrow columns.
    pub short: &'static str,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Decimals in tables.
    pub decimals: usize,
    /// The kind of the measure: its range and its best value.
    pub judged: MeasureKind,
    /// Whether assets store the measure in `quality`.
    pub stored: bool,
    /// Whether `quality` must contain the measure. If this field and [`Self::left_out`] are both
    /// set, the asset's `left_out` object must also contain the measure.
    pub required: bool,
    /// Whether assets also store the measure in `left_out`.
    pub left_out: bool,
    /// Heading of the measure's column in printed tables.
    pub column: Option<&'static str>,
    /// Heading of the measure's column in printed tables, if it is computed from rendered samples.
    pub played: Option<&'static str>,
    /// Caption of the measure's table in reports. In the caption, `{}` stands for the name of the
    /// measured object.
    pub caption: Option<&'static str>,
}

/// The values that most rows share.
const STORED_ERROR: MeasureRow = MeasureRow {
    key: "",
    samples_key: "",
    meaning: "",
    of_samples: None,
    lacking: None,
    name: "",
    short: "",
    unit: "dB",
    decimals: 2,
    judged: MeasureKind::Error,
    stored: true,
    required: false,
    left_out: false,
    column: None,
    played: None,
    caption: None,
};

macro_rules! measures {
    ($(#[doc = $meaning:literal] $name:ident { key: $key:literal, $($field:ident: $value:expr,)* })*) => {
        /// A measure of how well a spectrum agrees with a recorded spectrum.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Measure {
            $(#[doc = $meaning] $name,)*
        }

        impl Measure {
            /// All measures, in their order in JSON.
            pub const ALL: [Self; [$(Self::$name),*].len()] = [$(Self::$name),*];
        }

        static ROWS: [MeasureRow; Measure::ALL.len()] = [$(MeasureRow {
            key: $key,
            samples_key: concat!("samples_", $key),
            meaning: $meaning.trim_ascii(),
            $($field: $value,)*
            ..STORED_ERROR
        }),*];
    };
}

measures! {
    /// Pearson correlation of the linear magnitudes, -1 to 1.
    SpectralCorrelation {
        key: "spectral_correlation",
        of_samples: Some("Spectral correlation of rendered samples."),
        name: "spectral correlation",
        short: "correlation",
        unit: "",
        decimals: 3,
        judged: MeasureKind::Correlation,
        required: true,
        column: Some("corr."),
        caption: Some("Spectral correlation with the recording (no unit; 1 is the best, dark)"),
    }
    /// RMS of the nine band errors, decibels.
    NineBand {
        key: "band_error_rms_db",
        of_samples: Some("Nine-band RMS error of rendered samples, decibels."),
        name: "nine-band error",
        short: "nine bands",
        required: true,
        left_out: true,
        column: Some("bands/dB"),
        played: Some("played/dB"),
        caption: Some("Nine-band error of the {}, RMS in dB (0 is the best, light)"),
    }
    /// RMS of the nine band errors, decibels, after a gain has made the total energies equal.
    NineBandMatched {
        key: "band_error_matched_rms_db",
        name: "nine-band error after one gain",
        short: "gain-matched",
        column: Some("gain-matched/dB"),
    }
    /// RMS error over third-octave bands, decibels.
    ThirdOctave {
        key: "third_octave_error_rms_db",
        of_samples: Some("Third-octave error of rendered samples, decibels."),
        lacking: Some("for a reference without energy in them"),
        name: "third-octave error",
        short: "third octaves",
        left_out: true,
        column: Some("third-oct/dB"),
        played: Some("played-3rd/dB"),
        caption: Some("Third-octave error of the {}, RMS in dB (0 is the best, light)"),
    }
    /// RMS, over the bins, of the differences between the magnitudes in decibels.
    LogSpectral {
        key: "log_spectral_distance_db",
        of_samples: Some("Log-spectral distance of rendered samples, decibels."),
        lacking: Some("for a silent reference"),
        name: "log-spectral distance",
        short: "log-spectral",
        column: Some("log-sp/dB"),
        played: Some("played-log/dB"),
        caption: Some("Log-spectral distance of the {}, RMS in dB (0 is the best, light)"),
    }
    /// Level in the band relative to the recording's, decibels.
    Level {
        key: "level_error_db",
        of_samples: Some("Level of rendered samples relative to the recording's, decibels."),
        name: "level error",
        short: "level",
        judged: MeasureKind::Difference,
        stored: false,
    }
    #[doc = " RMS over third-octave bands of the difference of what is above a fingertip's detection threshold, decibels."]
    Felt {
        key: "felt_error_rms_db",
        of_samples: Some("Felt difference of rendered samples, decibels."),
        name: "felt difference",
        short: "felt",
        stored: false,
        column: Some("felt/dB"),
        caption: Some("Felt difference of the {}: above the detection threshold, in third octaves, RMS in dB (0 is the best, light)"),
    }
}

impl Measure {
    /// Returns the measure's row.
    pub fn row(self) -> &'static MeasureRow {
        &ROWS[self as usize]
    }

    /// Returns the measures that assets store.
    pub fn stored() -> impl Iterator<Item = Self> + Clone {
        Self::ALL.into_iter().filter(|m| m.row().stored)
    }

    /// Returns the measures that are computed both from magnitudes and from rendered samples.
    pub fn of_both() -> impl Iterator<Item = Self> + Clone {
        Self::ALL.into_iter().filter(|m| m.row().of_samples.is_some())
    }

    /// Returns the key in JSON.
    pub fn key(self, by: By) -> &'static str {
        match by {
            By::Magnitude => self.row().key,
            By::Samples => self.row().samples_key,
        }
    }

    /// Returns a column heading with its unit, such as `third octaves / dB`.
    pub fn heading(self) -> String {
        match self.row() {
            MeasureRow { short, unit: "", .. } => (*short).to_owned(),
            MeasureRow { short, unit, .. } => format!("{short} / {unit}"),
        }
    }
}

/// A measure for the error of a representation, decibels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ErrorMeasure {
    /// RMS of the energy errors in nine overlapping bands.
    #[default]
    NineBand,
    /// RMS of the energy errors in third-octave bands.
    ThirdOctave,
    /// RMS of the difference between the magnitudes in decibels, over all frequency bins.
    LogSpectral,
}

impl ErrorMeasure {
    /// All error measures.
    pub const ALL: [Self; 3] = [Self::NineBand, Self::ThirdOctave, Self::LogSpectral];

    /// Returns this error measure as a [`Measure`].
    pub const fn measure(self) -> Measure {
        match self {
            Self::NineBand => Measure::NineBand,
            Self::ThirdOctave => Measure::ThirdOctave,
            Self::LogSpectral => Measure::LogSpectral,
        }
    }

    /// Returns the error by this measure, computed from the model's magnitudes. Returns `None` if
    /// the error was not measured.
    pub fn error_in(self, quality: &Quality) -> Option<f64> {
        quality.get(self.measure())
    }

    /// Returns the name used in scenes and in JSON, such as `nine_band`.
    pub const fn id(self) -> &'static str {
        match self {
            Self::NineBand => "nine_band",
            Self::ThirdOctave => "third_octave",
            Self::LogSpectral => "log_spectral",
        }
    }

    /// Returns the measure that has this name in scenes.
    pub fn find(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|measure| measure.id() == id)
    }

    /// Returns the name used in running text, such as `nine-band error`.
    pub fn name(self) -> &'static str {
        self.measure().row().name
    }
}

impl fmt::Display for ErrorMeasure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
