//! The measures of the agreement of a spectrum with a recorded one, a row each. The keys of
//! `quality` with their checks, schema and rounding, the columns of tables and reports, and the
//! documents come from these rows; `htex-author` has the function of each.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::Quality;

/// What the values of a measure mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judged {
    /// From -1 to 1; 1 is the best.
    Correlation,
    /// Not negative; 0 is the best.
    Error,
    /// With a sign; 0 is the best.
    Difference,
}

impl Judged {
    /// Whether a measure can have this value.
    pub fn accepts(self, value: f64) -> bool {
        match self {
            Self::Correlation => (-1.0..=1.0).contains(&value),
            Self::Error => value.is_finite() && value >= 0.0,
            Self::Difference => value.is_finite(),
        }
    }
}

/// What a measure is taken of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// The model's magnitudes, as a recording of its voice reads them.
    Magnitude,
    /// The spectrum of rendered samples.
    Samples,
}

/// A row of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasureRow {
    /// Key in JSON.
    pub key: &'static str,
    /// Key in JSON if it is measured from rendered samples: `samples_` and the key.
    pub samples_key: &'static str,
    /// Definition, a sentence.
    pub meaning: &'static str,
    /// The same for rendered samples; `None` if they are not measured.
    pub of_samples: Option<&'static str>,
    /// When a comparison does not have it, after "`None` "; `None` if every comparison has.
    pub lacking: Option<&'static str>,
    /// Name in running text.
    pub name: &'static str,
    /// Name where there is little space.
    pub short: &'static str,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Decimals in tables.
    pub decimals: usize,
    /// What its values mean.
    pub judged: Judged,
    /// Whether assets store it in `quality`.
    pub stored: bool,
    /// Whether each `quality` and `left_out` that may have it must have it.
    pub required: bool,
    /// Whether assets store it in `left_out`, too.
    pub left_out: bool,
    /// Heading of its column in text.
    pub column: Option<&'static str>,
    /// Heading of its column in text, of rendered samples.
    pub played: Option<&'static str>,
    /// Caption of its table in reports, with `{}` for what is measured.
    pub caption: Option<&'static str>,
}

/// What most rows have.
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
    judged: Judged::Error,
    stored: true,
    required: false,
    left_out: false,
    column: None,
    played: None,
    caption: None,
};

macro_rules! measures {
    ($(#[doc = $meaning:literal] $name:ident { key: $key:literal, $($field:ident: $value:expr,)* })*) => {
        /// A measure of the agreement of a spectrum with a recorded one.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Measure {
            $(#[doc = $meaning] $name,)*
        }

        impl Measure {
            /// All measures, in the order of JSON.
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
        judged: Judged::Correlation,
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
    /// RMS of the nine band errors after one gain that equalises the total energy, decibels.
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
    /// RMS over the bins of the difference of the magnitudes in decibels.
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
        judged: Judged::Difference,
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

    /// Returns the measures that are taken of magnitudes and of rendered samples.
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

    /// Returns the heading of a column with a unit, `third octaves / dB`.
    pub fn heading(self) -> String {
        match self.row() {
            MeasureRow { short, unit: "", .. } => (*short).to_owned(),
            MeasureRow { short, unit, .. } => format!("{short} / {unit}"),
        }
    }
}

/// A measure of the error of a representation, decibels.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum ErrorMeasure {
    /// RMS of the energy errors of nine overlapping bands.
    #[default]
    NineBand,
    /// RMS of the energy errors of third-octave bands.
    ThirdOctave,
    /// RMS over the bins of the difference of the magnitudes in decibels.
    LogSpectral,
}

impl ErrorMeasure {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::NineBand, Self::ThirdOctave, Self::LogSpectral];

    /// Returns the measure.
    pub const fn measure(self) -> Measure {
        match self {
            Self::NineBand => Measure::NineBand,
            Self::ThirdOctave => Measure::ThirdOctave,
            Self::LogSpectral => Measure::LogSpectral,
        }
    }

    /// Returns the error by this measure, from the model's magnitudes; `None` if it was not
    /// measured.
    pub fn of(self, quality: &Quality) -> Option<f64> {
        quality.get(self.measure())
    }

    /// Returns the name in scenes and in JSON: `nine_band`.
    pub const fn id(self) -> &'static str {
        match self {
            Self::NineBand => "nine_band",
            Self::ThirdOctave => "third_octave",
            Self::LogSpectral => "log_spectral",
        }
    }

    /// Returns the measure with a name in scenes.
    pub fn find(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|measure| measure.id() == id)
    }

    /// Returns the name in running text: `nine-band error`.
    pub fn name(self) -> &'static str {
        self.measure().row().name
    }
}

impl fmt::Display for ErrorMeasure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
