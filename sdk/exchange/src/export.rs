//! Assets as files of other formats, with what is lost.

use htex_play::Asset;
use serde::Serialize;

use crate::error::ExchangeError;
use crate::formats::Format;
use crate::heard::{Heard, Path, Playing};
use crate::loss::{Loss, loss};
use crate::profile::{Kind, PROFILES, Profile};

/// Rate at which envelopes are taken and losses measured, hertz.
pub(crate) const RATE_HZ: f64 = 8_000.0;
/// Shortest and longest export, seconds: a texture's spectrum takes 0.2 s.
const SECONDS: std::ops::RangeInclusive<f64> = 0.5..=crate::pattern::MOST_S;
/// Highest rate of samples, hertz.
const MOST_RATE_HZ: f64 = 192_000.0;

/// How `.hjif` codes a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coding {
    /// At most seven tones.
    #[default]
    Vectorial,
    /// Samples.
    Wavelet,
}

/// What is exported, and for what.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Export<'a> {
    pub format: &'static Format,
    /// The representation, by its model's id or short name; else the one with the smallest nine-band error.
    pub model: Option<&'a str>,
    pub path: Path,
    /// Else the format's own.
    pub profile: Option<&'a Profile>,
    /// Length of a condition; a stroke has its own.
    pub seconds: f64,
    /// Rate of WAV, hertz.
    pub rate_hz: f64,
    pub coding: Coding,
    /// Whether Android's effect is written as Kotlin instead of JSON.
    pub kotlin: bool,
    pub seed: u64,
}

impl<'a> Export<'a> {
    /// Two seconds at the asset's first condition.
    #[must_use]
    pub fn new(format: &'static Format) -> Self {
        Self {
            format,
            model: None,
            path: Path::Condition(None),
            profile: None,
            seconds: 2.0,
            rate_hz: RATE_HZ,
            coding: Coding::default(),
            kotlin: false,
            seed: 0,
        }
    }

    #[must_use]
    pub fn with_path(mut self, path: Path) -> Self {
        self.path = path;
        self
    }

    #[must_use]
    pub fn with_profile(mut self, profile: impl Into<Option<&'a Profile>>) -> Self {
        self.profile = profile.into();
        self
    }

    #[must_use]
    pub fn with_coding(mut self, coding: Coding) -> Self {
        self.coding = coding;
        self
    }
}

/// A file, and what is lost.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Exported {
    #[serde(skip)]
    pub bytes: Vec<u8>,
    pub format: &'static str,
    pub profile: String,
    pub seconds: f64,
    pub lost: Loss,
    /// Part of the time in which the actuator is too weak.
    pub limited: f64,
    /// What the format loses of every texture.
    pub loses: &'static str,
    /// What else is to say, each a sentence.
    pub notes: Vec<String>,
}

/// What a writer works on.
pub struct Job<'a> {
    pub(crate) playing: Playing<'a>,
    pub(crate) profile: &'a Profile,
    pub(crate) export: &'a Export<'a>,
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

/// Writes an asset as a file of another format, reads it again, and measures what is lost.
///
/// # Errors
/// When the format is not written, a number is out of range, the actuator cannot play such files, or the asset cannot be played.
pub fn export(asset: &Asset, export: &Export<'_>) -> Result<Exported, ExchangeError> {
    let format = export.format;
    let Some(writes) = format.writes else {
        let problem = format!(
            "it is not written; there are {}",
            crate::exported().join(", ")
        );
        return Err(ExchangeError::Cannot {
            format: format.name,
            problem,
        });
    };
    let profile = match export.profile {
        Some(profile) => profile,
        None => Profile::find(format.profile)?,
    };
    let seconds = match &export.path {
        Path::Condition(_) => export.seconds,
        Path::Stroke(stroke) => stroke.seconds(),
    };
    check("seconds", seconds, SECONDS, "0.5 to 600 s")?;
    let least_hz = 2.0 * asset.band().high_hz;
    check(
        "rate",
        export.rate_hz,
        least_hz..=MOST_RATE_HZ,
        "twice the texture's highest frequency to 192,000 Hz",
    )?;
    let job = Job {
        playing: Playing {
            asset,
            model: export.model,
            path: &export.path,
            seconds,
            seed: export.seed,
        },
        profile,
        export,
    };
    let written = writes(&job)?;
    let mut notes = written.notes;
    if profile.values().iter().any(|(_, value)| value.is_assumed()) {
        notes.push(format!(
            "Values of the profile {} are assumed, not measured.",
            profile.name
        ));
    }
    if let Path::Stroke(stroke) = &export.path {
        notes.extend(stroke.warnings.iter().cloned());
    }
    Ok(Exported {
        lost: loss(&written.heard, &written.drive, profile)?,
        bytes: written.bytes,
        format: format.name,
        profile: profile.name.clone(),
        seconds,
        limited: written.limited,
        loses: format.loses,
        notes,
    })
}

fn check(
    name: &'static str,
    value: f64,
    within: std::ops::RangeInclusive<f64>,
    range: &'static str,
) -> Result<(), ExchangeError> {
    match within.contains(&value) {
        true => Ok(()),
        false => Err(ExchangeError::OutOfRange { name, value, range }),
    }
}

impl Job<'_> {
    /// Seconds between points of an envelope: the shortest that actuator and format take, or longer, so that their number is enough.
    pub(crate) fn point_s(&self, most_points: usize) -> f64 {
        let most = (self.profile.most_points.value as usize)
            .min(most_points)
            .max(4);
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
            format: self.export.format.name,
            instead: "haptic, ahap or android".to_owned(),
        })
    }

    /// An error of what was just written, which its own reader refuses.
    pub(crate) fn own(&self, fault: crate::Fault) -> ExchangeError {
        ExchangeError::Cannot {
            format: self.export.format.name,
            problem: fault.to_string(),
        }
    }
}

/// Returns the names of the profiles.
#[must_use]
pub fn profile_names() -> Vec<&'static str> {
    PROFILES.iter().map(|profile| &profile.name[..]).collect()
}
