//! Lines of a file of answers: JSON Lines, one line an answer.

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
    /// The first line.
    Header(Box<Header>),
    /// A session begins; sessions with a simulated clock, which has no date, are not marked.
    Session(Began),
    /// A key press while the level of a texture rises, before it is felt; in the training and in
    /// the gain matching.
    Rise(Rise),
    /// A rating in the training, which is not a result.
    Training(Answer),
    /// A key press of the gain matching.
    Gain(Matched),
    /// Something that played ended before its time.
    Stopped(Stopped),
    /// A rest that is over.
    Rest {
        /// Trials before it.
        after: u32,
        /// Time, milliseconds.
        at_ms: u64,
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        simulated: bool,
    },
    /// A rating.
    Answer(Answer),
}

/// The first line: what the answers belong to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Version of this format.
    #[schemars(extend("const" = VERSION))]
    pub htex_answers: String,
    pub study: String,
    pub participant: String,
    /// BLAKE3 hashes, hexadecimal, of the study's file and of all files that it names.
    pub files: BTreeMap<String, String>,
    pub device: DeviceUsed,
    /// Date and time in UTC at which the file was begun (`2026-11-25T10:25:25Z`); absent with a
    /// simulated clock.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub begun: Option<String>,
    /// Ratings of a complete session.
    pub ratings: usize,
    /// The source from which the felt force is recorded; absent if it is not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<SourceUsed>,
    /// The program that began the file.
    pub tool: String,
    /// The seed of a simulated participant; absent for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulated: Option<Simulated>,
}

/// A simulated participant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Simulated {
    /// Seed of its ratings.
    pub seed: u64,
    /// The rule of its ratings.
    pub rule: String,
}

/// The beginning of a session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Began {
    /// Date and time in UTC: `2026-11-25T10:25:25Z`.
    pub date: String,
    /// Time, milliseconds, as in ratings.
    pub at_ms: u64,
    pub device: DeviceUsed,
    /// The program.
    pub tool: String,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
}

/// The device of a session, as it was set.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeviceUsed {
    pub adapter: String,
    /// Its profile; empty if there is none.
    pub profile: String,
    /// All its settings, such as the gain of an amplifier: given ones, those of the profile and
    /// defaults. Left out are names of files that a trial is played to, and `buffer_ms` where the
    /// motion is not live: then nobody feels how long samples wait.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub settings: BTreeMap<String, String>,
    /// Largest magnitude that it takes, in its unit (of a display volts); absent without a limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Units of the device for one of the assets' quantity, where they differ.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quantity_gain: Option<f64>,
}

impl DeviceUsed {
    /// What differs in another one, each a phrase; this one was before.
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

/// The source of a session's felt forces, and how they are recorded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SourceUsed {
    /// The source, as it was named: `daq:Dev1/ai0:5`.
    pub name: String,
    /// Its settings, as they were given.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub settings: BTreeMap<String, String>,
    /// The map of channels, if one was given.
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
    /// Signals of the tracker, without the time: role and unit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tracker: Vec<(String, String)>,
    pub format: Format,
}

/// A recording of what was felt in a trial.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FeltFile {
    /// The recording in the folder of answers, with `/` between folders:
    /// `P07/felt/trial-0017-vinyl-ar.npy`.
    pub file: String,
    /// BLAKE3 hash of the recording, hexadecimal.
    pub blake3: String,
    /// How speed or force left the study's motion by more than 10 %, each a phrase; absent if they
    /// did not, or have no target.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub off_target: Vec<String>,
    /// Whether speed or force was measured and compared with the study's motion; absent if neither
    /// was.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub compared: bool,
}

impl FeltFile {
    /// Whether the motion was off the study's target; `None` where nothing was measured to tell it.
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
    /// What was rated.
    pub attribute: String,
    pub rating: u8,
    /// Time from the question to the answer, milliseconds.
    pub response_ms: u64,
    /// Time of the answer, milliseconds since 1970 in UTC; of a simulated clock since the start of
    /// the session.
    pub at_ms: u64,
    /// Gain that it was played with, decibels relative to the maximum; absent without gain
    /// matching.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_db: Option<f64>,
    /// Drive of a display at which it was played, volts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive_v: Option<f64>,
    /// What the device was given; absent in files of an earlier htex.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output: Option<OutputLevels>,
    /// How often it was stopped before its end, by anything, since the line before that is no stop.
    #[serde(default)]
    pub stops: u32,
    /// How often the trial was begun before and not felt to its end, because the device ran dry.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub repeats: u32,
    /// The recording of what was felt; absent without a source.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub felt: Option<FeltFile>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
}

/// A key press of the gain matching.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Matched {
    pub texture: String,
    pub key: GainKey,
    /// The gain after it, decibels relative to the maximum.
    pub gain_db: f64,
    /// Whether this is the texture's gain from now on.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub found: bool,
    /// Drive of a display at which the texture was felt before the key, volts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive_v: Option<f64>,
    /// What the device was given before the key; absent in files of an earlier htex.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output: Option<OutputLevels>,
    /// How often it was stopped before the key, by anything but the keys of the line before.
    #[serde(default)]
    pub stops: u32,
    /// RMS that had this drive, in the assets' unit.
    pub reference_rms: f64,
    /// Time, milliseconds, as in ratings.
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
    /// The model in which it plays.
    pub model: String,
    pub key: GainKey,
    /// The level after it, decibels relative to the maximum.
    pub gain_db: f64,
    /// Whether the participant feels the texture at this level.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub found: bool,
    /// Drive of a display before the key, volts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive_v: Option<f64>,
    /// What the device was given before the key.
    pub output: OutputLevels,
    /// How often it was stopped before the key, by anything but the key of the line before.
    #[serde(default)]
    pub stops: u32,
    /// RMS that had this drive, in the assets' unit.
    pub reference_rms: f64,
    /// Time, milliseconds, as in ratings.
    pub at_ms: u64,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
}

/// What a device was given while something played, as it was written to the device.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputLevels {
    /// Unit of the levels: `V` of a display.
    pub unit: String,
    /// Largest magnitude.
    pub peak: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Direct component: the largest magnitude of the mean over any 100 ms; silence comes before.
    pub direct: f64,
    /// Length, seconds.
    pub duration_s: f64,
}

/// Something that played ended before its time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stopped {
    pub phase: Phase,
    pub texture: String,
    pub model: String,
    pub reason: StopReason,
    /// Gain that it was played with, decibels relative to the maximum; absent without gain
    /// matching.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain_db: Option<f64>,
    /// Drive of a display, volts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive_v: Option<f64>,
    /// What the device was given; absent if it was not opened.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output: Option<OutputLevels>,
    /// Time, milliseconds, as in ratings.
    pub at_ms: u64,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub simulated: bool,
}

/// Why something ended before its time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StopReason {
    /// The participant, or whoever conducts the session, left it.
    Left,
    /// The program was asked to end, or the motion's input ended.
    Interrupted,
    /// The device ran dry.
    RanDry,
    /// The device, the renderer or the source reported an error.
    Failed,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // As serde calls it.
fn is_zero(count: &u32) -> bool {
    *count == 0
}

impl Line {
    /// Reads a line.
    ///
    /// # Errors
    /// What is wrong, if it is no line of an answer, has other keys or values, or is a header of
    /// another version.
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

    /// Time of the line, milliseconds; 0 for the header.
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

/// The JSON Schema of a line of answers, version 1.0: `spec/schemas/answers-1.json`.
pub fn answers_schema() -> serde_json::Value {
    htex_schema::crossing::<Line>("answers-1.json", "line of a file of answers of htex 1")
}
