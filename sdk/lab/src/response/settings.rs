//! Settings of measuring a response by name, for the command's flags and the Python package's
//! keywords.

use serde::{Deserialize, Serialize};

use super::{Estimator, Excitation, HitOptions, ResponseOptions};

/// Settings of measuring a response. An absent setting has its default.
///
/// ```
/// use htex_lab::response::{ResponseOptions, ResponseSettings};
/// let usual = ResponseOptions::from(&ResponseSettings::default());
/// assert_eq!(usual, ResponseOptions::default());
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct ResponseSettings {
    /// h1: for noise in the output; h2: for noise in the input; hv: for noise in both (total least
    /// squares)
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value = "h1"))]
    pub estimator: Estimator,

    /// Length of the part of the recording that is transformed, s. The frequency grid of the
    /// response is its inverse; with multiples of 0.2, it contains the 5 Hz grid of texture spectra
    #[cfg_attr(feature = "clap", arg(long = "window", value_name = "S", default_value_t = 1.0))]
    pub window_s: f64,

    /// Lowest frequency, Hz
    #[cfg_attr(feature = "clap", arg(long = "low", value_name = "HZ", default_value_t = 20.0))]
    pub low_hz: f64,

    /// Highest frequency, Hz; half of the sample rate if that is lower
    #[cfg_attr(feature = "clap", arg(long = "high", value_name = "HZ", default_value_t = 1000.0))]
    pub high_hz: f64,

    /// Magnitude of the input at which its sensor or amplifier is overloaded. Without it, four
    /// equal samples in a row at the highest or lowest value count as an overload
    #[cfg_attr(feature = "clap", arg(long, value_name = "VALUE"))]
    pub input_limit: Option<f64>,

    /// The same for the output
    #[cfg_attr(feature = "clap", arg(long, value_name = "VALUE"))]
    pub output_limit: Option<f64>,

    /// The input is a drive without pauses (noise, a sweep): use windows with half overlap and a
    /// Hann window
    #[cfg_attr(feature = "clap", arg(
        long,
        conflicts_with_all = ["pre_trigger_s", "trigger", "double", "force_window_s", "exponential_s"]
    ))]
    pub continuous: bool,

    /// Hits: time before the trigger that belongs to the window, s; the mean of that part is
    /// removed [default: 0.02]
    #[cfg_attr(feature = "clap", arg(long = "pre-trigger", value_name = "S"))]
    pub pre_trigger_s: Option<f64>,

    /// Hits: level at which one starts, relative to the largest input of the recording [default:
    /// 0.1]
    #[cfg_attr(feature = "clap", arg(long, value_name = "PART"))]
    pub trigger: Option<f64>,

    /// Hits: size of a second contact that makes a double hit, relative to the hit [default: 0.1]
    #[cfg_attr(feature = "clap", arg(long, value_name = "PART"))]
    pub double: Option<f64>,

    /// Hits: time after the trigger at which the input fades to zero, s; removes noise between hits
    #[cfg_attr(feature = "clap", arg(long = "force-window", value_name = "S"))]
    pub force_window_s: Option<f64>,

    /// Hits: time constant of an exponential window on both channels, s, for responses that outlast
    /// the window. It raises their damping by its inverse
    #[cfg_attr(feature = "clap", arg(long = "exponential", value_name = "S"))]
    pub exponential_s: Option<f64>,
}

impl Default for ResponseSettings {
    fn default() -> Self {
        let usual = ResponseOptions::default();
        Self {
            estimator: usual.estimator,
            window_s: usual.window_s,
            low_hz: usual.low_hz,
            high_hz: usual.high_hz,
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

impl From<&ResponseSettings> for ResponseOptions {
    fn from(settings: &ResponseSettings) -> Self {
        let usual = HitOptions::default();
        let hits = HitOptions {
            pre_trigger_s: settings.pre_trigger_s.unwrap_or(usual.pre_trigger_s),
            trigger: settings.trigger.unwrap_or(usual.trigger),
            double: settings.double.unwrap_or(usual.double),
            force_window_s: settings.force_window_s,
            exponential_s: settings.exponential_s,
        };
        Self {
            excitation: if settings.continuous {
                Excitation::Continuous
            } else {
                Excitation::Hits(hits)
            },
            estimator: settings.estimator,
            window_s: settings.window_s,
            low_hz: settings.low_hz,
            high_hz: settings.high_hz,
            input_limit: settings.input_limit,
            output_limit: settings.output_limit,
        }
    }
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
