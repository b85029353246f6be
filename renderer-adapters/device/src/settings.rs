//! Settings of a device. Values from the user take precedence over the profile, and the profile
//! takes precedence over the defaults.
//!
//! [`Settings::settle`] is the only function that combines the user's choices with the settings in
//! a scene file.
//!
//! The host passes settings to a library as lines of text, so that a device written in C needs no
//! JSON parser. Every setting has a line, even if its value is the default.

use std::collections::BTreeMap;

use crate::{Descriptor, DeviceError, FromScene, Setting, SettingKind};

/// All settings of an adapter, each with a valid value.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings(BTreeMap<String, String>);

/// The settings requested for a device, grouped by who requests them.
#[derive(Debug, Clone, Copy)]
pub struct SettingRequests<'a> {
    /// Name of the profile that the user chose.
    pub profile: Option<&'a str>,
    /// Settings that the user gave one by one.
    pub given: &'a BTreeMap<String, String>,
    /// Settings in the scene file. [`FromScene`] determines which of them have an effect.
    pub asked: &'a BTreeMap<String, String>,
    /// Whether the motion is live, i.e. read from a sensor during playback. For a live motion,
    /// [`Setting::live_default`] replaces the default.
    pub live: bool,
}

/// A setting in a scene that has no effect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IgnoredSetting {
    /// Name of a setting of the descriptor.
    pub name: String,
    /// The reason, as a sentence.
    pub what: String,
}

impl Settings {
    /// Combines settings. The values in `given` take precedence over the profile named `profile`,
    /// and the profile takes precedence over the descriptor's defaults. If `given` and the profile
    /// both set a limit ([`FromScene::Less`]), the smaller value applies.
    ///
    /// # Errors
    /// Returns an error if the profile or a setting is unknown, a setting is missing, or a value is
    /// not allowed.
    pub fn resolve(
        descriptor: &Descriptor,
        profile: Option<&str>,
        given: &BTreeMap<String, String>,
    ) -> Result<Self, DeviceError> {
        let requests = SettingRequests { profile, given, asked: &BTreeMap::new(), live: false };
        Ok(Self::settle(descriptor, &requests)?.0)
    }

    /// Combines settings as [`Self::resolve`] does, and applies the settings of a scene. Also
    /// returns the scene's settings that have no effect.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::resolve`].
    pub fn settle(
        descriptor: &Descriptor,
        requests: &SettingRequests<'_>,
    ) -> Result<(Self, Vec<IgnoredSetting>), DeviceError> {
        let mut values = match requests.profile {
            Some(name) => profile_settings(descriptor, name)?,
            None => BTreeMap::new(),
        };
        for (name, value) in requests.given {
            let setting = find(descriptor, name)?;
            check(setting, value)?;
            // A limit of a profile protects its rig, so the user may only lower it.
            let holds = setting.from_scene == FromScene::Less
                && values.get(name).is_some_and(|held| number(held) < number(value));
            if !holds {
                values.insert(name.clone(), value.clone());
            }
        }
        for setting in &descriptor.settings {
            let live = setting.live_default.as_ref().filter(|_| requests.live);
            let default = live.or(setting.default.as_ref());
            if let (false, Some(default)) = (values.contains_key(&setting.name), default) {
                values.insert(setting.name.clone(), default.clone());
            }
        }
        // The scene's settings are applied after the defaults, because a scene may only lower or
        // raise the value that applies without the scene.
        let mut ignored = Vec::new();
        for (name, value) in requests.asked {
            let setting = find(descriptor, name)?;
            check(setting, value)?;
            let is_given = requests.given.contains_key(name);
            match scene_request(setting, value, values.get(name), is_given) {
                SceneRequest::Used => {
                    values.insert(name.clone(), value.clone());
                }
                SceneRequest::Given => {}
                SceneRequest::Ignored(what) => {
                    ignored.push(IgnoredSetting { name: name.clone(), what })
                }
            }
        }
        // The values of a profile and the defaults are checked only here.
        for setting in &descriptor.settings {
            match values.get(&setting.name) {
                Some(value) => check(setting, value)?,
                None => return Err(DeviceError::setting(&setting.name, missing(setting))),
            }
        }
        Ok((Self(values), ignored))
    }

    /// Returns the value of a setting, or an empty text if the adapter has no setting with this
    /// name.
    pub fn text(&self, name: &str) -> &str {
        self.0.get(name).map_or("", String::as_str)
    }

    /// Returns the value of a setting as a number, or NaN if it is not a number.
    pub fn number(&self, name: &str) -> f64 {
        self.text(name).parse().unwrap_or(f64::NAN)
    }

