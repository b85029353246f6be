//! Settings for measuring a response. The settings are flags of the command line and keywords of
//! the Python package.

use htex_base::finding::Hint;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::Estimator;
use crate::error::LabError;

/// Smallest number of samples in a window.
const FEWEST_SAMPLES: f64 = 16.0;

/// Settings for the measurement of a frequency response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct ResponseSettings {
    /// Estimator of the response. Use h1 if the output has noise, h2 if the input has noise, and hv
    /// (total least squares) if both have noise
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value = "h1"))]
    pub estimator: Estimator,

    /// Length of a window, s. htex transforms the recording in windows of this length, so that the
    /// response has a value every 1/length Hz. If the length is a multiple of 0.2 s, these
    /// frequencies include the frequencies of texture spectra, which are 5 Hz apart
    #[cfg_attr(feature = "clap", arg(long = "window", value_name = "S", default_value_t = 1.0))]
    pub window_s: f64,

    /// Lowest frequency of the response, Hz
    #[cfg_attr(feature = "clap", arg(long = "low", value_name = "HZ", default_value_t = 20.0))]
    pub low_hz: f64,

    /// Highest frequency of the response, Hz. If half of the sample rate is lower, the response
    /// ends at half of the sample rate
    #[cfg_attr(feature = "clap", arg(long = "high", value_name = "HZ", default_value_t = 1000.0))]
    pub high_hz: f64,

    /// Count the input as overloaded where its magnitude reaches this value. By default, a hit is
    /// overloaded if it has four equal samples in a row at the input's highest or lowest value, and
    /// the input of a continuous drive is not checked
    #[cfg_attr(feature = "clap", arg(long, value_name = "VALUE"))]
    pub input_limit: Option<f64>,

    /// Count the output as overloaded where its magnitude reaches this value. By default, four
    /// equal samples in a row at the output's highest or lowest value count as an overload
    #[cfg_attr(feature = "clap", arg(long, value_name = "VALUE"))]
    pub output_limit: Option<f64>,

    /// Measure with a continuous drive, such as noise or a sweep, instead of the hits of a hammer.
    /// htex then uses Hann windows, each of which overlaps the previous one by half
    #[cfg_attr(feature = "clap", arg(
        long,
        conflicts_with_all = ["pre_trigger_s", "trigger", "double", "force_window_s", "exponential_s"]
    ))]
    pub continuous: bool,

    /// For hits: time by which each window begins before the trigger, s. htex subtracts the mean of
    /// the samples before the trigger from the window [default: 0.02]
    #[cfg_attr(feature = "clap", arg(long = "pre-trigger", value_name = "S"))]
    pub pre_trigger_s: Option<f64>,

    /// For hits: level at which a hit starts, as a fraction of the largest input of the recording
    /// [default: 0.1]
    #[cfg_attr(feature = "clap", arg(long, value_name = "PART"))]
    pub trigger: Option<f64>,

    /// For hits: smallest size of a second contact, as a fraction of the hit. htex discards a hit
    /// if its window has such a second contact (double hit) [default: 0.1]
    #[cfg_attr(feature = "clap", arg(long, value_name = "PART"))]
    pub double: Option<f64>,

    /// For hits: time after the trigger at which htex begins to fade the input to zero, s. The fade
    /// removes the noise between hits
    #[cfg_attr(feature = "clap", arg(long = "force-window", value_name = "S"))]
    pub force_window_s: Option<f64>,

    /// For hits: time constant of an exponential window, s. htex multiplies both channels by this
    /// window. Use it if responses last longer than the window; the measured damping rises by the
    /// inverse of the time constant
    #[cfg_attr(feature = "clap", arg(long = "exponential", value_name = "S"))]
    pub exponential_s: Option<f64>,
}

/// How the hits of a hammer are found and cut out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct HitSettings {
    /// Length of the part of the window before the trigger, seconds. The mean of each channel over
    /// this part is removed.
    pub(crate) pre_trigger_s: f64,
    /// Level at which a hit starts, relative to the largest input of its recording. This level is
    /// raised to 8 times the noise if it is lower.
    pub(crate) trigger: f64,
    /// A hit counts as a double hit if a second contact in the window has at least this size,
    /// relative to the hit. This size is raised to 8 times the noise if it is smaller.
    pub(crate) double: f64,
    /// Force window, seconds. The input is kept until this time after the trigger. It then fades to
    /// zero over a quarter of this time (half a cosine). This removes the noise of the input
    /// between hits.
    pub(crate) force_window_s: Option<f64>,
    /// Exponential window: time constant, seconds. After the trigger, both channels are multiplied
    /// by `exp(-t / this)`. With this, a response that would outlast the window ends within the
    /// window. The damping of responses rises by the inverse of the time constant, in 1/s.
    pub(crate) exponential_s: Option<f64>,
}

