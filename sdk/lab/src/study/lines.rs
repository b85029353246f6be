//! Lines of a file of answers: JSON Lines, one line for each answer.

use std::collections::{BTreeMap, BTreeSet};

use htex_format::Quantity;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::record::Format;
use crate::study::file::Phase;
use crate::study::gain::GainKey;

/// Version of the files of answers.
pub(crate) const VERSION: &str = "1.0";

/// A line of a file of answers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Line {
    /// The first line of the file.
    Header(Box<Header>),
    /// The start of a session. A session with a simulated clock does not write this line, because a
    /// simulated clock has no date.
    Session(SessionStart),
    /// A key press while the level of a texture rises, in the training or in the gain matching. The
    /// level rises until the participant can feel the texture.
    Rise(Rise),
    /// A rating in the training, which is not a result.
    Training(Answer),
    /// A key press in the gain matching.
    Gain(GainPress),
    /// A stimulus was stopped before its end.
    Stopped(Stop),
    /// A rest that has ended.
    Rest {
        /// Number of trials before the rest.
        after: u32,
        /// Time, milliseconds.
        at_ms: u64,
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        simulated: bool,
    },
    /// A rating.
    Answer(Answer),
}

/// The first line of a file of answers: the study, the participant and the program to which the
/// answers belong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Version of this format.
    #[schemars(extend("const" = VERSION))]
    pub htex_answers: String,
    pub study: String,
    pub participant: String,
    /// BLAKE3 hashes, hexadecimal, of the study file and of all files that the study file names.
    pub files: BTreeMap<String, String>,
    pub device: DeviceUsed,
    /// Date and time in UTC at which the file was begun (`2026-11-25T10:25:25Z`). Absent if the
    /// clock is simulated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub begun: Option<String>,
    /// Number of ratings in a complete session.
    pub ratings: usize,
    /// The source from which the felt force is recorded. Absent if the felt force is not recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<SourceUsed>,
    /// The program that began the file.
    pub tool: String,
    /// Seed and rule of a simulated participant. Absent if the participant is a person.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulated: Option<Simulated>,
}

/// A simulated participant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Simulated {
    /// Seed for the ratings of the simulated participant.
    pub seed: u64,
    /// The rule by which the simulated participant rates.
    pub rule: String,
}

/// The start of a session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SessionStart {
    /// Date and time in UTC: `2026-11-25T10:25:25Z`.
    pub date: String,
    /// Time, milliseconds, counted in the same way as `at_ms` in lines of the kind `answer`.
    pub at_ms: u64,
    pub device: DeviceUsed,
    /// Program and version.
    pub tool: String,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
}

/// The device of a session and its settings.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeviceUsed {
    pub adapter: String,
    /// Profile of the device; empty if none is used.
    pub profile: String,
    /// All settings of the device, such as the gain of an amplifier. They include the settings from
    /// the profile and the default values. Two kinds of settings are left out: the names of the
    /// files to which the device writes the samples of a trial, and `buffer_ms` if the motion is
    /// not live. If the motion is not live, a participant cannot feel the length of the buffer.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub settings: BTreeMap<String, String>,
    /// Largest absolute value that the device accepts, in the device's unit (volts for a display).
    /// Absent without a limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Number of device units that correspond to one unit of the assets' quantity. Absent if device
    /// and assets have the same quantity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quantity_gain: Option<f64>,
}

impl DeviceUsed {
    /// Compares the device `now` with this earlier device, and returns the differences as phrases.
    pub(crate) fn differences(&self, now: &Self) -> Vec<String> {
        let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        let values = |of: &Self| -> BTreeMap<String, String> {
            let own = [
                ("adapter", of.adapter.clone()),
                ("profile", of.profile.clone()),
                ("limit", number(of.limit)),
                ("quantity gain", number(of.quantity_gain)),
            ]
            .map(|(name, value)| (name.to_owned(), value));
            let settings =
                of.settings.iter().map(|(name, value)| (format!("setting {name}"), value.clone()));
            own.into_iter().chain(settings).collect()
        };
        let (was, is) = (values(self), values(now));
        let names: BTreeSet<&String> = was.keys().chain(is.keys()).collect();
        let shown = |of: &BTreeMap<String, String>, name: &String| {
            let value = of.get(name).filter(|value| !value.is_empty());
            value.map_or("not set".to_owned(), String::clone)
        };
        let differs = names.into_iter().filter(|name| was.get(*name) != is.get(*name));
        differs
            .map(|name| {
                format!(
                    "the device's {name} was {}, and is {}",
                    shown(&was, name),
                    shown(&is, name)
                )
            })
            .collect()
    }
}

