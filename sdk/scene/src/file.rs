//! `*.scene.json`: what a scene says. `spec/scene-1.md` is the normative text.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use htex_format::ErrorMeasure;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The version of the format this crate reads and writes.
pub const VERSION: &str = "1.0";

/// A scene: surfaces, how the finger moves over them, and the device it is felt on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Scene {
    /// Version of the format, `MAJOR.MINOR`.
    #[schemars(extend("const" = VERSION))]
    pub htex_scene: String,
    /// What can be touched.
    #[schemars(length(min = 1, max = 256))]
    pub surfaces: Vec<Surface>,
    /// How the finger moves.
    pub motion: Motion,
    /// What it is felt on; a file of newtons when nothing is said.
    #[serde(default)]
    pub device: DeviceChoice,
    /// Length, seconds; absent: the trace's, and without end for other motions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e9), extend("exclusiveMinimum" = 0))]
    pub duration_s: Option<f64>,
    /// The same seed gives the same samples.
    #[serde(default)]
    pub seed: u64,
    /// What chooses the representation of surfaces that leave it to the scene.
    #[serde(default, skip_serializing_if = "Budget::is_empty")]
    pub budget: Budget,
    /// Effects that are not left to the planner.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub effects: BTreeMap<Effect, Switch>,
}

/// A texture, and where it lies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Surface {
    /// The asset; a relative path starts at the scene's folder.
    pub asset: PathBuf,
    /// Where it lies; absent: everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<Region>,
    /// Which of two overlapping surfaces is felt: the higher one.
    #[serde(default)]
    pub layer: i32,
    /// Factor on its level, 0 to 1000.
    #[serde(default = "one")]
    #[schemars(range(min = 0, max = 1000))]
    pub gain: f64,
    /// A model by its id or short name, or `auto`.
    #[serde(default = "auto")]
    #[schemars(regex(pattern = r"\S"))]
    pub representation: String,
}

impl Surface {
    /// A surface that lies everywhere, as it was recorded.
    pub fn everywhere(asset: &Path) -> Self {
        Self {
            asset: asset.to_owned(),
            region: None,
            layer: 0,
            gain: one(),
            representation: auto(),
        }
    }
}

/// A rectangle, edges included at the lower end and excluded at the upper.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Region {
    /// From and to along x, mm.
    pub x_mm: [f64; 2],
    /// From and to along y, mm.
    pub y_mm: [f64; 2],
}

/// How the finger moves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// Always alike.
    Constant(Constant),
    /// As in a CSV with the columns `t_s`, `x_mm`, `y_mm`, `force_n`; a relative path starts at the
    /// scene's folder.
    Trace(PathBuf),
    /// As a person moves it, while the scene plays.
    Live,
}

/// A motion that is always alike.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Constant {
    /// Scanning speed, mm/s.
    #[schemars(range(min = 0, max = 1e4))]
    pub speed_mm_s: f64,
    /// Normal force, newtons.
    #[schemars(range(min = 0, max = 1e3))]
    pub force_n: f64,
    /// Where it starts, x and y, mm; only a single surface without a region goes without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_mm: Option<[f64; 2]>,
    /// Whither it goes, degrees from the x axis towards the y axis.
    #[serde(default)]
    #[schemars(range(min = -3600, max = 3600))]
    pub direction_deg: f64,
}

/// The device, and how the scene is brought to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct DeviceChoice {
    /// The adapter by its id or short name.
    #[serde(default = "file_adapter")]
    pub adapter: String,
    /// One of the adapter's profiles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// Settings of the adapter: text, numbers, or true and false.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub settings: BTreeMap<String, Value>,
    /// Rate of the samples, hertz; absent: the device's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e7), extend("exclusiveMinimum" = 0))]
    pub rate_hz: Option<f64>,
    /// Gain on what a device of newtons, or of another quantity of touch, gets, decibels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -120, max = 120))]
    pub gain_db: Option<f64>,
    /// What one unit of the assets' quantity is in the device's unit, where they differ: with 0.1, a device of
    /// newtons plays an acceleration of 1 m/s2 as 0.1 N. Without it such assets are refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-9, max = 1e9))]
    pub quantity_gain: Option<f64>,
    /// Largest voltage of an electrovibration drive, volts: V_g of the paper is this over sqrt(2).
    /// Absent: half of the device's limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e4), extend("exclusiveMinimum" = 0))]
    pub drive_v: Option<f64>,
    /// RMS of a preview by ear, decibels below full scale (so not above 0); absent: -18.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -120, max = 0))]
    pub level_dbfs: Option<f64>,
    /// Whether the drive, or the level of a preview, is that of the scene's loudest texture.
    #[serde(default, skip_serializing_if = "Levels::is_normalised")]
    pub levels: Levels,
    /// With levels of their own: the RMS that has the drive, or the level of a preview, in the assets' unit. Absent: that of the
    /// strongest representation of all that the scene's surfaces have.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_rms: Option<f64>,
    /// Factor on all frequencies of a preview by ear.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.05, max = 20))]
    pub pitch: Option<f64>,
    /// Response of finger and display, to be compensated: a CSV with the columns `frequency_hz`,
    /// `magnitude`; a relative path starts at the scene's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub response: Option<PathBuf>,
    /// How far below its maximum the response is compensated at most, decibels.
    #[serde(default = "depth", skip_serializing_if = "is_depth")]
    #[schemars(range(min = 0, max = 120))]
    pub response_depth_db: f64,
}

