//! What a format's writer is given, and what it returns.

use std::borrow::Cow;

use htex_play::Texture;

use crate::error::{ExchangeError, Fault};
use crate::heard::{Heard, Playing};
use crate::profile::{Kind, Profile};

/// Sample rate at which envelopes are measured and losses computed, hertz.
pub(crate) const RATE_HZ: f64 = 8_000.0;

/// How `.hjif` codes a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Coding {
    /// Seven tones
    #[default]
    Vectorial,
    /// Samples
    Wavelet,
}

/// The input of a writer for what is played.
pub struct Job<'a> {
    /// Name of the format.
    pub(crate) format: &'static str,
    pub(crate) playing: Playing<'a>,
    pub(crate) profile: &'a Profile,
    /// Sample rate of files that contain plain samples, hertz.
    pub(crate) rate_hz: f64,
    pub(crate) coding: Coding,
    pub(crate) extension: Option<&'a str>,
}

/// The input of a writer for the asset itself.
pub struct AssetJob<'a> {
    /// Name of the format.
    pub(crate) format: &'static str,
    pub(crate) asset: &'a Texture,
    /// The asset's file; without it, the asset is written anew.
    pub(crate) file: Option<&'a [u8]>,
    pub(crate) extension: Option<&'a str>,
}

/// What a writer returns.
pub struct Written {
    pub(crate) bytes: Vec<u8>,
    pub(crate) heard: Heard,
    /// What the file drives the actuator with when it is read back, at the sample rate of what was
    /// heard.
    pub(crate) drive: Vec<f64>,
    pub(crate) limited: f64,
    pub(crate) notes: Vec<String>,
}

impl AssetJob<'_> {
    /// The asset's file.
    pub(crate) fn file(&self) -> Result<Cow<'_, [u8]>, ExchangeError> {
        if let Some(file) = self.file {
            return Ok(Cow::Borrowed(file));
        }
        let written = self.asset.data().to_bytes();
        written.map(Cow::Owned).map_err(|error| self.cannot(error.to_string()))
    }

    pub(crate) fn cannot(&self, problem: String) -> ExchangeError {
        let format = self.format;
        ExchangeError::Cannot { format, problem }
    }
}

impl Job<'_> {
    /// Remarks about the profile and the stroke.
    pub(crate) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let mut values = self.profile.values().into_iter();
        if values.any(|(_, value)| value.is_assumed()) {
            let name = &self.profile.name;
            notes.push(format!("Values of the profile {name} are assumed, not measured."));
        }
        if let Some(stroke) = self.playing.source.stroke() {
            notes.extend(stroke.warnings.iter().cloned());
        }
        notes
    }

    /// Seconds between points of an envelope: the shortest that the actuator and the format accept,
    /// or longer if there would be too many points.
    pub(crate) fn point_s(&self, most_points: usize) -> f64 {
        let most = (self.profile.most_points.value as usize).min(most_points).max(4);
        // There are two more points than blocks.
        let longest = self.playing.seconds / (most - 2) as f64;
        longest.max(self.profile.shortest_point_ms.value / 1e3)
    }

    /// Refuses an actuator that cannot play samples.
    pub(crate) fn check_samples(&self) -> Result<(), ExchangeError> {
        if self.profile.kind == Kind::Resonant {
            return Ok(());
        }
        Err(ExchangeError::NoSamples {
            profile: self.profile.name.clone(),
            format: self.format,
            instead: "haptic, ahap or android".to_owned(),
        })
    }

    /// An error in a file just written, which its own reader refuses.
    pub(crate) fn own(&self, fault: Fault) -> ExchangeError {
        self.cannot(fault.to_string())
    }

    pub(crate) fn cannot(&self, problem: String) -> ExchangeError {
        let format = self.format;
        ExchangeError::Cannot { format, problem }
    }
}
