//! Reads and writes MPEG's `.hjif`, the human-readable format of ISO/IEC 23090-31. A file has
//! perceptions. A perception has channels, a channel has bands, a band has effects, and an effect
//! has keyframes.
//!
//! The code follows the reference software (MPEGGroup/HapticReferenceSoftware):
//! source/IOHaptics/src/IOJson.cpp for keys and rules, source/Types/src/Effect.cpp for the sound of
//! keyframes, and source/WaveletDecoder for wavelets. The names of perceptions come from
//! draft-ietf-avtcore-rtp-haptics. The reader also accepts keys of earlier drafts (`tracks`,
//! `mixing_weight`). The reader uses only the first perception that is a vibration and has a
//! channel. From this perception, the reader uses only the first channel.

mod check;
mod number;
mod render;
mod wavelet;
mod write;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::Fault;
use crate::format::{Sampling, Signal};
use crate::json;
use number::{whole, whole_or_none};

pub use wavelet::{analysed, synthesised};
pub use write::{Space, waveform};
pub(crate) use write::{Tone, vectorial};

/// An `.hjif` file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hjif {
    #[serde(default)]
    pub version: String,
    #[serde(default = "main_profile")]
    pub profile: String,
    #[serde(default = "one")]
    pub level: u32,
    #[serde(default)]
    pub date: String,
    #[serde(default)]
    pub description: String,
    /// Number of ticks per second or per metre. Positions are in ticks.
    #[serde(default = "thousand")]
    pub timescale: u32,
    #[serde(default)]
    pub avatars: Vec<Value>,
    pub perceptions: Vec<Perception>,
    #[serde(default)]
    pub syncs: Vec<Value>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Perception {
    pub id: i64,
    #[serde(default)]
    pub avatar_id: i64,
    #[serde(default)]
    pub description: String,
    pub perception_modality: String,
    /// Unit of positions, as a power of ten: −3 for milliseconds and millimetres.
    #[serde(default = "milli")]
    pub unit_exponent: i32,
    #[serde(default)]
    pub perception_unit_exponent: i32,
    #[serde(default)]
    pub reference_devices: Vec<ReferenceDevice>,
    #[serde(default)]
    pub effect_library: Vec<Effect>,
    #[serde(alias = "tracks")]
    pub channels: Vec<Channel>,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct ReferenceDevice {
    pub id: i64,
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub maximum_frequency: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub minimum_frequency: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resonance_frequency: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub maximum_amplitude: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Channel {
    pub id: i64,
    #[serde(default)]
    pub description: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference_device_id: Option<i64>,
    #[serde(default = "unity")]
    pub gain: f64,
    #[serde(default = "unity", alias = "mixing_weight")]
    pub mixing_coefficient: f64,
    #[serde(default)]
    pub body_part_mask: u32,
    pub bands: Vec<Band>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Band {
    pub band_type: BandType,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_type: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none", serialize_with = "whole_or_none")]
    pub block_length: Option<f64>,
    #[serde(serialize_with = "whole")]
    pub lower_frequency_limit: f64,
    /// Upper edge of the band. In a wavelet band, this number is the sample rate: samples per
    /// second or per metre.
    #[serde(serialize_with = "whole")]
    pub upper_frequency_limit: f64,
    pub effects: Vec<Effect>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum BandType {
    Curve,
    VectorialWave,
    WaveletWave,
    Transient,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    #[serde(default)]
    pub effect_type: EffectType,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<i64>,
    /// Position, in ticks.
    #[serde(default)]
    pub position: i64,
    /// Phase, radians.
    #[serde(default)]
    pub phase: f64,
    #[serde(default)]
    pub base_signal: BaseSignal,
    #[serde(default)]
    pub keyframes: Vec<Keyframe>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum EffectType {
    #[default]
    Basis,
    Reference,
    #[serde(alias = "Timeline")]
    Composite,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum BaseSignal {
    #[default]
    Sine,
    Square,
    Triangle,
    SawToothUp,
    SawToothDown,
}

#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Keyframe {
    /// Position relative to the effect's position, in ticks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_position: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub amplitude_modulation: Option<f64>,
    /// Frequency, in hertz or waves per metre.
    #[serde(default, skip_serializing_if = "Option::is_none", serialize_with = "whole_or_none")]
    pub frequency_modulation: Option<f64>,
}

fn main_profile() -> String {
    "Main".to_owned()
}

const fn one() -> u32 {
    1
}

const fn thousand() -> u32 {
    1000
}

const fn milli() -> i32 {
    -3
}

const fn unity() -> f64 {
    1.0
}

/// Perception modality of a texture over space.
pub const TEXTURE: &str = "Vibrotactile Texture";
/// Perception modality of a vibration over time.
pub const VIBRATION: &str = "Vibrotactile";

/// Modalities that are read as a vibration over time. The last ones are names from drafts.
const OVER_TIME: [&str; 7] = [
    VIBRATION,
    "Other",
    "Acceleration",
    "Force",
    "Vibration",
    "Kinesthetic",
    "User-defined Temporal",
];
/// Modalities that are read as a vibration over space.
const OVER_SPACE: [&str; 4] = [TEXTURE, "VibrotactileTexture", "Texture", "User-defined Spatial"];

impl Hjif {
    /// Reads an `.hjif` file.
    ///
    /// # Errors
    /// Returns an error if the file is not JSON, has another structure, or a number is out of
    /// range. The fault names the place.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Fault> {
        let hjif: Self = json::read(bytes)?;
        check::check(&hjif)?;
        Ok(hjif)
    }

    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = serde_json::to_vec(self).unwrap_or_default();
        bytes.push(b'\n');
        bytes
    }

    /// Returns whether positions in the file are distances and not times. For distances, the user
    /// must give the finger's speed.
    #[must_use]
    pub fn is_over_space(&self) -> bool {
        self.chosen()
            .is_some_and(|chosen| OVER_SPACE.contains(&&chosen.perception.perception_modality[..]))
    }

    /// Returns the channel that is read.
    fn chosen(&self) -> Option<Chosen<'_>> {
        let vibrates = |p: &&Perception| {
            let modality = &p.perception_modality[..];
            (OVER_TIME.contains(&modality) || OVER_SPACE.contains(&modality))
                && !p.channels.is_empty()
        };
        let perception = self.perceptions.iter().find(vibrates)?;
        let index = self.perceptions.iter().position(|p| std::ptr::eq(p, perception))?;
        Some(Chosen {
            perception,
            channel: perception.channels.first()?,
            pointer: format!("/perceptions/{index}/channels/0"),
        })
    }

    /// Returns what the reader ignores in this file, as a list of sentences.
    #[must_use]
    pub fn left_out(&self) -> Vec<String> {
        let mut left_out = Vec::new();
        if self.perceptions.len() > 1 {
            left_out.push(format!("One of its {} perceptions is read.", self.perceptions.len()));
        }
        let channels = self.chosen().map_or(0, |chosen| chosen.perception.channels.len());
        if channels > 1 {
            left_out.push(format!("The first of {channels} channels is read."));
        }
        let bent = |band: &Band| band.curve_type.as_deref().is_some_and(|c| c != "Linear");
        if (self.chosen()).is_some_and(|chosen| chosen.channel.bands.iter().any(bent)) {
            left_out
                .push("Its curves are read as straight lines between their keyframes.".to_owned());
        }
        left_out
    }
}

/// The channel that is read, and its place in the file.
struct Chosen<'a> {
    perception: &'a Perception,
    channel: &'a Channel,
    pointer: String,
}

impl Chosen<'_> {
    /// Returns the length of a tick, in seconds or metres.
    fn tick(&self, timescale: u32) -> f64 {
        libm::pow(10.0, f64::from(self.perception.unit_exponent + 3)) / f64::from(timescale.max(1))
    }
}

/// Reads a file as a signal.
pub(crate) fn signal(bytes: &[u8], sampling: Sampling) -> Result<Signal, Fault> {
    let hjif = Hjif::from_bytes(bytes)?;
    Ok(Signal {
        samples: hjif.rendered(sampling.rate_hz, sampling.speed_mm_s)?,
        left_out: hjif.left_out(),
    })
}