/// The source from which a session records the felt force, and the settings of the recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SourceUsed {
    /// The source, as the user named it: `daq:Dev1/ai0:5`.
    pub name: String,
    /// Settings of the source, as the user gave them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub settings: BTreeMap<String, String>,
    /// The channel map (which channel carries which signal); absent if the user gave none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<String>,
    /// Calibration matrices, row by row.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub calibrations: Vec<Vec<f64>>,
    /// Quantity of the texture's signal.
    pub quantity: Quantity,
    /// Sample rate, hertz.
    pub rate_hz: f64,
    /// Recorded signals: role and unit.
    pub signals: Vec<(String, String)>,
    /// Role and unit of each signal of the tracker, except the time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tracker: Vec<(String, String)>,
    pub format: Format,
}

/// A recording of the force on the participant's finger in a trial.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FeltFile {
    /// Path of the recording in the folder of answers, with `/` between folders:
    /// `P07/felt/trial-0017-vinyl-ar.npy`.
    pub file: String,
    /// BLAKE3 hash of the recording, hexadecimal.
    pub blake3: String,
    /// One phrase for each difference of more than 10 % between the measured speed or force and the
    /// study's motion. Absent if no difference exceeds this limit, or if the study sets no target.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub off_target: Vec<String>,
    /// Whether speed or force was measured and compared with the study's motion. Absent if neither
    /// the speed nor the force was compared.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub compared: bool,
}

impl FeltFile {
    /// Returns whether the motion left the study's target, or `None` if neither speed nor force was
    /// measured.
    pub(crate) fn is_off_target(&self) -> Option<bool> {
        if self.off_target.is_empty() { self.compared.then_some(false) } else { Some(true) }
    }
}

/// A rating.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    /// Number of the trial within its phase, from 1.
    pub number: u32,
    pub texture: String,
    pub model: String,
    /// Repetition, from 1.
    pub repetition: u32,
    /// Whether the model is the hidden reference.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub hidden_reference: bool,
    /// The attribute that was rated.
    pub attribute: String,
    pub rating: u8,
    /// Time from the question to the answer, milliseconds.
    pub response_ms: u64,
    /// Time of the answer, milliseconds since 1970 in UTC. If the clock is simulated, the
    /// milliseconds count from the start of the session.
    pub at_ms: u64,
    /// Gain with which the stimulus was played, decibels relative to the maximum. Absent without
    /// gain matching.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_db: Option<f64>,
    /// Drive of the display at which the stimulus was played, volts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive_v: Option<f64>,
    /// Levels of the samples that were written to the device. Absent in files that earlier versions
    /// of htex wrote.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output: Option<OutputLevels>,
    /// How many times the trial was stopped before its end, for any reason. This is the number of
    /// lines of the kind `stopped` directly before this line.
    #[serde(default)]
    pub stops: u32,
    /// How many earlier attempts of the trial failed because the device ran out of samples.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub repeats: u32,
    /// The recording of the felt force. Absent if there is no source.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub felt: Option<FeltFile>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
}

/// A key press in the gain matching.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GainPress {
    pub texture: String,
    pub key: GainKey,
    /// The gain after the key press, decibels relative to the maximum.
    pub gain_db: f64,
    /// Whether the matching ended with this key press. If so, `gain_db` is the gain of the texture
    /// from now on.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub found: bool,
    /// Drive of the display at which the texture was felt before the key press, volts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive_v: Option<f64>,
    /// Levels of the samples that were written to the device before the key press. Absent in files
    /// that earlier versions of htex wrote.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output: Option<OutputLevels>,
    /// How many times the texture was stopped between the previous key press and this one. The stop
    /// that the previous key press caused does not count.
    #[serde(default)]
    pub stops: u32,
    /// Reference level: the RMS that is mapped to the device's drive voltage or preview level, in
    /// the assets' unit.
    pub reference_rms: f64,
    /// Time, milliseconds, counted in the same way as `at_ms` in lines of the kind `answer`.
    pub at_ms: u64,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
}

