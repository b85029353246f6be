//! The input and the result of a format's writer.

use crate::error::{ExchangeError, Fault, unknown_name};
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

impl Coding {
    const ALL: [(&'static str, Self); 2] =
        [("vectorial", Self::Vectorial), ("wavelet", Self::Wavelet)];

    /// Finds a coding by its name, `vectorial` or `wavelet`.
    ///
    /// # Errors
    /// Returns an error if no coding has this name. The error lists all names.
    pub fn find(name: &str) -> Result<Self, ExchangeError> {
        let found = Self::ALL.into_iter().find(|(own, _)| *own == name);
        let (_, coding) =
            found.ok_or_else(|| unknown_name("coding", name, Self::ALL.map(|(own, _)| own)))?;
        Ok(coding)
    }
}

/// The input of a writer: the played vibration, and the actuator for which the file is written.
pub struct Job<'a> {
    pub(crate) export: &'a Export<'a>,
    pub(crate) playing: Playing<'a>,
    pub(crate) profile: &'a Profile,
}

/// The result of a writer.
pub struct WrittenSignal {
    pub(crate) bytes: Vec<u8>,
    pub(crate) heard: Heard,
    /// The signal with which the file drives the actuator. It comes from reading the file back. It
    /// has the sample rate of `heard`.
    pub(crate) drive: Vec<f64>,
    pub(crate) limited: f64,
    pub(crate) notes: Vec<String>,
}

impl Job<'_> {
    /// Returns remarks about the profile and the stroke.
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

    /// Returns the time between points of an envelope, seconds. It is the shortest time that the
    /// actuator accepts, or longer if there would be too many points.
    pub(crate) fn point_s(&self, most_points: usize) -> f64 {
        let most = (self.profile.most_points.value as usize).min(most_points).max(4);
        // An envelope has two more points than blocks.
        let longest = self.playing.seconds / (most - 2) as f64;
        longest.max(self.profile.shortest_point_ms.value / 1e3)
    }

    /// Returns an error if the actuator cannot play samples.
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

    /// Makes the error for a file that was just written and that the format's own reader refuses.
    pub(crate) fn own(&self, fault: Fault) -> ExchangeError {
        self.cannot(fault.to_string())
    }

    pub(crate) fn cannot(&self, problem: impl Into<String>) -> ExchangeError {
        self.export.format.cannot(problem)
    }
}
