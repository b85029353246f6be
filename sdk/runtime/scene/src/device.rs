//! Checks a scene's device, and combines the scene's settings with the user's settings. The user's
//! settings take precedence.
//!
//! These checks keep a scene from mixing up physical quantities ([`quantity_misfit`]). For example,
//! an asset may contain accelerations, while the device plays newtons or is an electrovibration
//! display. The device then plays the asset only if the scene or the user states a `quantity_gain`.

use std::collections::BTreeMap;

use htex_base::finding::{Findings, escape};
use htex_device::{
    Capabilities, Descriptor, DeviceError, Devices, FromScene, IgnoredSetting, Quantity, Setting,
    SettingKind, SettingRequests, Settings,
};
use htex_format::Quantity as Held;
use serde_json::Value;

use crate::file::{DeviceChoice, Levels};
use crate::output::file_name;
pub(crate) use crate::output::stem;
use crate::rules as rule;

/// The setting that names a driver library to load. A scene must not contain it, because scenes may
/// come from untrusted sources.
const DRIVER: &str = "driver";

/// Device options from the program that loads a scene. The program's options take precedence over
/// the scene's options.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DeviceOverride {
    /// Adapter to use instead of the scene's adapter. If it is given, the scene's whole `device`
    /// object is ignored.
    pub adapter: Option<String>,
    /// Profile to use instead of the scene's profile.
    pub profile: Option<String>,
    /// Settings in the adapter's syntax. Relative paths are not resolved.
    pub settings: BTreeMap<String, String>,
    /// Whether the device stays closed because the scene is only validated, planned, or rendered to
    /// a file. The scene's own profile and hardware settings are then accepted. Never set this for
    /// a device that plays.
    pub rehearsal: bool,
    /// Whether the motion is live, i.e. arrives while the scene plays. Missing settings then get
    /// the defaults for a live motion.
    pub live: bool,
    /// Replaces [`DeviceChoice::rate_hz`].
    pub rate_hz: Option<f64>,
    /// Replaces [`DeviceChoice::quantity_gain`].
    pub quantity_gain: Option<f64>,
    /// Default for a missing setting that names a file. If `None`, the default is a file in the
    /// current folder with the scene's name and the file extension of the output format.
    pub output: Option<String>,
}

impl DeviceOverride {
    /// Returns the default output file. `format` is the format setting, if there is one.
    fn output(&self, stem: &str, format: Option<&String>) -> String {
        let usual = || file_name(stem, format.map_or("auto", String::as_str));
        self.output.clone().unwrap_or_else(usual)
    }

    /// Replaces the adapter and the profile in a scene's choice.
    pub(crate) fn apply(&self, choice: &mut DeviceChoice) {
        if let Some(adapter) = &self.adapter {
            *choice = DeviceChoice { adapter: adapter.clone(), ..DeviceChoice::default() };
        }
        if self.profile.is_some() {
            choice.profile.clone_from(&self.profile);
        }
        choice.rate_hz = self.rate_hz.or(choice.rate_hz);
        choice.quantity_gain = self.quantity_gain.or(choice.quantity_gain);
    }
}

/// Checks the choice of a device, and returns the resulting settings if they are valid.
pub(crate) fn check_device(
    choice: &DeviceChoice,
    (change, stem): (&DeviceOverride, &str),
    devices: &Devices,
    held: Option<Held>,
    findings: &mut Findings,
) -> Option<Settings> {
    let adapter = match devices.find_output(&choice.adapter) {
        Ok(known) => &known.adapter,
        Err(error) => {
            findings.add(rule::DEVICE_UNKNOWN, "/device/adapter", error.to_string());
            return None;
        }
    };
    let descriptor = adapter.descriptor();
    let settings = settle(choice, change, stem, descriptor, findings)?;
    match adapter.capabilities(&settings) {
        Ok(able) => {
            check_fit(choice, &able, findings);
            check_quantity(choice, &able, held, findings);
        }
        Err(error @ DeviceError::Setting { .. }) => {
            add_error(error, findings);
            return None;
        }
        Err(error) => findings.add(rule::DEVICE_ABSENT, "/device/adapter", error.to_string()),
    }
    Some(settings)
}

