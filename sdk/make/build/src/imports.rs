//! Files of other haptic formats in a recipe. The format is recognised by the file's extension. A
//! file with a signal is fitted like a recording, and needs settings for full scale, speed and
//! force. A file that contains a texture's parameters is converted to an asset without a fit.
//! `htex import` has the same settings, as flags instead of keys of a recipe.

use std::path::Path;

use htex_exchange::{ExchangeError, Format, Missing, Physical, Profile, Reads, SignalSettings};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::BuildError;
use crate::error::at_place;
use crate::inputs::slashed;
use crate::job::shown_path;
use crate::plan::{PlannedRecording, PlannedTexture};
use crate::recipe::Gates;

/// The kinds of files from which a recipe can make a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FileKind {
    /// Recordings.
    #[default]
    Recording,
    /// A file of another haptic format with a signal, to which models are fitted.
    Signal,
    /// A file of another haptic format with the parameters of a texture, which becomes an asset
    /// without a fit.
    Asset,
}

/// Keys of recipes, and the import settings that they stand for. A key that is not listed here is
/// not a setting of any import.
const KEYS: [(&str, &str); 12] = [
    ("full_scale", "full_scale"),
    ("pitch_mm", "pitch"),
    ("quantity", "quantity"),
    ("at.speed_mm_s", "speed"),
    ("at.force_n", "force"),
    ("profile", "profile"),
    ("models", "model"),
    ("options", "option"),
    ("level", "level"),
    ("keep_reference", "keep_reference"),
    ("storage", "storage"),
    ("grid", "grid"),
];
/// Gates that apply to every texture. All other gates judge recordings and fits.
const GATES_OF_ALL: [&str; 2] = ["license", "max_bytes"];

/// Returns the format of a file that is imported; `None` for a recording.
pub(crate) fn format_of(file: &Path) -> Option<&'static Format> {
    Format::of_file(&slashed(&shown_path(file))).ok()
}

impl FileKind {
    fn of_format(format: Option<&Format>) -> Self {
        match format.and_then(|format| format.reads) {
            None => Self::Recording,
            Some(Reads::Asset(_) | Reads::Map) => Self::Asset,
            Some(Reads::Positions { .. } | Reads::Signal(_)) => Self::Signal,
        }
    }

    const fn words(self) -> &'static str {
        match self {
            Self::Recording => "a recording",
            Self::Signal => "a haptic signal",
            Self::Asset => "a file that states a texture",
        }
    }
}

/// Determines the kind of a texture's files, and checks that the files can form one texture and
/// that the settings apply to them. For imports a licence is required unless the recipe turns this
/// gate off, because third-party files have a licence but seldom state it.
pub(crate) fn check_files(texture: &mut PlannedTexture) -> Result<(), BuildError> {
    texture.kind = kind(texture).map_err(at_place(&texture.name))?;
    check_settings(texture).map_err(at_place(&texture.name))?;
    if texture.kind != FileKind::Recording {
        texture.gates.license.get_or_insert(true);
    }
    Ok(())
}

fn kind(texture: &PlannedTexture) -> Result<FileKind, String> {
    let of = |recording: &PlannedRecording| FileKind::of_format(format_of(&recording.file));
    let Some(first) = texture.recordings.first() else {
        return Ok(FileKind::Recording);
    };
    let kind = of(first);
    if let Some(other) = texture.recordings.iter().find(|r| of(r) != kind) {
        return Err(format!(
            "{} is {} and {} is {}; give them other names, so that each is a texture",
            slashed(&first.file),
            kind.words(),
            slashed(&other.file),
            of(other).words()
        ));
    }
    match (kind, &texture.recordings[..]) {
        (FileKind::Asset, [first, second, ..]) => Err(format!(
            "{} and {} state a texture each; give them other names",
            slashed(&first.file),
            slashed(&second.file)
        )),
        _ => Ok(kind),
    }
}

fn check_settings(texture: &PlannedTexture) -> Result<(), String> {
    for recording in &texture.recordings {
        match format_of(&recording.file) {
            Some(format) => check_import(texture, recording, format)?,
            None => check_recording(&texture.settings.signal, recording)?,
        }
    }
    Ok(())
}

/// Refuses settings of signals for a file that is not a signal.
fn check_recording(signal: &SignalSettings, recording: &PlannedRecording) -> Result<(), String> {
    match keys(signal, "").first() {
        None => Ok(()),
        Some(key) => Err(format!(
            "`{key}` is of haptic signals ({}), and {} is a recording; leave it out (the unit at full scale of a recording is `scale`)",
            htex_exchange::imported_signals(),
            slashed(&recording.file)
        )),
    }
}

