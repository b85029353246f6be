//! Profiles of actuators. A profile describes what an actuator can play. Every value in a profile
//! has a source.
//!
//! The profiles are data in the crate (`profiles.toml`). A resonant actuator is modelled as a
//! driven oscillator. At a frequency `f`, the oscillator's strongest vibration is `strongest_m_s2`
//! times its response, `1 / sqrt(1 + Q² (f/f₀ − f₀/f)²)`. The actuator plays nothing outside its
//! frequency range. A motor with a rotating mass is controlled only by its level: the frequency
//! follows the level, and the acceleration grows with the square of the frequency.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::error::{ExchangeError, unknown_name};

/// All profiles, in the order in which documents list them.
pub static PROFILES: LazyLock<Vec<Profile>> = LazyLock::new(|| {
    #[derive(Deserialize)]
    struct Profiles {
        profile: Vec<Profile>,
    }
    // A test makes sure that the file can be read. If it could not be read, there would be no
    // profiles, and looking up any name would return an error.
    htex_base::files::toml::from_str(include_str!("profiles.toml"))
        .map_or_else(|_| Vec::new(), |all: Profiles| all.profile)
});

/// A value of a profile, with its source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SourcedValue {
    pub value: f64,
    /// The document from which the value comes, or `assumed`.
    pub source: String,
}

impl SourcedValue {
    /// Returns whether the value is assumed. A value is assumed if there is no published
    /// measurement.
    #[must_use]
    pub fn is_assumed(&self) -> bool {
        self.source == "assumed"
    }
}

/// The kind of an actuator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// An actuator that plays samples, and is strongest at its resonance.
    Resonant,
    /// A motor with a rotating mass. Such a motor receives only a level and cannot play samples.
    Rotating,
}

/// The profile of an actuator: what it can play.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    pub name: String,
    /// A short description of the actuator.
    pub title: String,
    pub kind: Kind,
    /// Frequency at which the actuator is strongest, hertz.
    pub resonance_hz: SourcedValue,
    /// Quality factor: resonance frequency divided by bandwidth.
    pub q: SourcedValue,
    /// Lowest frequency that the actuator can play, hertz. The highest frequency is `high_hz`.
    pub low_hz: SourcedValue,
    pub high_hz: SourcedValue,
    /// Largest peak acceleration of the housing, at the resonance, m/s².
    pub strongest_m_s2: SourcedValue,
    /// Time from a command to the start of the vibration, milliseconds.
    pub latency_ms: SourcedValue,
    /// Shortest time between two points of an envelope, milliseconds.
    pub shortest_point_ms: SourcedValue,
    /// Largest number of points in an envelope.
    pub most_points: SourcedValue,
}

impl Profile {
    /// Finds a profile by its name.
    ///
    /// # Errors
    /// Returns an error if no profile has the name. The error lists all names.
    pub fn find(name: &str) -> Result<&'static Self, ExchangeError> {
        let found = PROFILES.iter().find(|profile| profile.name == name);
        found.ok_or_else(|| unknown_name("profile", name, profile_names()))
    }

    /// Returns the profile's values with their names.
    #[must_use]
    pub fn values(&self) -> [(&'static str, &SourcedValue); 8] {
        [
            ("resonance_hz", &self.resonance_hz),
            ("q", &self.q),
            ("low_hz", &self.low_hz),
            ("high_hz", &self.high_hz),
            ("strongest_m_s2", &self.strongest_m_s2),
            ("latency_ms", &self.latency_ms),
            ("shortest_point_ms", &self.shortest_point_ms),
            ("most_points", &self.most_points),
        ]
    }

    /// Returns the largest acceleration that the actuator reaches at a frequency, as a fraction of
    /// its strongest acceleration, 0 to 1. Outside the actuator's range, the fraction is 0.
    #[must_use]
    pub fn response(&self, hertz: f64) -> f64 {
        if !(self.low_hz.value..=self.high_hz.value).contains(&hertz) {
            return 0.0;
        }
        match self.kind {
            Kind::Rotating => libm::pow(hertz / self.high_hz.value, 2.0),
            Kind::Resonant => {
                let detuned = hertz / self.resonance_hz.value - self.resonance_hz.value / hertz;
                1.0 / libm::sqrt(1.0 + libm::pow(self.q.value * detuned, 2.0))
            }
        }
    }

    /// Returns the largest peak acceleration of the actuator at a frequency, m/s².
    #[must_use]
    pub(crate) fn strongest_at(&self, hertz: f64) -> f64 {
        self.strongest_m_s2.value * self.response(hertz)
    }

    /// Returns the frequency, hertz, at a position in the actuator's range. `part` is this
    /// position, from 0 to 1.
    #[must_use]
    pub fn hertz_of(&self, part: f64) -> f64 {
        self.low_hz.value + part * (self.high_hz.value - self.low_hz.value)
    }

    /// Returns the position of a frequency in the actuator's range, from 0 to 1.
    #[must_use]
    pub fn part_of(&self, hertz: f64) -> f64 {
        let part = (hertz - self.low_hz.value) / (self.high_hz.value - self.low_hz.value);
        part.clamp(0.0, 1.0)
    }
}

/// Returns the names of the profiles.
#[must_use]
pub fn profile_names() -> Vec<&'static str> {
    PROFILES.iter().map(|profile| &profile.name[..]).collect()
}

/// Returns a Markdown table of the profiles, for documents. Each published value has the number of
/// its source. The sources are listed below the table.
#[must_use]
pub fn profiles_table() -> String {
    let mut sources: Vec<&str> = Vec::new();
    let mut text = String::from(
        "| name | actuator | resonance | Q | range | strongest | latency | points |\n|---|---|---|---|---|---|---|---|\n",
    );
    for p in PROFILES.iter() {
        let mut cell = |value: &'static SourcedValue, unit: &str| {
            if value.is_assumed() {
                return format!("{}{unit}", value.value);
            }
            let known = sources.iter().position(|source| *source == value.source);
            let number = known.unwrap_or_else(|| {
                sources.push(&value.source);
                sources.len() - 1
            });
            format!("{}{unit} [{}]", value.value, number + 1)
        };
        text += &format!(
            "| `{}` | {} | {} | {} | {} to {} | {} | {} | {} of {} or longer |\n",
            p.name,
            p.title,
            cell(&p.resonance_hz, " Hz"),
            cell(&p.q, ""),
            cell(&p.low_hz, " Hz"),
            cell(&p.high_hz, " Hz"),
            cell(&p.strongest_m_s2, " m/s²"),
            cell(&p.latency_ms, " ms"),
            cell(&p.most_points, ""),
            cell(&p.shortest_point_ms, " ms"),
        );
    }
    for (index, source) in sources.iter().enumerate() {
        text += &format!("\n{}. {source}", index + 1);
    }
    text.push('\n');
    text
}
