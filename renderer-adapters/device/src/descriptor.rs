//! Descriptors of device and source adapters.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::abi::MAX_SETTINGS;
use crate::{DeviceError, Settings};

/// An adapter's description. It crosses the ABI as JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Descriptor {
    /// Reverse-DNS identifier, e.g. `org.htex.file`; never changes.
    pub id: String,
    /// Display name.
    pub name: String,
    /// Semantic version.
    pub version: String,
    /// One sentence that says what the adapter drives.
    pub summary: String,
    /// Settings, each with its default.
    pub settings: Vec<Setting>,
    /// Named groups of settings, e.g. for one rig.
    #[serde(default)]
    pub profiles: Vec<Profile>,
    /// How the device transforms the samples and what is lost. Absent: it plays the samples
    /// themselves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mapping: Option<Mapping>,
}

/// How a device that cannot play samples transforms them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Mapping {
    /// What it plays, e.g. the level and mean frequency of each block.
    pub plays: String,
    /// What is lost in the transformation.
    pub loses: String,
}

impl std::fmt::Display for Mapping {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "plays {}; lost: {}", self.plays, self.loses)
    }
}

/// One setting of an adapter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Setting {
    /// Name, including the unit, e.g. `limit_v`.
    pub name: String,
    /// The values that are allowed.
    pub kind: SettingKind,
    /// Default value; absent: the user must give a value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub default: Option<String>,
    /// Default value for a live motion, e.g. a shorter buffer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub live_default: Option<String>,
    /// How a scene, which may be untrusted, may change the setting.
    #[serde(default, skip_serializing_if = "FromScene::is_any")]
    pub from_scene: FromScene,
    /// What the setting does.
    pub description: String,
}

/// How a scene may change a setting. Only the user gives settings that describe the hardware, one
/// by one or by choosing a profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum FromScene {
    /// The scene may set it, unless the user does.
    #[default]
    Any,
    /// The scene may lower the user's value or the default, e.g. of a limit or a buffer. The
    /// smallest number given applies.
    Less,
    /// The scene may raise the user's value or the default, e.g. of a ramp.
    More,
    /// The scene may not change it.
    Never,
}

impl FromScene {
    fn is_any(&self) -> bool {
        *self == Self::Any
    }
}

/// The allowed values of a setting. Values are text; numbers are written as in JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum SettingKind {
    /// A number in a range that includes both ends.
    Number {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// One of several values.
    Choice {
        /// The values.
        values: Vec<String>,
    },
    /// A file to write or read.
    Path,
    /// Any text without line ends.
    Text,
}

/// A named group of settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Profile {
    /// The name by which the user chooses it.
    pub name: String,
    /// Its purpose.
    pub summary: String,
    /// The settings it fixes. Settings given in addition to a profile take precedence.
    pub settings: BTreeMap<String, String>,
}

/// A connected device or source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Endpoint {
    /// The value of the setting that selects it.
    pub name: String,
    /// The name of the setting that selects it.
    pub setting: String,
    /// Description for the user.
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
    /// The default is not an allowed value of its setting.
    #[error("the default: {0}")]
    Default(DeviceError),
    /// The target of a source is not one of its settings.
    #[error("the target `{target}` is not one of the settings")]
    Target { target: String },
    /// A profile has a setting that is unknown, or a value that is not allowed.
    #[error("profile `{profile}`: {error}")]
    Profile { profile: String, error: DeviceError },
}

/// A fault of a setting in a descriptor.
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingFault {
    /// The name contains other characters.
    #[error(": names are of a-z, 0-9 and _")]
    Name,
    /// The range is empty or not finite.
    #[error(" has the range {min} to {max}")]
    Range { min: f64, max: f64 },
    /// The list of choices is empty.
    #[error(" has nothing to choose from")]
    NoChoice,
    /// It has a default for live motions but no general default.
    #[error(" has a `live_default` and no `default`")]
    LiveDefault,
}

impl Descriptor {
    /// Returns the last part of the id, which is the name used on command lines and in scenes.
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

    /// Returns the settings with a profile, or without one. `None` if some setting has no default
    /// and must be given.
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
