//! Profiles of actuators: what each can do, with a source for every value.
//!
//! The profiles are data in the crate (`profiles.toml`). A resonant actuator is a driven
//! oscillator: at a frequency `f` it is at most as strong as `strongest_m_s2` times its response,
//! `1 / sqrt(1 + Q² (f/f₀ − f₀/f)²)`, and it plays nothing outside its range. A rotating mass is
//! described by one number: its acceleration grows with the square of its frequency, which follows
//! its level.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::error::{ExchangeError, list};

/// All profiles, in the order of the documents.
pub static PROFILES: LazyLock<Vec<Profile>> = LazyLock::new(|| {
    #[derive(Deserialize)]
    struct Profiles {
        profile: Vec<Profile>,
    }
    // A test makes sure that the file can be read. If it could not, there would be no profiles, and
    // looking up any name would say so.
    htex_base::files::toml::from_str(include_str!("profiles.toml"))
        .map_or_else(|_| Vec::new(), |all: Profiles| all.profile)
});

/// A value, with its source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SourcedValue {
    pub value: f64,
    /// A document, or `assumed`.
    pub source: String,
}

impl SourcedValue {
    /// Whether the value is assumed: nobody has measured or published it.
    #[must_use]
    pub fn is_assumed(&self) -> bool {
        self.source == "assumed"
    }
}

/// How an actuator responds to a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// It follows samples, best at its resonance.
    Resonant,
    /// A rotating mass, which can only be given a level.
    Rotating,
}

/// An actuator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    pub name: String,
    /// A short description.
    pub title: String,
    pub kind: Kind,
    /// Frequency at which the actuator is strongest, hertz.
    pub resonance_hz: SourcedValue,
    /// Quality factor: resonance frequency divided by bandwidth.
    pub q: SourcedValue,
    /// Range of frequencies that it can play, hertz.
    pub low_hz: SourcedValue,
    pub high_hz: SourcedValue,
    /// Strongest peak acceleration of the housing, at the resonance, m/s².
    pub strongest_m_s2: SourcedValue,
    /// Time from a command to the vibration, milliseconds.
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
    /// When no profile has the name; the error lists all names.
    pub fn find(name: &str) -> Result<&'static Self, ExchangeError> {
        let found = PROFILES.iter().find(|profile| profile.name == name);
        found.ok_or_else(|| ExchangeError::UnknownProfile {
            wanted: name.to_owned(),
            there: list(PROFILES.iter().map(|p| p.name.clone())),
        })
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

    /// Returns the fraction of its strongest acceleration that the actuator reaches at a frequency,
    /// 0 to 1; 0 outside its range.
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

    /// Returns its strongest peak acceleration at a frequency, m/s².
    #[must_use]
    pub(crate) fn strongest_at(&self, hertz: f64) -> f64 {
        self.strongest_m_s2.value * self.response(hertz)
    }

    /// Returns the frequency at a position in its range; positions go from 0 to 1.
    #[must_use]
    pub fn hertz_of(&self, part: f64) -> f64 {
        self.low_hz.value + part * (self.high_hz.value - self.low_hz.value)
    }

    /// Returns the position of a frequency in its range, from 0 to 1.
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

/// Returns a Markdown table of the profiles, for documents. A published value has the number of its
/// source in the list below the table.
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