/// Refuses settings that the import of a file does not take, and requires those that it needs.
fn check_import(
    texture: &PlannedTexture,
    recording: &PlannedRecording,
    format: &Format,
) -> Result<(), String> {
    let of_file = |problem: String| format!("{}: {problem}", slashed(&recording.file));
    let given = given(texture, recording);
    let unused = given.iter().find(|key| !takes(format, key));
    if let Some(key) = unused {
        return Err(of_file(format!(
            "{} takes no `{key}`; give it to the [[textures]] of other files alone",
            format.title
        )));
    }
    // Such a file states its own texture, so it needs no physical settings.
    if let Some(Reads::Asset(_)) = format.reads {
        return Ok(());
    }
    let signal = &texture.settings.signal;
    if let Some(name) = &signal.profile {
        Profile::find(name).map_err(|error| of_file(error.to_string()))?;
    }
    let physical = Physical {
        full_scale: signal.full_scale,
        quantity: texture.settings.reading.quantity.unwrap_or_default(),
        speed_mm_s: recording.speed_mm_s,
        force_n: recording.force_n,
        pitch_mm: signal.pitch_mm,
    };
    physical.check(format).map_err(|error| of_file(by_keys(&error)))
}

/// Returns whether the import of a format takes a key of recipes.
fn takes(format: &Format, key: &str) -> bool {
    let is_fitted = FileKind::of_format(Some(format)) == FileKind::Signal;
    if let Some(gate) = key.strip_prefix("gates.") {
        return is_fitted || GATES_OF_ALL.contains(&gate);
    }
    if key == "embed_plugins" {
        return is_fitted;
    }
    let setting = KEYS.iter().find(|(known, _)| *known == key);
    setting.is_some_and(|(_, setting)| format.check_import([*setting]).is_ok())
}

/// Returns the keys of a recipe that are given for a file, except those for metadata.
fn given(texture: &PlannedTexture, recording: &PlannedRecording) -> Vec<String> {
    let (settings, gates) = (&texture.settings, &texture.gates);
    // `strict` is both a gate and a fit setting. It is listed among the gates.
    let fit = htex_author::settings::FitSettings { strict: None, ..settings.fit.clone() };
    let mut given = [
        keys(&settings.reading, ""),
        keys(&fit, ""),
        keys(&settings.signal, ""),
        keys::<Gates>(gates, "gates."),
    ]
    .concat();
    let others = [
        ("at.speed_mm_s", recording.speed_mm_s.is_some()),
        ("at.force_n", recording.force_n.is_some()),
        ("tracker", recording.tracker.is_some()),
        ("embed_plugins", settings.embed_plugins.is_some()),
    ]
    .into_iter()
    .filter(|(_, is_given)| *is_given);
    given.extend(others.map(|(key, _)| key.to_owned()));
    given
}

/// Returns the keys of the settings that are present.
fn keys<T: Serialize>(settings: &T, before: &str) -> Vec<String> {
    let Ok(Value::Object(entries)) = serde_json::to_value(settings) else {
        return Vec::new();
    };
    let there = entries.into_iter().filter(|(_, value)| !value.is_null());
    there.map(|(key, _)| format!("{before}{key}")).collect()
}

/// Returns the error of a refused import, in terms of the keys of recipes.
pub(crate) fn refused(error: ExchangeError) -> Box<dyn std::error::Error> {
    match error {
        ExchangeError::Missing { .. } => by_keys(&error).into(),
        error => error.into(),
    }
}

/// Returns the error of an import as text, in terms of the keys of recipes.
fn by_keys(error: &ExchangeError) -> String {
    let key = |setting: &str| {
        let known = KEYS.iter().find(|(_, own)| *own == setting);
        known.map_or(setting, |(key, _)| *key).to_owned()
    };
    let list = |parts: Vec<String>| parts.join(", ");
    match error {
        ExchangeError::Missing { format, missing } => {
            let words = missing.iter().map(|m: &Missing| m.words.to_owned());
            let keys = missing.iter().map(|m| format!("`{}`", key(m.setting)));
            format!(
                "{format} does not say {}; give {}",
                list(words.collect()),
                list(keys.collect())
            )
        }
        ExchangeError::OutOfRange { name, value, range } => {
            format!("`{}` is {value}; it is {range}", key(name))
        }
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every setting that an import takes has a key with which a recipe can give it.
    #[test]
    fn each_setting_of_imports_has_a_key() {
        let formats = htex_exchange::FORMATS.iter();
        for format in formats.filter(|format| format.reads.is_some()) {
            for setting in format.reads.map(|r| r.settings()).unwrap_or_default() {
                let key = KEYS.iter().find(|(_, own)| *own == setting);
                let Some((key, _)) = key else {
                    panic!("{}: {setting} has no key", format.name);
                };
                assert!(takes(format, key), "{}: {key}", format.name);
            }
        }
    }

    #[test]
    fn files_are_told_by_their_extension() {
        let kind = |file: &str| FileKind::of_format(format_of(Path::new(file)));
        assert_eq!(kind("a/Models_Felt.xml"), FileKind::Asset);
        assert_eq!(kind("a.b/hum.HAPTIC"), FileKind::Signal);
        assert_eq!(kind("https://example.org/hum.hjif?key=a.xml"), FileKind::Signal);
        // Formats that can only be exported, and names without an extension.
        for file in ["hum.wav", "hum.json", "a.xml/hum", "hum"] {
            assert_eq!(kind(file), FileKind::Recording, "{file}");
        }
    }
}
