//! `*.scene.json`: the scene file format. `spec/scene-1.md` is the normative text.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use htex_format::ErrorMeasure;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Version of the format that this crate reads and writes.
pub const VERSION: &str = "1.0";

/// Largest absolute coordinate, mm: a kilometre.
pub(crate) const FAR_MM: f64 = 1e6;

/// A scene: surfaces, the motion of the finger over them, and the output device.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(deny_unknown_fields))]
pub struct SceneFile {
    /// Version of the format, `MAJOR.MINOR`.
    #[cfg_attr(feature = "schemars", schemars(extend("const" = VERSION)))]
    pub htex_scene: String,
    /// The surfaces that can be touched.
    #[cfg_attr(feature = "schemars", schemars(length(min = 1, max = 256)))]
    pub surfaces: Vec<Surface>,
    /// The motion of the finger.
    pub motion: Motion,
    /// The output device. Default: the adapter `file`, which writes newtons.
    #[serde(default)]
    pub device: DeviceChoice,
    /// Duration, seconds. By default, a scene with a trace is as long as its trace, and a scene
    /// with another motion is endless.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(max = 1e9), extend("exclusiveMinimum" = 0)))]
    pub duration_s: Option<f64>,
    /// Seed of all random numbers. The same seed gives the same samples.
    #[serde(default)]
    pub seed: u64,
    /// Limits for the planner. If the scene does not name a representation for a surface, the
    /// planner chooses one.
    #[serde(default, skip_serializing_if = "Budget::is_empty")]
    pub budget: Budget,
    /// Effects that the scene switches on or off, instead of leaving the choice to the planner.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub effects: BTreeMap<Effect, Switch>,
}

/// A texture and its region.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(deny_unknown_fields))]
pub struct Surface {
    /// Path of an asset, or path of a library followed by `#` and the name of one of its textures
    /// (`cloth.htexlib#woven/cotton`). Relative paths start at the scene's folder.
    pub asset: PathBuf,
    /// Region of the surface. Default: everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<Region>,
    /// Layer. Where surfaces overlap, the finger feels the surface on the highest layer.
    #[serde(default)]
    pub layer: i32,
    /// Factor that multiplies the level, 0 to 1000.
    #[serde(default = "one")]
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 1000)))]
    pub gain: f64,
    /// The representation to play: the id or short name of its model, or `auto`.
    #[serde(default = "auto")]
    #[cfg_attr(feature = "schemars", schemars(regex(pattern = htex_base::schema::NOT_BLANK)))]
    pub representation: String,
}

impl Surface {
    /// A surface that covers everything and plays as recorded.
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

/// A rectangle. Points on the lower edges (smallest x and y) belong to the rectangle, but points on
/// the upper edges do not.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(deny_unknown_fields))]
pub struct Region {
    /// Lower and upper x, mm.
    #[cfg_attr(feature = "schemars", schemars(inner(range(min = -FAR_MM, max = FAR_MM))))]
    pub x_mm: [f64; 2],
    /// Lower and upper y, mm.
    #[cfg_attr(feature = "schemars", schemars(inner(range(min = -FAR_MM, max = FAR_MM))))]
    pub y_mm: [f64; 2],
}

/// The motion of the finger.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// Constant speed, force and direction.
    Constant(Constant),
    /// A recorded motion: the path of a CSV file with the columns `t_s`, `x_mm`, `y_mm`, `force_n`.
    /// Relative paths start at the scene's folder.
    Trace(PathBuf),
    /// The user moves the finger while the scene plays.
    Live,
}

/// A motion with constant speed, force and direction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(deny_unknown_fields))]
pub struct Constant {
    /// Scanning speed, mm/s.
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 1e4)))]
    pub speed_mm_s: f64,
    /// Normal force, newtons.
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 1e3)))]
    pub force_n: f64,
    /// Start position, x and y, mm. Required unless the scene has a single surface and this surface
    /// has no region.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(inner(range(min = -FAR_MM, max = FAR_MM))))]
    pub from_mm: Option<[f64; 2]>,
    /// Direction of the motion, degrees from the x axis towards the y axis.
    #[serde(default)]
    #[cfg_attr(feature = "schemars", schemars(range(min = -3600, max = 3600)))]
    pub direction_deg: f64,
}