    /// Iterates over all settings in the order of their names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(k, v)| (k.as_str(), v.as_str()))
    }
}

/// Converts the settings to lines of text, the form in which they cross the ABI, and back.
impl Settings {
    /// Writes one line for each setting, `name=value`, in the order of the descriptor.
    pub fn to_lines(&self, descriptor: &Descriptor) -> String {
        let settings = descriptor.settings.iter();
        let line = |s: &Setting| format!("{}={}\n", s.name, self.text(&s.name));
        settings.map(line).collect()
    }

    /// Reads lines written by [`Self::to_lines`]. A setting without a line gets its default.
    ///
    /// # Errors
    /// Returns an error if a line is invalid or occurs twice. Also returns the errors of
    /// [`Self::resolve`].
    pub fn from_lines(descriptor: &Descriptor, lines: &str) -> Result<Self, DeviceError> {
        let mut given = BTreeMap::new();
        for line in lines.lines() {
            let Some((name, value)) = line.split_once('=') else {
                return Err(DeviceError::setting(line, "a line is NAME=VALUE"));
            };
            if given.insert(name.to_owned(), value.to_owned()).is_some() {
                return Err(DeviceError::setting(name, "it is given twice"));
            }
        }
        Self::resolve(descriptor, None, &given)
    }
}

pub(crate) fn find<'a>(descriptor: &'a Descriptor, name: &str) -> Result<&'a Setting, DeviceError> {
    let mut settings = descriptor.settings.iter();
    settings.find(|s| s.name == name).ok_or_else(|| {
        let known: Vec<&str> = descriptor.settings.iter().map(|s| &s.name[..]).collect();
        let what = format!("{} has none; it has {}", descriptor.id, known.join(", "));
        DeviceError::setting(name, what)
    })
}

fn missing(setting: &Setting) -> String {
    match setting.from_scene {
        FromScene::Never | FromScene::Less => {
            format!(
                "the user must give it, not a scene: by a `profile`, or as `setting {}=VALUE`",
                setting.name
            )
        }
        _ => "it must be given".to_owned(),
    }
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or(f64::NAN)
}

/// What happens to a setting that a scene asks for.
enum SceneRequest {
    Used,
    /// The user gave a value, which takes precedence over the scene's value.
    Given,
    /// The setting is not used, for this reason.
    Ignored(String),
}

fn scene_request(
    setting: &Setting,
    value: &str,
    held: Option<&String>,
    is_given: bool,
) -> SceneRequest {
    let held = held.map(String::as_str);
    match (setting.from_scene, held) {
        (FromScene::Any, _) if is_given => SceneRequest::Given,
        (FromScene::Any, _) => SceneRequest::Used,
        (FromScene::Never, _) | (FromScene::Less | FromScene::More, None) => {
            SceneRequest::Ignored(format!(
                "the scene's {value} is not used: it describes the hardware, which the user does"
            ))
        }
        (FromScene::Less, Some(held)) if number(value) <= number(held) => SceneRequest::Used,
        (FromScene::More, Some(held)) if number(value) >= number(held) => SceneRequest::Used,
        (FromScene::Less, Some(held)) => SceneRequest::Ignored(format!(
            "the scene's {value} is not used: {held} holds, and a scene can only lower it"
        )),
        (FromScene::More, Some(held)) => SceneRequest::Ignored(format!(
            "the scene's {value} is not used: {held} holds, and a scene can only raise it"
        )),
    }
}

fn profile_settings(
    descriptor: &Descriptor,
    name: &str,
) -> Result<BTreeMap<String, String>, DeviceError> {
    let found = descriptor.profiles.iter().find(|p| p.name == name);
    found.map(|p| p.settings.clone()).ok_or_else(|| {
        let names: Vec<&str> = descriptor.profiles.iter().map(|p| &p.name[..]).collect();
        let there = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        DeviceError::setting("profile", format!("there is no `{name}`; there is {there}"))
    })
}

