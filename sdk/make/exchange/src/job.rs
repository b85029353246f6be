//! What a format's writer is given, and what it returns.

use crate::error::{ExchangeError, Fault};
use crate::export::Export;
use crate::heard::{Heard, Playing};
use crate::profile::{Kind, Profile};

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
    pub(crate) export: &'a Export<'a>,
    pub(crate) playing: Playing<'a>,
    pub(crate) profile: &'a Profile,
}

/// What a writer returns.
pub struct WrittenSignal {
    pub(crate) bytes: Vec<u8>,
    pub(crate) heard: Heard,
    /// What the file drives the actuator with when it is read back, at the sample rate of what was
    /// heard.
    pub(crate) drive: Vec<f64>,
    pub(crate) limited: f64,
    pub(crate) notes: Vec<String>,
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
            format: self.export.format.name,
            instead: "haptic, ahap or android".to_owned(),
        })
    }

    /// An error in a file just written, which its own reader refuses.
    pub(crate) fn own(&self, fault: Fault) -> ExchangeError {
        self.cannot(fault.to_string())
    }

    pub(crate) fn cannot(&self, problem: impl Into<String>) -> ExchangeError {
        self.export.format.cannot(problem)
    }
}