/// Combines the settings of the user, the profile and the scene.
fn settle(
    choice: &DeviceChoice,
    change: &DeviceOverride,
    stem: &str,
    descriptor: &Descriptor,
    findings: &mut Findings,
) -> Option<Settings> {
    let mut asked = texts(choice, descriptor, findings)?;
    let mut given = change.settings.clone();
    let mut profile = change.profile.as_deref();
    let is_hardware = |s: &Setting| s.from_scene == FromScene::Never;
    if change.rehearsal {
        report_hardware(descriptor, &asked, findings);
        // In a rehearsal, the scene's settings count as the user's settings. Otherwise the scene's
        // hardware settings would be ignored.
        for (name, value) in std::mem::take(&mut asked) {
            given.entry(name).or_insert(value);
        }
        profile = profile.or(choice.profile.as_deref());
    } else if !descriptor.settings.iter().any(is_hardware) {
        // If no setting describes hardware, a profile cannot describe hardware either.
        profile = profile.or(choice.profile.as_deref());
    } else if let (None, Some(named)) = (profile, &choice.profile) {
        findings.add(rule::DEVICE_HARDWARE, "/device/profile", format!(
            "the scene's profile {named} is ignored, since it describes the hardware; if it matches yours, give `profile {named}` to the player"
        ));
    }
    for setting in descriptor.settings.iter().filter(|s| s.default.is_none()) {
        if setting.kind == SettingKind::Path {
            let format = given.get("format").or(asked.get("format")).cloned();
            given
                .entry(setting.name.clone())
                .or_insert_with(|| change.output(stem, format.as_ref()));
        }
    }
    let requests = SettingRequests { profile, given: &given, asked: &asked, live: change.live };
    let settled = Settings::settle(descriptor, &requests);
    let (settings, ignored) = settled.map_err(|error| add_error(error, findings)).ok()?;
    for IgnoredSetting { name, what } in ignored {
        let pointer = format!("/device/settings/{}", escape(&name));
        findings.add(rule::DEVICE_HARDWARE, pointer, what);
    }
    Some(settings)
}

/// Reports settings of the scene that are accepted in a rehearsal, but not for a device that plays.
fn report_hardware(
    descriptor: &Descriptor,
    asked: &BTreeMap<String, String>,
    findings: &mut Findings,
) {
    let is_asked = |s: &&Setting| s.from_scene != FromScene::Any && asked.contains_key(&s.name);
    for Setting { name, .. } in descriptor.settings.iter().filter(is_asked) {
        let pointer = format!("/device/settings/{}", escape(name));
        findings.add(rule::DEVICE_HARDWARE, pointer, format!(
            "the plan uses the scene's {name}; a player takes it from a `profile` or a `setting` of the user, and \
             a scene can at most ask for a lower limit, a shorter buffer or a longer ramp"
        ));
    }
}

fn add_error(error: DeviceError, findings: &mut Findings) {
    let pointer = match &error {
        DeviceError::Setting { name, .. } if name == "profile" => "/device/profile".to_owned(),
        DeviceError::Setting { name, .. } => format!("/device/settings/{}", escape(name)),
        _ => "/device".to_owned(),
    };
    findings.add(rule::DEVICE_SETTING, pointer, error.to_string());
}

/// Returns the scene's settings as text, or `None` if a setting is invalid. Leaves out files,
/// because a scene must not name them.
fn texts(
    choice: &DeviceChoice,
    descriptor: &Descriptor,
    findings: &mut Findings,
) -> Option<BTreeMap<String, String>> {
    let mut usable = true;
    let mut texts = BTreeMap::new();
    for (name, value) in &choice.settings {
        let pointer = format!("/device/settings/{}", escape(name));
        let Some(text) = text(value) else {
            let message = "invalid type of a setting; write text, a number, true or false";
            findings.add(rule::DEVICE_SETTING, pointer, message.to_owned());
            usable = false;
            continue;
        };
        if name == DRIVER {
            let message = format!(
                "{text} is a library to load, which a scene must not name; give `setting {DRIVER}={text}` to the player"
            );
            findings.add(rule::DEVICE_PATH_UNSAFE, pointer, message);
            usable = false;
        } else if is_path(descriptor, name) {
            let message = format!(
                "{text} is ignored: a scene must not name output files; give `setting {name}=FILE` to the player"
            );
            findings.add(rule::DEVICE_PATH_UNUSED, pointer, message);
        } else {
            texts.insert(name.clone(), text);
        }
    }
    usable.then_some(texts)
}

fn text(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(_) | Value::Bool(_) => Some(value.to_string()),
        _ => None,
    }
}

fn is_path(descriptor: &Descriptor, name: &str) -> bool {
    let mut settings = descriptor.settings.iter();
    settings.any(|s| s.name == name && s.kind == SettingKind::Path)
}

