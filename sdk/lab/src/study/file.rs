//! `study.toml`: the format of studies.

use std::path::PathBuf;

use htex_scene::START_DB;
use htex_scene::file::{DeviceChoice, Motion};
use schemars::JsonSchema;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// Version of the format that this crate reads.
pub const VERSION: &str = "1.0";

/// A study: which participants feel which textures, in which order, and which questions they
/// answer.
///
/// ```
/// use htex_base::finding::Findings;
/// use htex_lab::study::{Plan, read_study};
/// let text = r#"
///     htex_study = "1.0"
///     motion = { constant = { speed_mm_s = 80, force_n = 0.4 } }
///     device = { adapter = "daq" }
///     [[textures]]
///     asset = "vinyl.htex"
/// "#;
/// let study = read_study(text.as_bytes(), &mut Findings::default()).expect("the study is valid");
/// let plan = Plan::new(&study);
/// assert_eq!(plan.participants.len(), 14);
/// assert_eq!(plan.participants[0].trials.len(), 5 * 5); // models, repetitions
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Study {
    /// Version of the format, `MAJOR.MINOR`.
    #[schemars(extend("const" = VERSION))]
    pub htex_study: String,
    /// Name of the study.
    #[serde(default)]
    pub name: String,
    /// Seed for the orders of the trials and for the played samples. The same seed gives the same
    /// orders and samples on every machine.
    #[serde(default)]
    pub seed: u64,
    /// The participants: either their number or their names. If only the number is given, the names
    /// are P01, P02, ….
    #[serde(default)]
    pub participants: Participants,
    /// The textures.
    #[schemars(length(min = 1, max = 256))]
    pub textures: Vec<Texture>,
    /// The models that play each texture, by short name or id.
    #[serde(default = "paper_models")]
    #[schemars(length(min = 1, max = 64), inner(regex(pattern = NAME), length(max = 100)))]
    pub models: Vec<String>,
    /// An additional model with which you check whether a participant's ratings are reliable.
    /// Choose the best available model (`bands`). The model is played and rated like the other
    /// models, and is marked in the results. A participant who rates this hidden reference low is
    /// unreliable.
    #[serde(default)]
    pub hidden_reference: Option<String>,
    /// Number of trials for each combination of texture and model.
    #[serde(default = "five")]
    #[schemars(range(min = 1, max = 1000))]
    pub repetitions: u32,
    /// Length of a trial, seconds.
    #[serde(default = "ten")]
    #[schemars(range(min = 0.01, max = 3600))]
    pub trial_s: f64,
    /// Order of the trials.
    #[serde(default)]
    pub order: Order,
    /// The phases of a session. Their order is fixed.
    #[serde(default = "all_phases")]
    pub phases: Vec<Phase>,
    /// In the training and in the gain matching, each texture starts at this level, decibels
    /// relative to the maximum. From this level, the participant raises the level with key presses
    /// until the texture can be felt. The level never rises without a key press.
    #[serde(default = "start")]
    #[schemars(range(min = -120, max = 0))]
    pub start_db: f64,
    /// Settings of the phase `training`.
    #[serde(default)]
    pub training: Training,
    /// Settings of the phase `gain`.
    #[serde(default)]
    pub gain: Matching,
    /// The scale for all ratings.
    #[serde(default)]
    pub scale: Scale,
    /// The attributes that the participant rates after each trial, in this order.
    #[serde(default = "similarity")]
    #[schemars(length(min = 1, max = 32))]
    pub attributes: Vec<Attribute>,
    /// Rests during the testing. If this key is absent, there are no rests.
    #[serde(default)]
    pub rests: Option<Rests>,
    /// White noise in headphones. It masks the sound that a texture makes while it is felt. The web
    /// page of the study plays the noise. If this key is absent, there is no noise.
    #[serde(default)]
    pub masking_noise: Option<MaskingNoise>,
    /// The motion of the finger, as in a scene: constant, a trace, or `live`.
    pub motion: Motion,
    /// The device, as in a scene.
    pub device: DeviceChoice,
}

/// The participants: their number or their names.
#[derive(Debug, Clone, PartialEq, JsonSchema)]
#[schemars(untagged)]
pub enum Participants {
    /// The number of participants, who are named P01, P02, ….
    Count(#[schemars(range(min = 1, max = 1000))] u32),
    /// Names that consist of letters, digits, `-` and `_`.
    Names(
        #[schemars(length(min = 1, max = 1000), inner(regex(pattern = "^[A-Za-z0-9_-]{1,64}$")))]
        Vec<String>,
    ),
}

/// A texture.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Texture {
    /// Name in the results; default: the asset's file name without its extension.
    #[serde(default)]
    #[schemars(regex(pattern = NAME), length(max = 100))]
    pub name: Option<String>,
    /// Path of the asset; relative paths start at the study's folder.
    pub asset: PathBuf,
}

