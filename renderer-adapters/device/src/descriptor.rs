//! Descriptors of adapters.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::abi::MAX_SETTINGS;
use crate::{DeviceError, Settings};

/// An adapter's description. A native library passes it to the host as JSON. The default is an
/// output without settings.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Descriptor {
    /// Reverse-DNS identifier, e.g. `org.htex.file`; never changes.
    pub id: String,
    /// Display name.
    pub name: String,
    /// Semantic version.
    pub version: String,
    /// One sentence about the hardware or file that the adapter drives or reads.
    pub summary: String,
    /// Whether the adapter's devices play or record.
    pub direction: Direction,
    /// Name of the setting that selects one of the adapter's devices. On a command line, the user
    /// writes `NAME:TARGET`: the adapter `NAME`, and the value `TARGET` of this setting. The
    /// descriptor of an input must name such a setting.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<String>,
    /// Settings, each with its default.
    pub settings: Vec<Setting>,
    /// Named groups of settings, e.g. for one rig.
    #[serde(default)]
    pub profiles: Vec<Profile>,
    /// How an output transforms the samples, and what is lost in the transformation. If absent, the
    /// output plays the samples without a transformation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mapping: Option<Mapping>,
}

/// Whether a device is an output, which takes samples, or an input, which delivers them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// The device plays samples.
    #[default]
    Output,
    /// The device records samples.
    Input,
}

impl std::fmt::Display for Direction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Output => "output",
            Self::Input => "input",
        })
    }
}

/// How a device transforms samples that it cannot play directly.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Mapping {
    /// What the device plays instead of the samples, e.g. the level and mean frequency of each
    /// block.
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
    /// Default value. If absent, the user must give a value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub default: Option<String>,
    /// Default value when the motion is live, i.e. read from a sensor during playback. A live
    /// motion may need a shorter buffer, for example.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub live_default: Option<String>,
    /// How a scene, which may be untrusted, may change the setting.
    #[serde(default, skip_serializing_if = "FromScene::is_any")]
    pub from_scene: FromScene,
    /// What the setting does.
    pub description: String,
}

/// How a scene may change a setting. Only the user can set a setting that describes the hardware,
/// either directly or by choosing a profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum FromScene {
    /// The scene may set the value, but a value from the user takes precedence.
    #[default]
    Any,
    /// The scene may lower the user's value or the default value, e.g. of a limit or a buffer. The
    /// smallest of the numbers from the scene, the user (or the default) and the profile applies.
    Less,
    /// The scene may raise the user's value or the default value, e.g. of a ramp.
    More,
    /// The scene may not change the value.
    Never,
}

impl FromScene {
    fn is_any(&self) -> bool {
        *self == Self::Any
    }
}

/// The allowed values of a setting. Values are text. Numbers are written as in JSON.
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
    /// The path of a file to write or read.
    Path,
    /// Any text without line ends.
    Text,
}

impl SettingKind {
    /// Creates a setting kind that allows only the listed values.
    pub fn choice(values: &[&str]) -> Self {
        Self::Choice { values: values.iter().map(ToString::to_string).collect() }
    }
}

/// A named group of settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Profile {
    /// Name with which the user chooses the profile.
    pub name: String,
    /// What the profile is for.
    pub summary: String,
    /// The settings of the profile: a value for each name. Values that the user gives take
    /// precedence. For a limit (`from_scene` is `less`), the smaller of the two values applies.
    pub settings: BTreeMap<String, String>,
}

/// A connected device.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Endpoint {
    /// Name of the device, and at the same time the value of the setting that selects the device.
    pub name: String,
    /// Name of the setting that selects the device.
    pub setting: String,
    /// Description for the user.
    pub summary: String,
}

impl Descriptor {
    /// Returns the last part of the id, which is the name used on command lines and in scenes.
    pub fn short_name(&self) -> &str {
        self.id.rsplit('.').next().unwrap_or(&self.id)
    }

    /// Checks names, ranges, defaults, profiles and the target.
    ///
    /// # Errors
    /// [`DeviceError::Invalid`] with the first fault.
    pub fn check(&self) -> Result<(), DeviceError> {
        self.first_fault()
            .map_or(Ok(()), |what| Err(DeviceError::Invalid { document: "descriptor", what }))
    }