/// What a device of sound or voltages is given the levels of textures as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Levels {
    /// The loudest texture of the scene, by the representation that plays it, has the drive or the level given: all
    /// representations are as strong.
    #[default]
    Normalised,
    /// A reference level has it, whatever plays: each representation keeps its own energy.
    Own,
}

impl Levels {
    fn is_normalised(&self) -> bool {
        *self == Self::Normalised
    }
}

/// What chooses representations. With both, the nearest within the time must be near enough.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Budget {
    /// Most time a sample of the whole chain may take, nanoseconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e12), extend("exclusiveMinimum" = 0))]
    pub ns_per_sample: Option<f64>,
    /// Largest error of a representation, decibels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 1e12), extend("exclusiveMinimum" = 0))]
    pub max_error_db: Option<f64>,
    /// What the error is: which measure `max_error_db` bounds and the nearest has least of.
    #[serde(default, skip_serializing_if = "is_default")]
    pub error: ErrorMeasure,
}

fn is_default(measure: &ErrorMeasure) -> bool {
    *measure == ErrorMeasure::default()
}

/// What a scene may call for, in the order in which a chain has it.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Effect {
    /// Parameters and level between exploration conditions, as speed and force change.
    Interpolation,
    /// Temporal frequencies in proportion to the speed, where an asset knows only one speed.
    SpeedScaling,
    /// Level in proportion to the normal force, where an asset knows only one force.
    ForceScaling,
    /// From one surface to the next, and off and on.
    Crossfade,
    /// The response of finger and display, inverted.
    Compensation,
    /// From the rate of the models to the rate of the device.
    Resampling,
    /// The sign of the force, against the stroke.
    Direction,
    /// From newtons to what the device wants.
    Gain,
    /// Shift and square root, for friction that goes with the square of a voltage.
    SquareRoot,
    /// Silence without contact or slip, and at both ends.
    Contact,
    /// Amplitude modulation on a carrier.
    Carrier,
    /// Never above the device's limit.
    Limiter,
    /// Noise that hides the steps of an integer file.
    Dither,
    /// Rounding to the steps of the device.
    Quantisation,
}

impl Effect {
    /// All effects, in the order in which a chain has them.
    pub const ALL: [Self; 14] = [
        Self::Interpolation,
        Self::SpeedScaling,
        Self::ForceScaling,
        Self::Crossfade,
        Self::Compensation,
        Self::Resampling,
        Self::Direction,
        Self::Gain,
        Self::SquareRoot,
        Self::Contact,
        Self::Carrier,
        Self::Limiter,
        Self::Dither,
        Self::Quantisation,
    ];

    /// The name in a scene, such as `speed_scaling`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Interpolation => "interpolation",
            Self::SpeedScaling => "speed_scaling",
            Self::ForceScaling => "force_scaling",
            Self::Crossfade => "crossfade",
            Self::Compensation => "compensation",
            Self::Resampling => "resampling",
            Self::Direction => "direction",
            Self::Gain => "gain",
            Self::SquareRoot => "square_root",
            Self::Contact => "contact",
            Self::Carrier => "carrier",
            Self::Limiter => "limiter",
            Self::Dither => "dither",
            Self::Quantisation => "quantisation",
        }
    }
}

/// Whether an effect is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Switch {
    /// When the scene calls for it.
    #[default]
    Auto,
    /// In any case; without a call for it, it changes nothing.
    On,
    /// In no case.
    Off,
}

impl Default for DeviceChoice {
    fn default() -> Self {
        Self {
            adapter: file_adapter(),
            profile: None,
            settings: BTreeMap::new(),
            rate_hz: None,
            gain_db: None,
            quantity_gain: None,
            drive_v: None,
            level_dbfs: None,
            levels: Levels::default(),
            reference_rms: None,
            pitch: None,
            response: None,
            response_depth_db: depth(),
        }
    }
}

impl Budget {
    fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

fn one() -> f64 {
    1.0
}

fn auto() -> String {
    "auto".to_owned()
}

fn file_adapter() -> String {
    "file".to_owned()
}

fn depth() -> f64 {
    40.0
}

fn is_depth(x: &f64) -> bool {
    *x == depth()
}
