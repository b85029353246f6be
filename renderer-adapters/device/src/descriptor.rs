//! What an adapter says of itself.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// An adapter's description; crosses the ABI as JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Descriptor {
    /// Reverse-DNS identifier, e.g. `org.htex.file`; never changes.
    pub id: String,
    /// Name for people.
    pub name: String,
    /// Semantic version.
    pub version: String,
    /// One sentence: what it drives.
    pub summary: String,
    /// Settings, each with its default.
    pub settings: Vec<Setting>,
    /// Settings that belong together, such as those of a rig.
    #[serde(default)]
    pub profiles: Vec<Profile>,
}

/// One setting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// Name, unit included, e.g. `limit_v`.
    pub name: String,
    /// What it may be.
    pub kind: SettingKind,
    /// Value when nothing is said; absent: it must be given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub default: Option<String>,
    /// What it does.
    pub description: String,
}

/// What a setting may be. Values are text; numbers are written as JSON writes them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum SettingKind {
    /// A number in a range, both ends included.
    Number {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// One of these.
    Choice {
        /// The values.
        values: Vec<String>,
    },
    /// A file to write or read.
    Path,
    /// Any text without line ends.
    Text,
}

/// Settings that belong together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// Name it is chosen by.
    pub name: String,
    /// What it is for.
    pub summary: String,
    /// The settings it fixes; what is given beside a profile wins.
    pub settings: BTreeMap<String, String>,
}

/// A device that is there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Endpoint {
    /// The value that chooses it.
    pub name: String,
    /// The setting that takes the value.
    pub setting: String,
    /// What it is, for people.
    pub summary: String,
}

impl Descriptor {
    /// The last part of the id: the name used on command lines and in scenes.
    pub fn short_name(&self) -> &str {
        self.id.rsplit('.').next().unwrap_or(&self.id)
    }
}
