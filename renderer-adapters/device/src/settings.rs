//! Settings of a device: what was given, over a profile, over the defaults.

use std::collections::BTreeMap;

use crate::{Descriptor, DeviceError, Setting, SettingKind};

/// All settings of an adapter, each with a value that its kind allows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings(BTreeMap<String, String>);

impl Settings {
    /// Settles `given` over `profile` (by name) over the descriptor's defaults.
    ///
    /// # Errors
    /// When the profile or a setting is not known, one is missing, or a value is not allowed.
    pub fn resolve(
        descriptor: &Descriptor,
        profile: Option<&str>,
        given: &BTreeMap<String, String>,
    ) -> Result<Self, DeviceError> {
        let mut values = match profile {
            Some(name) => profile_settings(descriptor, name)?,
            None => BTreeMap::new(),
        };
        values.extend(given.iter().map(|(k, v)| (k.clone(), v.clone())));
        if let Some(name) = values.keys().find(|name| find(descriptor, name).is_none()) {
            let known: Vec<&str> = descriptor.settings.iter().map(|s| &s.name[..]).collect();
            let what = format!("{} has none; it has {}", descriptor.id, known.join(", "));
            return Err(error(name, what));
        }
        for setting in &descriptor.settings {
            if let (false, Some(default)) = (values.contains_key(&setting.name), &setting.default) {
                values.insert(setting.name.clone(), default.clone());
            }
            match values.get(&setting.name) {
                Some(value) => check(setting, value)?,
                None => return Err(error(&setting.name, "it must be given".to_owned())),
            }
        }
        Ok(Self(values))
    }

    /// The value of a setting; empty when the adapter has none of this name.
    pub fn text(&self, name: &str) -> &str {
        self.0.get(name).map_or("", String::as_str)
    }

    /// The value of a setting that is a number; not a number when it is none.
    pub fn number(&self, name: &str) -> f64 {
        self.text(name).parse().unwrap_or(f64::NAN)
    }

    /// All settings in the order of their names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(k, v)| (k.as_str(), v.as_str()))
    }
}

/// How settings cross the ABI.
impl Settings {
    /// One line a setting, `name=value`, in the order of the descriptor.
    pub fn to_lines(&self, descriptor: &Descriptor) -> String {
        let settings = descriptor.settings.iter();
        let line = |s: &Setting| format!("{}={}\n", s.name, self.text(&s.name));
        settings.map(line).collect()
    }

    /// Reads the lines of [`Self::to_lines`]. A setting without a line has its default.
    ///
    /// # Errors
    /// When a line is none or comes twice, and as [`Self::resolve`].
    pub fn from_lines(descriptor: &Descriptor, lines: &str) -> Result<Self, DeviceError> {
        let mut given = BTreeMap::new();
        for line in lines.lines() {
            let Some((name, value)) = line.split_once('=') else {
                return Err(error(line, "a line is NAME=VALUE".to_owned()));
            };
            if given.insert(name.to_owned(), value.to_owned()).is_some() {
                return Err(error(name, "it is given twice".to_owned()));
            }
        }
        Self::resolve(descriptor, None, &given)
    }
}

fn find<'a>(descriptor: &'a Descriptor, name: &str) -> Option<&'a Setting> {
    descriptor.settings.iter().find(|s| s.name == name)
}

fn profile_settings(
    descriptor: &Descriptor,
    name: &str,
) -> Result<BTreeMap<String, String>, DeviceError> {
    let found = descriptor.profiles.iter().find(|p| p.name == name);
    found.map(|p| p.settings.clone()).ok_or_else(|| {
        let names: Vec<&str> = descriptor.profiles.iter().map(|p| &p.name[..]).collect();
        let there = match names.is_empty() {
            true => "none".to_owned(),
            false => names.join(", "),
        };
        error("profile", format!("there is no `{name}`; there is {there}"))
    })
}

/// Whether a setting may have this value.
pub(crate) fn check(setting: &Setting, value: &str) -> Result<(), DeviceError> {
    let refuse = |what: String| Err(error(&setting.name, what));
    if value.contains(['\n', '\r']) {
        return refuse("a value is one line".to_owned());
    }
    match &setting.kind {
        SettingKind::Number { min, max } => match value.parse::<f64>() {
            Ok(number) if (*min..=*max).contains(&number) => Ok(()),
            _ => refuse(format!("`{value}` is not a number from {min} to {max}")),
        },
        SettingKind::Choice { values } if !values.iter().any(|v| v == value) => {
            refuse(format!("`{value}` is none of {}", values.join(", ")))
        }
        SettingKind::Path if value.is_empty() => refuse("a file is wanted".to_owned()),
        _ => Ok(()),
    }
}

fn error(name: &str, what: String) -> DeviceError {
    DeviceError::Setting {
        name: name.to_owned(),
        what,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Profile;

    fn descriptor() -> Descriptor {
        let number = SettingKind::Number {
            min: 0.0,
            max: 150.0,
        };
        Descriptor {
            id: "org.example.rig".to_owned(),
            name: "Rig".to_owned(),
            version: "1.0.0".to_owned(),
            summary: "A rig.".to_owned(),
            settings: vec![Setting {
                name: "limit_v".to_owned(),
                kind: number,
                default: Some("100".to_owned()),
                description: "Limit.".to_owned(),
            }],
            profiles: vec![Profile {
                name: "small".to_owned(),
                summary: "A small one.".to_owned(),
                settings: BTreeMap::from([("limit_v".to_owned(), "20".to_owned())]),
            }],
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
        assert_eq!(limit(Some("small"), &given("limit_v", "30"))?, 30.0);
        for refused in [
            given("limit_v", "151"),
            given("limit_v", "NaN"),
            given("x", "1"),
        ] {
            assert!(limit(None, &refused).is_err(), "{refused:?}");
        }
        assert!(limit(Some("large"), &none).is_err());
        Ok(())
    }

    #[test]
    fn lines_are_read_as_they_were_written() -> Result<(), DeviceError> {
        let settings = Settings::from_lines(&descriptor(), "limit_v=12.5\n")?;
        assert_eq!(settings.to_lines(&descriptor()), "limit_v=12.5\n");
        let defaults = Settings::from_lines(&descriptor(), "")?;
        assert_eq!(defaults.to_lines(&descriptor()), "limit_v=100\n");
        for refused in ["limit_v", "limit_v=1\nlimit_v=1\n", "x=1\n", "limit_v=\n"] {
            assert!(Settings::from_lines(&descriptor(), refused).is_err());
        }
        Ok(())
    }
}