impl Default for ResponseSettings {
    /// Returns the default settings: hits, H1, windows of 1 s, 20 to 1000 Hz.
    fn default() -> Self {
        Self {
            estimator: Estimator::H1,
            window_s: 1.0,
            low_hz: 20.0,
            high_hz: 1000.0,
            input_limit: None,
            output_limit: None,
            continuous: false,
            pre_trigger_s: None,
            trigger: None,
            double: None,
            force_window_s: None,
            exponential_s: None,
        }
    }
}

impl ResponseSettings {
    /// Returns how hits are found and cut out, or `None` for a continuous drive.
    pub(crate) fn hits(&self) -> Option<HitSettings> {
        (!self.continuous).then(|| HitSettings {
            pre_trigger_s: self.pre_trigger_s.unwrap_or(0.02),
            trigger: self.trigger.unwrap_or(0.1),
            double: self.double.unwrap_or(0.1),
            force_window_s: self.force_window_s,
            exponential_s: self.exponential_s,
        })
    }

    /// Returns the settings as JSON, with default values filled in. The settings for hits are in
    /// `excitation.hits`. For a continuous drive, `excitation` is `continuous`.
    pub fn resolved(&self) -> Value {
        let excitation = self.hits().map_or(json!("continuous"), |hits| json!({ "hits": hits }));
        json!({
            "excitation": excitation,
            "estimator": self.estimator,
            "window_s": self.window_s,
            "low_hz": self.low_hz,
            "high_hz": self.high_hz,
            "input_limit": self.input_limit,
            "output_limit": self.output_limit,
        })
    }

    /// Returns the number of samples in a window. Returns an error for settings with which no
    /// recording can be measured.
    pub(crate) fn check(&self, rate_hz: f64) -> Result<usize, LabError> {
        let samples = (self.window_s * rate_hz).round();
        require(
            ("the window (s)", &["window"]),
            self.window_s,
            (FEWEST_SAMPLES..1e15).contains(&samples),
            &format!("a window needs {FEWEST_SAMPLES} samples or more, at {rate_hz} Hz"),
        )?;
        require(
            ("the lowest frequency (Hz)", &["low"]),
            self.low_hz,
            self.low_hz >= 0.0 && self.low_hz < rate_hz / 2.0,
            "it must be 0 or more, and below half of the sample rate",
        )?;
        require(
            ("the highest frequency (Hz)", &["high"]),
            self.high_hz,
            self.high_hz > self.low_hz && self.high_hz.is_finite(),
            "it must be finite and above the lowest",
        )?;
        positive(("the limit of the input", &["input_limit"]), self.input_limit)?;
        positive(("the limit of the output", &["output_limit"]), self.output_limit)?;
        if let Some(hits) = self.hits() {
            hits.check(self.window_s)?;
        }
        Ok(samples as usize)
    }
}

impl HitSettings {
    fn check(&self, window_s: f64) -> Result<(), LabError> {
        require(
            ("the time before the trigger (s)", &["pre_trigger"]),
            self.pre_trigger_s,
            (0.0..0.5 * window_s).contains(&self.pre_trigger_s),
            "it must be 0 or more, and below half of the window",
        )?;
        let trigger: SettingName = ("the trigger", &["trigger"]);
        for (option, level) in
            [(trigger, self.trigger), (("the level of a double hit", &["double"]), self.double)]
        {
            let is_relative = level > 0.0 && level < 1.0;
            require(option, level, is_relative, "it is relative and must be between 0 and 1")?;
        }
        positive(("the force window (s)", &["force_window"]), self.force_window_s)?;
        positive(("the exponential window (s)", &["exponential"]), self.exponential_s)
    }
}

/// The description of a setting, and its name.
type SettingName = (&'static str, &'static [&'static str; 1]);

fn positive(option: SettingName, value: Option<f64>) -> Result<(), LabError> {
    let value = value.unwrap_or(1.0);
    require(option, value, value.is_finite() && value > 0.0, "it must be finite and above 0")
}

fn require(
    (option, name): SettingName,
    value: f64,
    holds: bool,
    problem: &str,
) -> Result<(), LabError> {
    if holds {
        return Ok(());
    }
    Err(LabError::Option { option, hint: Hint::new(name), value, problem: problem.to_owned() })
}

#[cfg(feature = "clap")]
impl clap::ValueEnum for Estimator {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self::H1, Self::H2, Self::Hv]
    }

    fn to_possible_value(&self) -> Option<clap::builder::PossibleValue> {
        Some(match self {
            Self::H1 => "h1".into(),
            Self::H2 => "h2".into(),
            Self::Hv => "hv".into(),
        })
    }
}