/// Checks that a setting may have this value.
pub(crate) fn check(setting: &Setting, value: &str) -> Result<(), DeviceError> {
    let refuse = |what: String| Err(DeviceError::setting(&setting.name, what));
    // Settings cross the ABI as lines.
    if value.contains(['\n', '\r']) {
        return refuse("a value is one line".to_owned());
    }
    match &setting.kind {
        SettingKind::Number { min, max } => match value.parse::<f64>() {
            Ok(number) if (*min..=*max).contains(&number) => Ok(()),
            _ => refuse(format!("`{value}` is not a number from {min} to {max}")),
        },
        SettingKind::Choice { values } if !values.iter().any(|v| v == value) => {
            refuse(format!("`{value}` is not one of {}", values.join(", ")))
        }
        SettingKind::Path if value.is_empty() => refuse("a file is wanted".to_owned()),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Profile;

    fn setting(name: &str, kind: &SettingKind, from_scene: FromScene) -> Setting {
        let setting = Setting::new(name, kind.clone(), "A number.");
        setting.with_default("100").with_from_scene(from_scene)
    }

    fn descriptor() -> Descriptor {
        let number = SettingKind::Number { min: 0.0, max: 150.0 };
        Descriptor {
            id: "org.example.rig".to_owned(),
            name: "Rig".to_owned(),
            version: "1.0.0".to_owned(),
            summary: "A rig.".to_owned(),
            settings: vec![
                setting("limit_v", &number, FromScene::Less),
                setting("ramp_ms", &number, FromScene::More),
                setting("gain", &number, FromScene::Never),
                setting("tone_hz", &number, FromScene::Any),
            ],
            profiles: vec![Profile {
                name: "small".to_owned(),
                summary: "A small one.".to_owned(),
                settings: BTreeMap::from([("limit_v".to_owned(), "20".to_owned())]),
            }],
            ..Descriptor::default()
        }
    }

    #[test]
    fn given_wins_over_profile_wins_over_default() -> Result<(), DeviceError> {
        let none = BTreeMap::new();
        let limit = |profile: Option<&str>, given: &BTreeMap<String, String>| {
            Ok(Settings::resolve(&descriptor(), profile, given)?.number("limit_v"))
        };
        assert_eq!(limit(None, &none)?, 100.0);
        assert_eq!(limit(Some("small"), &none)?, 20.0);
        let given = |name: &str, value: &str| BTreeMap::from([(name.to_owned(), value.to_owned())]);
        assert_eq!(limit(None, &given("limit_v", "120"))?, 120.0);
        assert_eq!(limit(Some("small"), &given("limit_v", "30"))?, 20.0);
        assert_eq!(limit(Some("small"), &given("limit_v", "10"))?, 10.0);
        for refused in [given("limit_v", "151"), given("limit_v", "NaN"), given("x", "1")] {
            assert!(limit(None, &refused).is_err(), "{refused:?}");
        }
        assert!(limit(Some("large"), &none).is_err());
        Ok(())
    }

    /// Whatever a scene asks for, it cannot change settings of the hardware, raise the limit or
    /// shorten the ramp.
    #[test]
    fn a_scene_asks_for_less_and_never_gets_more() -> Result<(), DeviceError> {
        let map = |name: &str, value: &str| BTreeMap::from([(name.to_owned(), value.to_owned())]);
        let none = BTreeMap::new();
        for (name, value, given, holds) in [
            ("limit_v", "30", &none, 30.0),
            ("limit_v", "120", &none, 100.0),
            ("limit_v", "30", &map("limit_v", "20"), 20.0),
            ("limit_v", "10", &map("limit_v", "20"), 10.0),
            ("ramp_ms", "0", &none, 100.0),
            ("ramp_ms", "120", &none, 120.0),
            ("gain", "15", &none, 100.0),
            ("gain", "15", &map("gain", "50"), 50.0),
            ("tone_hz", "15", &none, 15.0),
            ("tone_hz", "15", &map("tone_hz", "50"), 50.0),
        ] {
            let asked = map(name, value);
            let requests = SettingRequests { profile: None, given, asked: &asked, live: false };
            let (settings, ignored) = Settings::settle(&descriptor(), &requests)?;
            assert_eq!(settings.number(name), holds, "{name} {value}");
            let gets = holds == value.parse().unwrap_or(f64::NAN);
            assert_eq!(ignored.is_empty(), gets || name == "tone_hz", "{name} {value}");
        }
        Ok(())
    }

    #[test]
    fn lines_are_read_as_they_were_written() -> Result<(), DeviceError> {
        let settings = Settings::from_lines(&descriptor(), "limit_v=12.5\n")?;
        let rest = "ramp_ms=100\ngain=100\ntone_hz=100\n";
        assert_eq!(settings.to_lines(&descriptor()), format!("limit_v=12.5\n{rest}"));
        let defaults = Settings::from_lines(&descriptor(), "")?;
        assert_eq!(defaults.to_lines(&descriptor()), format!("limit_v=100\n{rest}"));
        for refused in ["limit_v", "limit_v=1\nlimit_v=1\n", "x=1\n", "limit_v=\n"] {
            assert!(Settings::from_lines(&descriptor(), refused).is_err());
        }
        Ok(())
    }
}
