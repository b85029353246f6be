//! Descriptors of adapters of devices and sources.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::abi::MAX_SETTINGS;
use crate::{DeviceError, Settings};

/// An adapter's description; crosses the ABI as JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
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
    /// What it makes of the samples and what is lost; absent: it plays the samples themselves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mapping: Option<Mapping>,
}

/// What a device that cannot play samples makes of them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Mapping {
    /// What it plays, such as level and mean frequency of blocks.
    pub plays: String,
    /// What is lost on the way.
    pub loses: String,
}

impl std::fmt::Display for Mapping {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "plays {}; lost: {}", self.plays, self.loses)
    }
}

/// One setting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Setting {
    /// Name, unit included, e.g. `limit_v`.
    pub name: String,
    /// The values it may have.
    pub kind: SettingKind,
    /// Default; absent: it must be given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub default: Option<String>,
    /// Default with a live motion, such as a shorter buffer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub live_default: Option<String>,
    /// What a scene, which may be untrusted, may do with it.
    #[serde(default, skip_serializing_if = "FromScene::is_any")]
    pub from_scene: FromScene,
    /// Its effect.
    pub description: String,
}

/// What a scene may do with a setting. Settings that describe the hardware are given by the user,
/// one by one or by the choice of a profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum FromScene {
    /// Set it, unless the user does.
    #[default]
    Any,
    /// Lower the number given by the user or the default: a limit, a buffer. The smallest number
    /// given applies.
    Less,
    /// Raise the number given by the user or the default: a ramp.
    More,
    /// Nothing.
    Never,
}

impl FromScene {
    fn is_any(&self) -> bool {
        *self == Self::Any
    }
}

/// The values of a setting, as text; numbers are written as in JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
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
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Profile {
    /// Name it is chosen by.
    pub name: String,
    /// Its purpose.
    pub summary: String,
    /// The settings it fixes; those given beside a profile take precedence.
    pub settings: BTreeMap<String, String>,
}

/// A connected device.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Endpoint {
    /// The value that chooses it.
    pub name: String,
    /// The setting that takes the value.
    pub setting: String,
    /// What it is, for people.
    pub summary: String,
}

/// Error: the descriptor of a device or source is invalid.
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptorError {
    /// The id is not in reverse-DNS form.
    #[error("`{id}` is not a reverse-DNS id")]
    Id { id: String },
    /// The version is not a semantic version.
    #[error("`{version}` is not a semantic version")]
    Version { version: String },
    /// The name or the summary is empty.
    #[error("`name` and `summary` must not be empty")]
    Empty,
    /// There are too many settings or profiles.
    #[error("at most {MAX_SETTINGS} settings and profiles are allowed")]
    TooMany,
    /// Two settings or two profiles have the same name.
    #[error("two {kind} are named `{name}`")]
    Twice {
        /// `settings` or `profiles`.
        kind: &'static str,
        name: String,
    },
    /// A setting is invalid.
    #[error("setting `{name}`{fault}")]
    Setting { name: String, fault: SettingFault },
    /// A default is not a value of its setting.
    #[error("the default: {0}")]
    Default(DeviceError),
    /// The target of a source is not one of its settings.
    #[error("the target `{target}` is not one of the settings")]
    Target { target: String },
    /// A profile has a setting that is unknown, or a value that is not allowed.
    #[error("profile `{profile}`: {error}")]
    Profile { profile: String, error: DeviceError },
}

/// Fault of a setting in a descriptor.
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingFault {
    /// The name has other characters.
    #[error(": names are of a-z, 0-9 and _")]
    Name,
    /// The range is empty or not finite.
    #[error(" has the range {min} to {max}")]
    Range { min: f64, max: f64 },
    /// There is nothing to choose from.
    #[error(" has nothing to choose from")]
    NoChoice,
    /// It has a default for live motions and none for others.
    #[error(" has a `live_default` and no `default`")]
    LiveDefault,
}

impl Descriptor {
    /// The last part of the id: the name used on command lines and in scenes.
    pub fn short_name(&self) -> &str {
        self.id.rsplit('.').next().unwrap_or(&self.id)
    }

    /// Checks names, ranges, defaults and profiles.
    ///
    /// # Errors
    /// The first fault.
    pub fn check(&self) -> Result<(), DescriptorError> {
        check_id(&self.id)?;
        let version = &self.version;
        semver::Version::parse(version)
            .map_err(|_| DescriptorError::Version { version: version.clone() })?;
        if self.name.trim().is_empty() || self.summary.trim().is_empty() {
            return Err(DescriptorError::Empty);
        }
        if self.settings.len().max(self.profiles.len()) > MAX_SETTINGS {
            return Err(DescriptorError::TooMany);
        }
        self.settings.iter().try_for_each(Setting::check)?;
        let profiles = self.profiles.iter().map(|p| p.name.as_str());
        no_two_alike("settings", self.settings.iter().map(|s| s.name.as_str()))?;
        no_two_alike("profiles", profiles)?;
        self.profiles.iter().try_for_each(|p| self.check_profile(p))
    }

    /// Checks that the values a profile fixes are allowed.
    fn check_profile(&self, profile: &Profile) -> Result<(), DescriptorError> {
        let wrong = |error| DescriptorError::Profile { profile: profile.name.clone(), error };
        for (name, value) in &profile.settings {
            let setting = crate::settings::known(self, name).map_err(wrong)?;
            crate::settings::check(setting, value).map_err(wrong)?;
        }
        Ok(())
    }

    /// The settings of a profile, or of none, where nothing else must be given.
    pub fn settings(&self, profile: Option<&str>) -> Option<Settings> {
        Settings::resolve(self, profile, &BTreeMap::new()).ok()
    }
}

impl Setting {
    fn check(&self) -> Result<(), DescriptorError> {
        let Self { name, kind, .. } = self;
        let wrong = |fault| {
            let name = name.clone();
            Err(DescriptorError::Setting { name, fault })
        };
        let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_';
        if name.is_empty() || !name.bytes().all(plain) {
            return wrong(SettingFault::Name);
        }
        match kind {
            SettingKind::Number { min, max }
                if !(min.is_finite() && max.is_finite() && min <= max) =>
            {
                return wrong(SettingFault::Range { min: *min, max: *max });
            }
            SettingKind::Choice { values } if values.is_empty() => {
                return wrong(SettingFault::NoChoice);
            }
            _ => {}
        }
        if self.default.is_none() && self.live_default.is_some() {
            return wrong(SettingFault::LiveDefault);
        }
        let mut defaults = self.default.iter().chain(&self.live_default);
        defaults
            .try_for_each(|value| crate::settings::check(self, value))
            .map_err(DescriptorError::Default)
    }
}

fn check_id(id: &str) -> Result<(), DescriptorError> {
    let part = |part: &str| {
        let allowed = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b == b'-';
        !part.is_empty() && part.bytes().all(allowed)
    };
    if id.split('.').count() >= 3 && id.split('.').all(part) {
        return Ok(());
    }
    let id = id.to_owned();
    Err(DescriptorError::Id { id })
}

fn no_two_alike<'a>(
    kind: &'static str,
    names: impl Iterator<Item = &'a str>,
) -> Result<(), DescriptorError> {
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(DescriptorError::Twice { kind, name: pair[0].to_owned() }),
        None => Ok(()),
    }
}
