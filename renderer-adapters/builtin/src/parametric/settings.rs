//! The settings in parsed form.

use crate::motor::{DEFAULT_GAIN, Plan, reducing_settings};
use htex_device::{DeviceError, Setting, SettingKind, Settings};

use crate::parametric::session::Hand;
use crate::parametric::structures::FREQUENCIES_HZ;

/// What is passed to the runtime or vibrator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    Points,
    Pcm,
    Pwle,
}

/// Settings that have been checked against each other.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlayRequest {
    pub(crate) runtime: String,
    pub(crate) form: Form,
    pub(crate) hand: Hand,
    pub(crate) plan: Plan,
    /// Lowest and highest frequency of points, hertz.
    pub(crate) range_hz: Option<(f64, f64)>,
}

pub(crate) fn all() -> Vec<Setting> {
    let hz = SettingKind::Number { min: 0.0, max: FREQUENCIES_HZ.1 };
    let mut all = vec![
        Setting::hardware(
            "runtime",
            SettingKind::Text,
            "",
            "Library of an OpenXR runtime or loader: a file, or a name that the system's loader finds. Empty: the installed loader.",
        ),
        Setting::hardware(
            "form",
            SettingKind::choice(&["points", "pcm", "pwle"]),
            "points",
            "What is played. points: an amplitude and a frequency for each block. pcm: samples at \
             the controller's rate. pwle: envelopes on the vibrator of an application; `runtime` \
             then names the application's library.",
        ),
        Setting::hardware(
            "hand",
            SettingKind::choice(&["left", "right"]),
            "right",
            "The controller that plays.",
        ),
        Setting::hardware(
            "low_hz",
            hz.clone(),
            "0",
            "Only for form=points: lowest frequency of the points, hertz, 1 to 1000. 0: the lowest frequency that the controller states, else 50.",
        ),
        Setting::hardware(
            "high_hz",
            hz,
            "0",
            "Only for form=points: highest frequency of the points, hertz, 1 to 1000. 0: the highest frequency that the controller states, else 500.",
        ),
    ];
    all.extend(reducing_settings());
    all
}

impl PlayRequest {
    /// Reads the settings.
    ///
    /// # Errors
    /// Returns an error if a setting would have no effect in combination with the other settings.
    pub(crate) fn new(settings: &Settings) -> Result<Self, DeviceError> {
        let form = match settings.text("form") {
            "pcm" => Form::Pcm,
            "pwle" => Form::Pwle,
            _ => Form::Points,
        };
        let range_hz = range(settings)?;
        let hand = match settings.text("hand") {
            "left" => Hand::Left,
            _ => Hand::Right,
        };
        if form != Form::Points && range_hz.is_some() {
            return refuse("low_hz", "it is the range of points, for form=points");
        }
        if form == Form::Pcm && settings.text("gain") != DEFAULT_GAIN {
            return refuse(
                "gain",
                "samples are played as they are; it is for form=points and form=pwle",
            );
        }
        if form == Form::Pwle && hand != Hand::Right {
            return refuse("hand", "a vibrator is in no hand; it is for form=points and form=pcm");
        }
        Ok(Self {
            runtime: settings.text("runtime").to_owned(),
            form,
            hand,
            plan: Plan::new(settings),
            range_hz,
        })
    }
}

fn range(settings: &Settings) -> Result<Option<(f64, f64)>, DeviceError> {
    let (low, high) = (settings.number("low_hz"), settings.number("high_hz"));
    match (low, high) {
        (0.0, 0.0) => Ok(None),
        (0.0, _) => refuse("low_hz", "high_hz is given, and this one belongs to it"),
        (_, 0.0) => refuse("high_hz", "low_hz is given, and this one belongs to it"),
        _ if low < FREQUENCIES_HZ.0 => refuse("low_hz", "it is 0, or from 1 to 1000 Hz"),
        _ if high < low => refuse("high_hz", "it is below low_hz"),
        _ => Ok(Some((low, high))),
    }
}

fn refuse<T>(name: &str, what: &str) -> Result<T, DeviceError> {
    Err(DeviceError::setting(name, what))
}
