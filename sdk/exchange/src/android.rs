//! Android's `VibrationEffect`: a waveform of levels, and the envelopes of API 36, as JSON and as Kotlin.
//!
//! Rules of the documentation: a waveform has timings of milliseconds and amplitudes of 0 to 255; a control point of an envelope has at
//! least the duration and an envelope at most the points that `VibratorEnvelopeEffectInfo` says, which guarantees 16 points of 20 ms to 1 s; an
//! envelope of `BasicEnvelopeBuilder` ends at the intensity 0. The amplitude of `WaveformEnvelopeBuilder` is the part of the strongest vibration at
//! the frequency. The JSON is this project's own: Android has no file of an effect.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use crate::curve::Point;
use crate::error::Fault;
use crate::json::{self, within};
use crate::pattern::Pattern;

/// Longest duration of a control point that every device takes, milliseconds.
pub const LONGEST_POINT_MS: u64 = 1_000;
const FORMAT: &str = "android.os.VibrationEffect";

/// An effect, in three ways of which a device takes one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Android {
    format: String,
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
    /// 0 to 255.
    pub amplitudes: Vec<u8>,
    /// Index from which it is repeated; −1 for once.
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
    /// 0 to 1.
    pub amplitude: f64,
    pub frequency_hz: f64,
    /// Time from the point before.
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
    /// 0 to 1.
    pub intensity: f64,
    /// 0 to 1.
    pub sharpness: f64,
    /// Time from the point before.
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
            waveform,
            waveform_envelope,
            basic_envelope,
        }
    }

    /// Reads the JSON of an effect.
    ///
    /// # Errors
    /// When it is no JSON, has another shape, or breaks a rule of Android's builders; with the place.
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
        let (timings, amplitudes) = (
            self.waveform.timings_ms.len(),
            self.waveform.amplitudes.len(),
        );
        if timings != amplitudes || timings == 0 {
            let problem = format!(
                "it has {timings} timings and {amplitudes} amplitudes; an effect has as many of both, one or more"
            );
            return Err(Fault::new("/waveform", problem));
        }
        for (index, point) in self.waveform_envelope.control_points.iter().enumerate() {
            let at = |key: &str| format!("/waveform_envelope/control_points/{index}/{key}");
            within(
                || at("amplitude"),
                "the amplitude",
                point.amplitude,
                0.0..=1.0,
            )?;
            within(
                || at("frequency_hz"),
                "the frequency",
                point.frequency_hz,
                1.0..=1e4,
            )?;
            within(
                || at("duration_ms"),
                "the duration",
                point.duration_ms as f64,
                1.0..=LONGEST_POINT_MS as f64,
            )?;
        }
        for (index, point) in self.basic_envelope.control_points.iter().enumerate() {
            let at = |key: &str| format!("/basic_envelope/control_points/{index}/{key}");
            within(
                || at("intensity"),
                "the intensity",
                point.intensity,
                0.0..=1.0,
            )?;
            within(
                || at("sharpness"),
                "the sharpness",
                point.sharpness,
                0.0..=1.0,
            )?;
            within(
                || at("duration_ms"),
                "the duration",
                point.duration_ms as f64,
                1.0..=LONGEST_POINT_MS as f64,
            )?;
        }
        match self.basic_envelope.control_points.last() {
            Some(last) if last.intensity == 0.0 => Ok(()),
            _ => Err(Fault::new(
                "/basic_envelope/control_points",
                "an envelope ends at the intensity 0",
            )),
        }
    }

    /// Returns the vibration of `WaveformEnvelopeBuilder`, which begins at the amplitude 0.
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

    /// Writes three functions of Kotlin that make the effect; `name` of the texture becomes a part of theirs.
    #[must_use]
    pub fn to_kotlin(&self, name: &str) -> Vec<u8> {
        let name = identifier(name);
        let mut text = String::from("import android.os.VibrationEffect\n");
        let _ = write!(
            text,
            "\n/** For every device with amplitude control (API 26). */\nfun {name}Waveform(): VibrationEffect =\n    \
             VibrationEffect.createWaveform(\n        longArrayOf({}),\n        intArrayOf({}),\n        {},\n    )\n",
            joined(self.waveform.timings_ms.iter()),
            joined(self.waveform.amplitudes.iter()),
            self.waveform.repeat,
        );
        let _ = write!(
            text,
            "\n/** For devices with envelopes and a frequency profile (API 36). */\nfun {name}Envelope(): VibrationEffect =\n    \
             VibrationEffect.WaveformEnvelopeBuilder()\n        .setInitialFrequencyHz({}f)\n",
            self.waveform_envelope.initial_frequency_hz,
        );
        for p in &self.waveform_envelope.control_points {
            let _ = writeln!(
                text,
                "        .addControlPoint({}f, {}f, {}L)",
                p.amplitude, p.frequency_hz, p.duration_ms
            );
        }
        let _ = write!(
            text,
            "        .build()\n\n/** For devices with envelopes (API 36). */\nfun {name}BasicEnvelope(): VibrationEffect =\n    \
             VibrationEffect.BasicEnvelopeBuilder()\n        .setInitialSharpness({}f)\n",
            self.basic_envelope.initial_sharpness,
        );
        for p in &self.basic_envelope.control_points {
            let _ = writeln!(
                text,
                "        .addControlPoint({}f, {}f, {}L)",
                p.intensity, p.sharpness, p.duration_ms
            );
        }
        text.push_str("        .build()\n");
        text.into_bytes()
    }
}

fn joined<T: ToString>(values: impl Iterator<Item = T>) -> String {
    let values: Vec<String> = values.map(|value| value.to_string()).collect();
    values.join(", ")
}

/// A name of Kotlin: letters and digits of ASCII, in camel case.
fn identifier(name: &str) -> String {
    let words = name
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty());
    let mut identifier = String::new();
    for word in words {
        let (first, rest) = word.split_at(1);
        match identifier.is_empty() {
            true => identifier.push_str(&first.to_ascii_lowercase()),
            false => identifier.push_str(&first.to_ascii_uppercase()),
        }
        identifier.push_str(rest);
    }
    match identifier.starts_with(|c: char| c.is_ascii_alphabetic()) {
        true => identifier,
        false => format!("texture{identifier}"),
    }
}