/// Order of the trials of one participant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Order {
    /// All trials in random order.
    #[default]
    Random,
    /// The trials are in blocks, one block for each repetition. In a block, every combination of
    /// texture and model occurs once, in random order.
    BlockedByRepetition,
    /// All trials of a texture follow each other. Both the textures and the trials of each texture
    /// are in random order. In this order, the experimenter exchanges the real texture as rarely as
    /// possible.
    BlockedByTexture,
    /// Each repetition is a row of a Latin square. The conditions of the square are the pairs of a
    /// texture and a model. If there are as many rows as conditions, each condition occurs once at
    /// each position.
    LatinSquare,
    /// Each repetition is a row of a Williams square (Williams 1949). A Williams square is a Latin
    /// square with one more property: over all rows, each condition follows every other condition
    /// equally often.
    WilliamsSquare,
}

/// A phase of a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Practice trials, whose ratings are not results.
    Training,
    /// The participant matches the strength of each texture to the strength of the real texture.
    Gain,
    /// The rated trials.
    Testing,
}

/// Settings of the phase `training`.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Training {
    /// Number of practice trials. htex draws them at random from the trials of the testing phase.
    #[serde(default = "five")]
    #[schemars(range(min = 1, max = 1000))]
    pub trials: u32,
}

/// Settings of the phase `gain`. The participant matches the strength of each texture to the real
/// texture. One model plays the textures during this matching. htex also uses the resulting gain
/// for the other models (paper, "Gain matching task").
///
/// In the paper, the matching starts at the maximum. In htex, the participant first raises the
/// level from `start_db` until the texture can be felt, and the matching starts at that level. A
/// gain is in decibels relative to the maximum. The maximum depends on the device. For a display,
/// it is `device.drive_v` (default: the display's limit). For sound, it is `level_dbfs` (default:
/// -18 dBFS). For all other devices, it is `gain_db` (default: 0 dB).
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Matching {
    /// The model that plays the textures during the matching.
    #[serde(default = "ar")]
    pub model: String,
    /// How the gain is found.
    #[serde(default)]
    pub method: GainMethod,
    /// How much a key for a normal step changes the level, decibels.
    #[serde(default = "one_db")]
    #[schemars(range(min = 0.01, max = 20))]
    pub step_db: f64,
    /// How much a key for a large step changes the level, decibels. A staircase also uses this step
    /// before its first reversal.
    #[serde(default = "four_db")]
    #[schemars(range(min = 0.01, max = 40))]
    pub large_step_db: f64,
    /// Lowest gain that can be set, decibels relative to the maximum.
    #[serde(default = "lowest")]
    #[schemars(range(min = -120, max = -1))]
    pub lowest_db: f64,
    /// Number of reversals after which a staircase ends. The resulting gain is the mean of the
    /// gains at all reversals except the first two.
    #[serde(default = "six")]
    #[schemars(range(min = 3, max = 50))]
    pub reversals: u32,
}

/// Method of matching a gain. Each method starts at the level at which the participant first felt
/// the texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GainMethod {
    /// The participant lowers the gain until the strength matches, and then accepts the gain. The
    /// gain cannot go up.
    #[default]
    Descending,
    /// The participant moves the gain up and down until the strength matches, and then accepts the
    /// gain.
    Adjustment,
    /// The participant says whether the texture should be stronger or weaker. After each answer,
    /// the gain moves one step in this direction. The steps are large until the first reversal and
    /// small after it.
    Staircase,
}

/// A rating scale of whole numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Scale {
    /// Lowest rating.
    #[serde(default)]
    #[schemars(range(min = 0, max = 9))]
    pub min: u8,
    /// Highest rating.
    #[serde(default = "highest")]
    #[schemars(range(min = 0, max = 9))]
    pub max: u8,
    /// Meaning of the lowest rating.
    #[serde(default = "different")]
    pub low: String,
    /// Meaning of the highest rating.
    #[serde(default = "same")]
    pub high: String,
}