/// A key press while the level of a texture rises.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rise {
    /// The phase: training or gain.
    pub phase: Phase,
    pub texture: String,
    /// The model that plays the texture.
    pub model: String,
    pub key: GainKey,
    /// The level after the key press, decibels relative to the maximum.
    pub gain_db: f64,
    /// Whether the participant stated with this key press that the texture can be felt.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub found: bool,
    /// Drive of the display before the key press, volts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive_v: Option<f64>,
    /// Levels of the samples that were written to the device before the key press.
    pub output: OutputLevels,
    /// How many times the texture was stopped between the previous key press and this one. The stop
    /// that the previous key press caused does not count.
    #[serde(default)]
    pub stops: u32,
    /// Reference level: the RMS that is mapped to the device's drive voltage or preview level, in
    /// the assets' unit.
    pub reference_rms: f64,
    /// Time, milliseconds, counted in the same way as `at_ms` in lines of the kind `answer`.
    pub at_ms: u64,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
}

/// Levels of the samples that were written to a device while a stimulus played.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputLevels {
    /// Unit of the levels, such as `V` for a display.
    pub unit: String,
    /// Largest magnitude.
    pub peak: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// DC component: the mean is computed over every window of 100 ms, and this is the largest
    /// absolute value of these means. The time before the start counts as silence.
    pub direct: f64,
    /// Length, seconds.
    pub duration_s: f64,
}

/// A stimulus that was stopped before its end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    pub phase: Phase,
    pub texture: String,
    pub model: String,
    pub reason: StopReason,
    /// Gain with which the stimulus was played, decibels relative to the maximum. Absent without
    /// gain matching.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_db: Option<f64>,
    /// Drive of the display, volts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive_v: Option<f64>,
    /// Levels of the samples that were written to the device. Absent if the device was not opened.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output: Option<OutputLevels>,
    /// Time, milliseconds, counted in the same way as `at_ms` in lines of the kind `answer`.
    pub at_ms: u64,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
}

/// Why a stimulus was stopped before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StopReason {
    /// The participant or the experimenter left the session.
    Left,
    /// The program was asked to end, or the input that delivers the finger's motion ended.
    Interrupted,
    /// The device ran out of samples.
    RanDry,
    /// The device, the renderer or the source reported an error.
    Failed,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // As serde calls it.
fn is_zero(count: &u32) -> bool {
    *count == 0
}

impl Line {
    /// Parses a line.
    ///
    /// # Errors
    /// Returns a text that states what is wrong: the line is not a line of answers, has unknown
    /// keys or invalid values, or is a header of another version.
    pub fn parse(text: &[u8]) -> Result<Self, String> {
        let line: Self = serde_json::from_slice(text).map_err(|error| error.to_string())?;
        match &line {
            Self::Header(header) if header.htex_answers != VERSION => Err(format!(
                "the file has version {}, and this htex reads {VERSION}",
                header.htex_answers
            )),
            _ => Ok(line),
        }
    }

    /// Returns the time of the line, milliseconds, or 0 for the header.
    pub fn at_ms(&self) -> u64 {
        match self {
            Self::Header(_) => 0,
            Self::Session(began) => began.at_ms,
            Self::Training(answer) | Self::Answer(answer) => answer.at_ms,
            Self::Rise(rise) => rise.at_ms,
            Self::Gain(matched) => matched.at_ms,
            Self::Stopped(stopped) => stopped.at_ms,
            Self::Rest { at_ms, .. } => *at_ms,
        }
    }
}

/// Returns the JSON Schema of a line of answers, version 1.0: `spec/schemas/answers-1.json`.
pub fn answers_schema() -> serde_json::Value {
    htex_base::schema::crossing::<Line>("answers-1.json", "line of a file of answers of htex 1")
}
