//! Profiles of actuators: what they can do, each value with its source.
//!
//! They are data (`profiles.toml`) in the crate. A resonant actuator is a driven oscillator: at a
//! frequency `f` it is at most as strong as `strongest_m_s2` times its response,
//! `1 / sqrt(1 + Q² (f/f₀ − f₀/f)²)`, and plays nothing outside its range. A rotating mass has one
//! number: its acceleration grows with the square of its frequency, which follows its level.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::error::{ExchangeError, list};

/// The profiles, in the order of the documents.
pub static PROFILES: LazyLock<Vec<Profile>> = LazyLock::new(|| {
    #[derive(Deserialize)]
    struct Profiles {
        profile: Vec<Profile>,
    }
    // A test reads the file; a build without it has no profiles, and says so of every name.
    htex_files::toml::from_str(include_str!("profiles.toml"))
        .map_or_else(|_| Vec::new(), |all: Profiles| all.profile)
});

/// A value, and where it is from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sourced {
    pub value: f64,
    /// A document, or `assumed`.
    pub source: String,
}

impl Sourced {
    /// Whether nobody has measured or published it.
    #[must_use]
    pub fn is_assumed(&self) -> bool {
        self.source == "assumed"
    }
}

/// What an actuator does with a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// It follows samples, best at its resonance.
    Resonant,
    /// A rotating mass, which has a level alone.
    Rotating,
}

/// An actuator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    pub name: String,
    /// What it is, in words.
    pub title: String,
    pub kind: Kind,
    /// Frequency at which it is strongest, hertz.
    pub resonance_hz: Sourced,
    /// Quality factor of the resonance: resonance over bandwidth.
    pub q: Sourced,
    /// Range of frequencies that it plays, hertz.
    pub low_hz: Sourced,
    pub high_hz: Sourced,
    /// Strongest acceleration of the housing, at the resonance, m/s², peak.
    pub strongest_m_s2: Sourced,
    /// Time from a command to the vibration, milliseconds.
    pub latency_ms: Sourced,
    /// Shortest time between two points of an envelope, milliseconds.
    pub shortest_point_ms: Sourced,
    /// Most points of an envelope.
    pub most_points: Sourced,
}

impl Profile {
    /// Finds a profile by its name.
    ///
    /// # Errors
    /// When there is none; the error lists all.
    pub fn find(name: &str) -> Result<&'static Self, ExchangeError> {
        let found = PROFILES.iter().find(|profile| profile.name == name);
        found.ok_or_else(|| ExchangeError::UnknownProfile {
            wanted: name.to_owned(),
            there: list(PROFILES.iter().map(|p| p.name.clone())),
        })
    }

    /// Returns its values with their names.
    #[must_use]
    pub fn values(&self) -> [(&'static str, &Sourced); 8] {
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

    /// Returns the part of its strongest acceleration that it reaches at a frequency, 0 to 1; 0
    /// outside its range.
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

    /// Returns its strongest acceleration at a frequency, m/s², peak.
    #[must_use]
    pub fn strongest_at(&self, hertz: f64) -> f64 {
        self.strongest_m_s2.value * self.response(hertz)
    }

    /// Returns the frequency of a position in its range, 0 to 1.
    #[must_use]
    pub fn hertz_of(&self, part: f64) -> f64 {
        self.low_hz.value + part * (self.high_hz.value - self.low_hz.value)
    }

    /// Returns the position of a frequency in its range, 0 to 1.
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

/// Returns the table of the profiles in Markdown, for documents: a value that somebody published
/// has the number of its source in the list below the table.
#[must_use]
pub fn profiles_table() -> String {
    let mut sources: Vec<&str> = Vec::new();
    let mut text = String::from(
        "| name | actuator | resonance | Q | range | strongest | latency | points |\n|---|---|---|---|---|---|---|---|\n",
    );
    for p in PROFILES.iter() {
        let mut cell = |value: &'static Sourced, unit: &str| {
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