/// Pattern of a name in the results: not blank, without control characters.
const NAME: &str = concat!(
    r"^[^\x00-\x1f\x7f-\x9f]*[^",
    htex_base::schema::white_space!(),
    r"\x00-\x1f\x7f-\x9f][^\x00-\x1f\x7f-\x9f]*$"
);

/// An attribute that is rated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Attribute {
    /// Name in the results.
    #[schemars(regex(pattern = NAME), length(max = 100))]
    pub name: String,
    /// The question that the participant is asked.
    pub question: String,
}

/// Rests during the testing.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Rests {
    /// Number of trials between two rests.
    #[schemars(range(min = 1, max = 100_000))]
    pub every: u32,
    /// Shortest rest, seconds.
    #[serde(default)]
    #[schemars(range(min = 0, max = 3600))]
    pub seconds: f64,
}

/// White noise that masks the sound that the display makes while a texture plays.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct MaskingNoise {
    /// RMS level, decibels relative to full scale.
    #[schemars(range(min = -80, max = -10))]
    pub level_dbfs: f64,
}

/// This is written by hand, because with an untagged enum, serde would lose the place of an error.
impl<'de> Deserialize<'de> for Participants {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(CountOrNames)
    }
}

struct CountOrNames;

impl<'de> Visitor<'de> for CountOrNames {
    type Value = Participants;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a number of participants or a list of names")
    }

    fn visit_u64<E: serde::de::Error>(self, count: u64) -> Result<Participants, E> {
        // A number that is too large for `u32` becomes the largest `u32`, which is also more than
        // allowed.
        Ok(Participants::Count(u32::try_from(count).unwrap_or(u32::MAX)))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Participants, A::Error> {
        let mut names = Vec::new();
        while let Some(name) = list.next_element()? {
            names.push(name);
        }
        Ok(Participants::Names(names))
    }
}

impl Participants {
    pub fn count(&self) -> usize {
        match self {
            Self::Count(count) => *count as usize,
            Self::Names(names) => names.len(),
        }
    }

    pub fn names(&self) -> Vec<String> {
        match self {
            Self::Names(names) => names.clone(),
            Self::Count(count) => {
                let width = count.to_string().len().max(2);
                (1..=*count).map(|i| format!("P{i:0width$}")).collect()
            }
        }
    }
}

impl Texture {
    /// Returns the texture's name in the results.
    pub fn name(&self) -> String {
        let stem = || self.asset.file_stem().unwrap_or_default();
        let of_file = || stem().to_string_lossy().into_owned();
        self.name.clone().unwrap_or_else(of_file)
    }
}

impl Study {
    /// Returns all models, with the hidden reference last.
    pub fn all_models(&self) -> Vec<&str> {
        let models = self.models.iter().chain(&self.hidden_reference);
        models.map(String::as_str).collect()
    }

    /// Returns whether a phase takes place.
    pub fn has(&self, phase: Phase) -> bool {
        self.phases.contains(&phase)
    }
}

impl Default for Participants {
    fn default() -> Self {
        Self::Count(14)
    }
}

impl Default for Training {
    fn default() -> Self {
        Self { trials: five() }
    }
}

impl Default for Matching {
    fn default() -> Self {
        Self {
            model: ar(),
            method: GainMethod::default(),
            step_db: one_db(),
            large_step_db: four_db(),
            lowest_db: lowest(),
            reversals: six(),
        }
    }
}

impl Default for Scale {
    fn default() -> Self {
        Self { min: 0, max: highest(), low: different(), high: same() }
    }
}

fn paper_models() -> Vec<String> {
    ["ar", "mfcc", "speak", "sbeta", "sslope"].map(str::to_owned).to_vec()
}

fn all_phases() -> Vec<Phase> {
    vec![Phase::Training, Phase::Gain, Phase::Testing]
}

fn similarity() -> Vec<Attribute> {
    vec![Attribute {
        name: "similarity".to_owned(),
        question: "How similar is the rendered texture to the real one?".to_owned(),
    }]
}

fn five() -> u32 {
    5
}

fn six() -> u32 {
    6
}

fn ten() -> f64 {
    10.0
}

fn ar() -> String {
    "ar".to_owned()
}

fn one_db() -> f64 {
    1.0
}

fn four_db() -> f64 {
    4.0
}

fn start() -> f64 {
    START_DB
}

fn lowest() -> f64 {
    -40.0
}

fn highest() -> u8 {
    6
}

fn different() -> String {
    "Different".to_owned()
}

fn same() -> String {
    "Same".to_owned()
}