    fn first_fault(&self) -> Option<String> {
        let Self { id, version, settings, profiles, .. } = self;
        if !is_reverse_dns(id) {
            return Some(format!("`{id}` is not a reverse-DNS id"));
        }
        if semver::Version::parse(version).is_err() {
            return Some(format!("`{version}` is not a semantic version"));
        }
        if self.name.trim().is_empty() || self.summary.trim().is_empty() {
            return Some("`name` and `summary` must not be empty".to_owned());
        }
        if settings.len().max(profiles.len()) > MAX_SETTINGS {
            return Some(format!("at most {MAX_SETTINGS} settings and profiles are allowed"));
        }
        let twice = |kind: &str, name: &str| format!("two {kind} are named `{name}`");
        let fault = settings.iter().find_map(Setting::fault);
        let fault = fault.or_else(|| {
            let name = first_twice(settings.iter().map(|s| &s.name[..]))?;
            Some(twice("settings", name))
        });
        let fault = fault.or_else(|| {
            let name = first_twice(profiles.iter().map(|p| &p.name[..]))?;
            Some(twice("profiles", name))
        });
        let fault = fault.or_else(|| profiles.iter().find_map(|p| self.profile_fault(p)));
        fault.or_else(|| match &self.target {
            Some(target) if !settings.iter().any(|s| s.name == *target) => {
                Some(format!("the target `{target}` is not one of the settings"))
            }
            None if self.direction == Direction::Input => {
                Some("an input has a `target`, which names one of its settings".to_owned())
            }
            _ => None,
        })
    }

    /// Returns a message about the first value of a profile that is not allowed.
    fn profile_fault(&self, profile: &Profile) -> Option<String> {
        let mut values = profile.settings.iter();
        let error = values.find_map(|(name, value)| {
            let setting = crate::settings::find(self, name);
            setting.and_then(|setting| crate::settings::check(setting, value)).err()
        })?;
        Some(format!("profile `{}`: {error}", profile.name))
    }

    /// Returns the settings from the defaults and, if `profile` is given, from this profile.
    /// Returns `None` if there is no such profile, or if a setting has neither a default nor a
    /// value in the profile.
    pub fn settings(&self, profile: Option<&str>) -> Option<Settings> {
        Settings::resolve(self, profile, &BTreeMap::new()).ok()
    }
}

impl Setting {
    /// Creates a setting that has no default and that a scene may change.
    pub fn new(name: &str, kind: SettingKind, description: &str) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            default: None,
            live_default: None,
            from_scene: FromScene::Any,
            description: description.to_owned(),
        }
    }

    /// Creates a setting that describes the hardware and has a default. No scene can change it.
    pub fn hardware(name: &str, kind: SettingKind, default: &str, description: &str) -> Self {
        let setting = Self::new(name, kind, description);
        setting.with_default(default).with_from_scene(FromScene::Never)
    }

    /// Sets the default value.
    #[must_use]
    pub fn with_default(mut self, default: &str) -> Self {
        self.default = Some(default.to_owned());
        self
    }

    /// Sets the default value for a live motion.
    #[must_use]
    pub fn with_live_default(mut self, default: &str) -> Self {
        self.live_default = Some(default.to_owned());
        self
    }

    /// Sets how a scene may change the setting.
    #[must_use]
    pub fn with_from_scene(mut self, from_scene: FromScene) -> Self {
        self.from_scene = from_scene;
        self
    }

    fn fault(&self) -> Option<String> {
        let name = &self.name;
        let is_plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_';
        if name.is_empty() || !name.bytes().all(is_plain) {
            return Some(format!("setting `{name}`: names are of a-z, 0-9 and _"));
        }
        match &self.kind {
            SettingKind::Number { min, max }
                if !(min.is_finite() && max.is_finite() && min <= max) =>
            {
                return Some(format!("setting `{name}` has the range {min} to {max}"));
            }
            SettingKind::Choice { values } if values.is_empty() => {
                return Some(format!("setting `{name}` has nothing to choose from"));
            }
            _ => {}
        }
        if self.default.is_none() && self.live_default.is_some() {
            return Some(format!("setting `{name}` has a `live_default` and no `default`"));
        }
        let mut defaults = self.default.iter().chain(&self.live_default);
        let error = defaults.find_map(|value| crate::settings::check(self, value).err())?;
        Some(format!("the default: {error}"))
    }
}

fn is_reverse_dns(id: &str) -> bool {
    let is_part = |part: &str| {
        let is_allowed = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b == b'-';
        !part.is_empty() && part.bytes().all(is_allowed)
    };
    id.split('.').count() >= 3 && id.split('.').all(is_part)
}

/// Returns a name that occurs more than once.
pub(crate) fn first_twice<'a>(names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    names.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0])
}