/// The output device, and how the scene is mapped to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(deny_unknown_fields))]
pub struct DeviceChoice {
    /// Id or short name of the device adapter.
    #[serde(default = "file_adapter")]
    pub adapter: String,
    /// Name of one of the adapter's profiles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// Settings of the adapter: strings, numbers or booleans.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub settings: BTreeMap<String, Value>,
    /// Sample rate, hertz. Default: the device's default rate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(max = 1e7), extend("exclusiveMinimum" = 0)))]
    pub rate_hz: Option<f64>,
    /// Gain for devices that play newtons or another physical quantity, decibels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(min = -120, max = 120)))]
    pub gain_db: Option<f64>,
    /// Conversion factor from the assets' quantity to the device's quantity. For example, with a
    /// factor of 0.1, a device that plays newtons plays an acceleration of 1 m/s2 as 0.1 N. The
    /// factor is required if the assets' quantity differs from the device's. Without the factor,
    /// such assets are refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(min = 1e-9, max = 1e9)))]
    pub quantity_gain: Option<f64>,
    /// Largest voltage of an electrovibration drive, volts: sqrt(2) times the paper's V_g. Default:
    /// half of the device's limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(max = 1e4), extend("exclusiveMinimum" = 0)))]
    pub drive_v: Option<f64>,
    /// RMS level of a preview that is played as sound, decibels relative to full scale (at most 0).
    /// Default: -18.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(min = -120, max = 0)))]
    pub level_dbfs: Option<f64>,
    /// Whether the drive voltage or the preview level applies to the scene's loudest texture, or to
    /// a reference level.
    #[serde(default, skip_serializing_if = "Levels::is_normalised")]
    pub levels: Levels,
    /// The reference level, in the assets' unit: the RMS that is mapped to the drive voltage or the
    /// preview level. This RMS is used if `levels` is `own`. Default: the RMS of the strongest
    /// representation of all surfaces that the finger touches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(min = 1e-12, max = 1e6)))]
    pub reference_rms: Option<f64>,
    /// Factor that multiplies all frequencies if the scene is played as sound. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(min = 0.05, max = 20)))]
    pub pitch: Option<f64>,
    /// Path of a CSV file with the frequency response that the scene compensates: the response of
    /// the finger on the display. The columns of the file are `frequency_hz` and `magnitude`.
    /// Relative paths start at the scene's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub response: Option<PathBuf>,
    /// Depth of the compensation: a level, in decibels below the response's maximum. At a frequency
    /// where the response has this level, the gain is half of the gain that would fully compensate
    /// the response. Farther below, the gain decreases.
    #[serde(default = "depth", skip_serializing_if = "is_depth")]
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 120)))]
    pub response_depth_db: f64,
}

/// How levels are normalised on devices that play sound or voltages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Levels {
    /// The drive voltage or the preview level applies to the scene's loudest texture, in the
    /// representation that plays it. A texture is therefore equally strong in every representation.
    #[default]
    Normalised,
    /// The drive voltage or the preview level applies to the reference level, whichever
    /// representation plays the texture. Representations with different RMS values are therefore
    /// played at different levels.
    Own,
}

impl Levels {
    fn is_normalised(&self) -> bool {
        *self == Self::Normalised
    }
}

/// Limits for choosing representations. If both limits are set, the planner chooses the
/// representation with the smallest error among the representations that meet both limits.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(deny_unknown_fields))]
pub struct Budget {
    /// Maximum time that the whole chain takes per sample, nanoseconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(max = 1e12), extend("exclusiveMinimum" = 0)))]
    pub ns_per_sample: Option<f64>,
    /// Maximum error of a representation, decibels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(max = 1e12), extend("exclusiveMinimum" = 0)))]
    pub max_error_db: Option<f64>,
    /// The error measure that `max_error_db` limits and that the planner minimises.
    #[serde(default, skip_serializing_if = "is_default")]
    pub error: ErrorMeasure,
}

fn is_default(measure: &ErrorMeasure) -> bool {
    *measure == ErrorMeasure::default()
}

/// Effects of a scene, in the order of the chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Effect {
    /// Interpolation of parameters and level between recorded conditions as speed and force change.
    Interpolation,
    /// Scaling of the frequencies by the asset's scaling law, at speeds outside the recorded range.
    FrequencyScaling,
    /// Scaling of the level by the asset's scaling law, at speeds or forces outside the recorded
    /// range.
    LevelScaling,
    /// Fluctuation of the texture in time, as the asset states it. The planner includes it only if
    /// the scene switches it on.
    Fluctuation,
    /// Cross-fades between surfaces, and fades at their edges.
    Crossfade,
    /// Compensation of the frequency response of the finger on the display.
    Compensation,
    /// Conversion from the rate of the models to the rate of the device.
    Resampling,
    /// Sign of the force, which changes when the stroke changes its direction.
    Direction,
    /// Conversion from newtons to the device's quantity.
    Gain,
    /// Shift and square root of the samples, for an electrovibration display, whose friction is
    /// proportional to the square of the voltage.
    SquareRoot,
    /// Silence while the finger does not touch or slide, and fades at the start and the end of the
    /// scene.
    Contact,
    /// Amplitude modulation on a carrier.
    Carrier,
    /// Limit to the device's range.
    Limiter,
    /// Dither noise for integer files.
    Dither,
    /// Rounding to the resolution of the device.
    Quantisation,
}

impl Effect {
    /// All effects, in the order of the chain.
    pub const ALL: [Self; 15] = [
        Self::Interpolation,
        Self::FrequencyScaling,
        Self::LevelScaling,
        Self::Fluctuation,
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

    /// Name of the effect in a scene, such as `frequency_scaling`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Interpolation => "interpolation",
            Self::FrequencyScaling => "frequency_scaling",
            Self::LevelScaling => "level_scaling",
            Self::Fluctuation => "fluctuation",
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

/// Whether an effect is included in the chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Switch {
    /// The planner includes the effect if the scene requires it.
    #[default]
    Auto,
    /// The effect is always included, but it changes no samples if the scene does not require it.
    On,
    /// The effect is never included.
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