fn check_fit(choice: &DeviceChoice, able: &Capabilities, findings: &mut Findings) {
    if let Some(rate_hz) = choice.rate_hz {
        findings.require(able.has_rate(rate_hz), rule::DEVICE_RATE, "/device/rate_hz", || {
            let rates = able.rates_text();
            format!("the device does not run at {rate_hz} Hz; it runs at {rates}")
        });
    }
    let keys = [
        ("gain_db", choice.gain_db, able.quantity.is_physical(), "N, m/s2, m/s or m"),
        ("drive_v", choice.drive_v, able.quantity == Quantity::DisplayVoltage, "V"),
        ("level_dbfs", choice.level_dbfs, able.quantity == Quantity::Sound, "FS"),
        ("pitch", choice.pitch, able.quantity == Quantity::Sound, "FS"),
    ];
    let takes = able.quantity.unit();
    for (key, value, fits, unit) in keys {
        let fits = value.is_none() || fits;
        let pointer = format!("/device/{key}");
        findings.require(fits, rule::DEVICE_FIELD_UNFIT, pointer, || {
            format!("{key} applies to devices of {unit}, and this one takes {takes}; leave it out")
        });
    }
    let is_own = choice.levels == Levels::Own;
    findings.require(
        !(is_own && able.quantity.is_physical()),
        rule::DEVICE_FIELD_UNFIT,
        "/device/levels",
        || format!("levels apply to devices of FS or V, and this one takes {takes}; leave it out"),
    );
    findings.require(
        is_own || choice.reference_rms.is_none(),
        rule::DEVICE_FIELD_UNFIT,
        "/device/reference_rms",
        || "reference_rms applies to the levels `own` only; add \"levels\": \"own\", or leave it out".to_owned(),
    );
    let (drive_v, limit_v) = (choice.drive_v.unwrap_or(0.0), able.limit.unwrap_or(f64::MAX));
    findings.require(drive_v <= limit_v, rule::DEVICE_DRIVE_TOO_HIGH, "/device/drive_v", || {
        format!("{drive_v} V is above the device's limit of {limit_v} V; lower it")
    });
}

/// Checks that the device can play the assets' quantity.
fn check_quantity(
    choice: &DeviceChoice,
    able: &Capabilities,
    held: Option<Held>,
    findings: &mut Findings,
) {
    let Some(held) = held else { return };
    if let Some(sentence) = quantity_misfit(held, able.quantity, choice.quantity_gain) {
        findings.add(rule::DEVICE_QUANTITY, "/device/quantity_gain", sentence);
    }
}

/// Returns the quantity that a device must have to play a texture's samples unchanged.
pub(crate) fn device_quantity(held: Held) -> Quantity {
    match held {
        Held::LateralForce => Quantity::LateralForce,
        Held::NormalForce => Quantity::NormalForce,
        Held::Acceleration => Quantity::Acceleration,
        Held::Velocity => Quantity::Velocity,
        Held::Displacement => Quantity::Displacement,
    }
}

/// Returns the reason why a device cannot play assets of a quantity, with the given gain or, if
/// there is none, without a gain. Returns `None` if the device can play them.
///
/// Two kinds of device are special. An electrovibration display adds a lateral force, so it plays
/// assets of lateral forces without a gain. A sound device plays every quantity, because the
/// samples are scaled to a level.
pub(crate) fn quantity_misfit(held: Held, device: Quantity, gain: Option<f64>) -> Option<String> {
    let takes = match device {
        Quantity::DisplayVoltage => Quantity::LateralForce.name(),
        other => other.name(),
    };
    let unit = held.unit();
    let is_sound = device == Quantity::Sound;
    match gain {
        None if is_sound || held.name() == takes => None,
        None => Some(format!(
            "the assets hold {held} in {unit}, and the device takes {takes}; choose a device or a setting that takes \
             {held} (a file: quantity={held}), or give the device units per {unit} as quantity_gain"
        )),
        Some(_) if is_sound => Some(
            "quantity_gain does not apply to sound, whose level is set by level_dbfs; leave it out"
                .to_owned(),
        ),
        Some(_) if held.name() == takes => Some(format!(
            "assets and device have the same quantity, {held}; leave quantity_gain out (for a gain use gain_db)"
        )),
        Some(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Assets and devices have separate lists of quantities, because the crate of devices does not
    /// depend on textures. The lists must match.
    #[test]
    fn devices_have_every_quantity_that_assets_have() {
        let physical: Vec<(&str, &str)> = Quantity::ALL
            .iter()
            .filter(|quantity| quantity.is_physical())
            .map(|quantity| (quantity.name(), quantity.unit()))
            .collect();
        let held: Vec<(&str, &str)> =
            Held::ALL.iter().map(|held| (held.name(), held.unit())).collect();
        assert_eq!(physical, held);
    }
}
