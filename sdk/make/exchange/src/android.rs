//! Reads and writes Android's `VibrationEffect` as JSON, and writes it as Kotlin code. Each file
//! contains one effect in three forms: a waveform of levels, and the two kinds of envelope that API
//! level 36 provides.
//!
//! The checks follow Android's documentation. A waveform has timings in milliseconds, and
//! amplitudes between 0 and 255. `VibratorEnvelopeEffectInfo` states two limits of a device: the
//! shortest duration of a control point, and the largest number of points in an envelope. Every
//! device supports at least 16 points of 20 ms to 1 s. An envelope of `BasicEnvelopeBuilder` ends
//! at the intensity 0. An amplitude of `WaveformEnvelopeBuilder` is relative to the strongest
//! vibration that the device can play at the point's frequency. The JSON format is this project's
//! own, because Android has no file format for effects.

use htex_format::Rights;
use serde::{Deserialize, Serialize};

use crate::curve::Point;
use crate::error::Fault;
use crate::json::{self, within};
use crate::pattern::Pattern;
use crate::profile::Profile;

/// Longest duration of a control point that every device accepts, milliseconds.
pub(crate) const LONGEST_POINT_MS: u64 = 1_000;
const FORMAT: &str = "android.os.VibrationEffect";

/// An effect in three forms: a waveform, and two kinds of envelope. A device plays one of these
/// forms.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Android {
    format: String,
    /// Author and licence, as SPDX lines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rights: Option<String>,
    /// `VibrationEffect.createWaveform`.
    pub waveform: Waveform,
    /// `VibrationEffect.WaveformEnvelopeBuilder`, API 36.
    pub waveform_envelope: WaveformEnvelope,
    /// `VibrationEffect.BasicEnvelopeBuilder`, API 36.
    pub basic_envelope: BasicEnvelope,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waveform {
    pub timings_ms: Vec<u64>,
    /// Amplitudes from 0 to 255.
    pub amplitudes: Vec<u8>,
    /// Index from which the waveform is repeated; −1 to play it once.
    pub repeat: i32,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaveformEnvelope {
    pub initial_frequency_hz: f64,
    pub control_points: Vec<WaveformPoint>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaveformPoint {
    /// Amplitude from 0 to 1.
    pub amplitude: f64,
    pub frequency_hz: f64,
    /// Time since the previous point, milliseconds.
    pub duration_ms: u64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BasicEnvelope {
    pub initial_sharpness: f64,
    pub control_points: Vec<BasicPoint>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BasicPoint {
    /// Intensity from 0 to 1.
    pub intensity: f64,
    /// Sharpness from 0 to 1.
    pub sharpness: f64,
    /// Time since the previous point, milliseconds.
    pub duration_ms: u64,
}

impl Android {
    pub(crate) fn new(
        waveform: Waveform,
        waveform_envelope: WaveformEnvelope,
        basic_envelope: BasicEnvelope,
    ) -> Self {
        Self {
            format: FORMAT.to_owned(),
            rights: None,
            waveform,
            waveform_envelope,
            basic_envelope,
        }
    }

    pub(crate) fn with_rights(mut self, rights: &Rights) -> Self {
        self.rights = (!rights.is_empty()).then(|| rights.described(""));
        self
    }

    /// Reads an effect from JSON.
    ///
    /// # Errors
    /// Returns an error if the file is not JSON, has another structure, or breaks a rule of
    /// Android's builders. The fault names the place.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Fault> {
        let effect: Self = json::read(bytes)?;
        if effect.format != FORMAT {
            return Err(Fault::new(
                "/format",
                format!("it is {:?}; {FORMAT:?} is read", effect.format),
            ));
        }
        effect.check()?;
        Ok(effect)
    }

    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        json::written(self)
    }

    fn check(&self) -> Result<(), Fault> {
        self.waveform.check()?;
        for (index, point) in self.waveform_envelope.control_points.iter().enumerate() {
            point.check(&format!("/waveform_envelope/control_points/{index}"))?;
        }
        for (index, point) in self.basic_envelope.control_points.iter().enumerate() {
            point.check(&format!("/basic_envelope/control_points/{index}"))?;
        }
        match self.basic_envelope.control_points.last() {
            Some(last) if last.intensity == 0.0 => Ok(()),
            _ => Err(Fault::new(
                "/basic_envelope/control_points",
                "an envelope ends at the intensity 0",
            )),
        }
    }

    /// Checks that a device accepts the envelopes: no envelope may have too many control points,
    /// and no point may be too short.
    ///
    /// # Errors
    /// Returns an error if the device would refuse an envelope or a point. The error names this
    /// envelope or point.
    pub fn check_device(&self, profile: &Profile) -> Result<(), Fault> {
        let waveform = self.waveform_envelope.control_points.iter();
        let basic = self.basic_envelope.control_points.iter();
        let envelopes: [(&str, Vec<u64>); 2] = [
            ("waveform_envelope", waveform.map(|p| p.duration_ms).collect()),
            ("basic_envelope", basic.map(|p| p.duration_ms).collect()),
        ];
        let (most, least) = (profile.most_points.value, profile.shortest_point_ms.value);
        for (envelope, durations_ms) in envelopes {
            let at = format!("/{envelope}/control_points");
            let count = durations_ms.len() as f64;
            within(|| at.clone(), "the number of points", count, 1.0..=most)?;
            for (index, ms) in durations_ms.into_iter().enumerate() {
                let of = || format!("{at}/{index}/duration_ms");
                within(of, "the duration", ms as f64, least..=LONGEST_POINT_MS as f64)?;
            }
        }
        Ok(())
    }

    /// Returns the vibration that the effect's `WaveformEnvelopeBuilder` describes. The vibration
    /// starts from the amplitude 0.
    #[must_use]
    pub fn pattern(&self) -> Pattern {
        let envelope = &self.waveform_envelope;
        let mut time_s = 0.0;
        let mut level = vec![Point::new(0.0, 0.0)];
        let mut frequency_hz = vec![Point::new(0.0, envelope.initial_frequency_hz)];
        for point in &envelope.control_points {
            time_s += point.duration_ms as f64 / 1e3;
            level.push(Point::new(time_s, point.amplitude));
            frequency_hz.push(Point::new(time_s, point.frequency_hz));
        }
        Pattern {
            from_s: 0.0,
            to_s: time_s,
            level,
            exponent: 1,
            frequency_hz,
            transients: Vec::new(),
        }
    }

    /// Writes three Kotlin functions, one for each form of the effect. The texture's `name` becomes
    /// part of the functions' names.
    #[must_use]
    pub(crate) fn to_kotlin(&self, name: &str) -> Vec<u8> {
        let name = identifier(name);
        let waveform = format!(
            "VibrationEffect.createWaveform(\n        longArrayOf({}),\n        intArrayOf({}),\n        {},\n    )",
            joined(self.waveform.timings_ms.iter()),
            joined(self.waveform.amplitudes.iter()),
            self.waveform.repeat,
        );
        let envelope = &self.waveform_envelope;
        let points = envelope.control_points.iter();
        let envelope = builder(
            "WaveformEnvelopeBuilder",
            &format!("setInitialFrequencyHz({}f)", envelope.initial_frequency_hz),
            points.map(|p| (p.amplitude, p.frequency_hz, p.duration_ms)),
        );
        let basic = &self.basic_envelope;
        let points = basic.control_points.iter();
        let basic = builder(
            "BasicEnvelopeBuilder",
            &format!("setInitialSharpness({}f)", basic.initial_sharpness),
            points.map(|p| (p.intensity, p.sharpness, p.duration_ms)),
        );
        let functions = [
            ("every device with amplitude control (API 26)", "Waveform", waveform),
            ("devices with envelopes and a frequency profile (API 36)", "Envelope", envelope),
            ("devices with envelopes (API 36)", "BasicEnvelope", basic),
        ];
        let function = |(devices, kind, body): (&str, &str, String)| {
            format!("\n/** For {devices}. */\nfun {name}{kind}(): VibrationEffect =\n    {body}\n")
        };
        let functions: String = functions.into_iter().map(function).collect();
        format!("import android.os.VibrationEffect\n{functions}").into_bytes()
    }
}

/// Returns the Kotlin code of a function that builds an effect with one of Android's envelope
/// builders.
fn builder(name: &str, first: &str, points: impl Iterator<Item = (f64, f64, u64)>) -> String {
    let point =
        |(a, b, ms): (f64, f64, u64)| format!("        .addControlPoint({a}f, {b}f, {ms}L)\n");
    let points: String = points.map(point).collect();
    format!("VibrationEffect.{name}()\n        .{first}\n{points}        .build()")
}

impl Waveform {
    fn check(&self) -> Result<(), Fault> {
        let (timings, amplitudes) = (self.timings_ms.len(), self.amplitudes.len());
        if timings == amplitudes && timings > 0 {
            return Ok(());
        }
        let problem = format!(
            "it has {timings} timings and {amplitudes} amplitudes; an effect has as many of both, one or more"
        );
        Err(Fault::new("/waveform", problem))
    }
}

impl WaveformPoint {
    fn check(&self, at: &str) -> Result<(), Fault> {
        let of = |key: &str| format!("{at}/{key}");
        within(|| of("amplitude"), "the amplitude", self.amplitude, 0.0..=1.0)?;
        within(|| of("frequency_hz"), "the frequency", self.frequency_hz, 1.0..=1e4)?;
        check_duration(at, self.duration_ms)
    }
}

impl BasicPoint {
    fn check(&self, at: &str) -> Result<(), Fault> {
        let of = |key: &str| format!("{at}/{key}");
        within(|| of("intensity"), "the intensity", self.intensity, 0.0..=1.0)?;
        within(|| of("sharpness"), "the sharpness", self.sharpness, 0.0..=1.0)?;
        check_duration(at, self.duration_ms)
    }
}

fn check_duration(at: &str, ms: u64) -> Result<(), Fault> {
    let of = || format!("{at}/duration_ms");
    within(of, "the duration", ms as f64, 1.0..=LONGEST_POINT_MS as f64)
}

fn joined<T: ToString>(values: impl Iterator<Item = T>) -> String {
    let values: Vec<String> = values.map(|value| value.to_string()).collect();
    values.join(", ")
}

/// Converts a name to a Kotlin identifier: ASCII letters and digits in camel case.
fn identifier(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let mut identifier = String::new();
    for word in words {
        // Splitting inside a character would panic, but words contain only ASCII.
        let (first, rest) = word.split_at(1);
        if identifier.is_empty() {
            identifier.push_str(&first.to_ascii_lowercase())
        } else {
            identifier.push_str(&first.to_ascii_uppercase())
        }
        identifier.push_str(rest);
    }
    // A Kotlin identifier must not begin with a digit. The identifier is empty if the name has only
    // letters of other scripts.
    if identifier.starts_with(|c: char| c.is_ascii_alphabetic()) {
        identifier
    } else {
        format!("texture{identifier}")
    }
}
