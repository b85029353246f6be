//! What a format's writer works on, and what it makes.

use std::borrow::Cow;

use htex_play::Asset;

use crate::error::{ExchangeError, Fault};
use crate::heard::{Heard, Playing};
use crate::profile::{Kind, Profile};

/// Rate at which envelopes are taken and losses measured, hertz.
pub(crate) const RATE_HZ: f64 = 8_000.0;

/// How `.hjif` codes a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coding {
    /// At most seven tones.
    #[default]
    Vectorial,
    /// Samples.
    Wavelet,
}

/// What a writer of what is played works on.
pub struct Job<'a> {
    /// Name of the format.
    pub(crate) format: &'static str,
    pub(crate) playing: Playing<'a>,
    pub(crate) profile: &'a Profile,
    /// Rate of samples that are written as they are, hertz.
    pub(crate) rate_hz: f64,
    pub(crate) coding: Coding,
    pub(crate) extension: Option<&'a str>,
}

/// What a writer of the asset itself works on.
pub struct AssetJob<'a> {
    /// Name of the format.
    pub(crate) format: &'static str,
    pub(crate) asset: &'a Asset,
    /// The asset's file; without it the asset is written anew.
    pub(crate) file: Option<&'a [u8]>,
    pub(crate) extension: Option<&'a str>,
}

/// What a writer made.
pub struct Written {
    pub(crate) bytes: Vec<u8>,
    pub(crate) heard: Heard,
    /// What the file, read again, drives the actuator with, at the rate of what was heard.
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
    /// What is to say of profile and stroke.
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

    /// Seconds between points of an envelope: the shortest that actuator and format take, or
    /// longer, so that their number is enough.
    pub(crate) fn point_s(&self, most_points: usize) -> f64 {
        let most = (self.profile.most_points.value as usize).min(most_points).max(4);
        // Two more points than blocks.
        let longest = self.playing.seconds / (most - 2) as f64;
        longest.max(self.profile.shortest_point_ms.value / 1e3)
    }

    /// Refuses an actuator that plays no samples.
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

    /// An error of what was just written, which its own reader refuses.
    pub(crate) fn own(&self, fault: Fault) -> ExchangeError {
        self.cannot(fault.to_string())
    }

    pub(crate) fn cannot(&self, problem: String) -> ExchangeError {
        let format = self.format;
        ExchangeError::Cannot { format, problem }
    }
}
