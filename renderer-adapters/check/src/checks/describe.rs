//! The marker, the exports, the descriptor, endpoints and capabilities; those that sources have too are of any kind.

use htex_check_runner::{Finding, Found, made_up_extensions};
use htex_device::{Descriptor, DeviceError, Setting, SettingKind, Settings};

use crate::case::{self, CheckedKind};
use crate::device::Case;

/// A library that was loaded has the marker and the exports.
pub(crate) fn loaded<A: CheckedKind + ?Sized>(case: &case::Case<A>) -> Found {
    case.native()?;
    Ok(Finding::passed("the library was loaded"))
}

/// Loading checks a library's descriptor; this checks that of a built-in device.
pub(crate) fn descriptor(case: &Case) -> Found {
    let descriptor = case.adapter.descriptor();
    descriptor.check()?;
    Ok(described(descriptor))
}

/// A descriptor that is valid.
pub(crate) fn described(descriptor: &Descriptor) -> Finding {
    let (id, version) = (&descriptor.id, &descriptor.version);
    let (settings, profiles) = (descriptor.settings.len(), descriptor.profiles.len());
    let message = format!("{id} {version}: {settings} settings, {profiles} profiles");
    Finding::passed(message).with("settings", settings as f64)
}

/// Made-up extensions are absent.
pub(crate) fn extensions<A: CheckedKind + ?Sized>(case: &case::Case<A>) -> Found {
    let native = case.native()?;
    made_up_extensions(|id| native.has_extension(id))
}

/// Endpoints choose settings of the descriptor; none, or a missing driver, is a valid result.
pub(crate) fn endpoints<A: CheckedKind + ?Sized>(case: &case::Case<A>) -> Found {
    let descriptor = case.adapter.about();
    let known = |name: &str| {
        descriptor
            .settings
            .iter()
            .any(|setting| setting.name == name)
    };
    match case.adapter.connected() {
        Ok(all) => match all.iter().find(|endpoint| !known(&endpoint.setting)) {
            Some(lost) => {
                let (name, setting) = (&lost.name, &lost.setting);
                let message = format!("`{name}` is chosen by `{setting}`, which is not a setting");
                Err(Finding::failed(message))
            }
            None => Ok(Finding::passed(format!("{} are connected", all.len()))),
        },
        Err(DeviceError::Missing(what)) => Ok(Finding::warning(what)),
        Err(error) => Err(error.into()),
    }
}

/// The capabilities, with the given settings and with each profile.
pub(crate) fn capabilities(case: &Case) -> Found {
    let can = case.capabilities()?;
    let checked = can.check();
    checked.map_err(|error| Finding::failed(error.to_string()))?;
    let profiles = &case.adapter.descriptor().profiles;
    for profile in profiles {
        let settings = case.settings_of(Some(&profile.name))?;
        let can = case.adapter.capabilities(&settings);
        let name = &profile.name;
        let wrong =
            |error: &dyn std::fmt::Display| Finding::failed(format!("profile `{name}`: {error}"));
        let can = can.map_err(|error| wrong(&error))?;
        can.check().map_err(|error| wrong(&error))?;
    }
    let unit = can.quantity.unit();
    let limit = can.limit.map_or("no limit".to_owned(), |limit| {
        format!("limit {limit} {unit}")
    });
    Ok(Finding::passed(format!("{limit}, {}", can.rates)))
}

/// Unknown and invalid settings are refused.
pub(crate) fn bad_settings(case: &Case) -> Found {
    let native = case.native()?;
    let descriptor = case.adapter.descriptor();
    refused(descriptor, &case.settings()?, |lines| {
        native.capabilities_of(lines).map(drop)
    })
}

/// Unknown settings and values that are not allowed are refused by `take`, each among valid ones.
pub(crate) fn refused(
    descriptor: &Descriptor,
    settings: &Settings,
    take: impl Fn(&str) -> Result<(), DeviceError>,
) -> Found {
    let good = settings.to_lines(descriptor);
    let mut wrong = vec![
        "no_such_setting_=1\n".to_owned(),
        "no line of settings\n".to_owned(),
    ];
    wrong.extend(descriptor.settings.iter().flat_map(wrong_lines));
    for line in &wrong {
        let name = line.split('=').next().unwrap_or_default();
        let others = good.lines().filter(|l| !l.starts_with(&format!("{name}=")));
        let lines: String = others.flat_map(|l| [l, "\n"]).collect();
        let line = line.trim_end();
        match take(&format!("{lines}{line}\n")) {
            Err(DeviceError::Setting { .. }) => {}
            Err(error) => return Err(Finding::failed(format!("`{line}`: {error}"))),
            Ok(()) => return Err(Finding::failed(format!("it takes the setting `{line}`"))),
        }
    }
    let count = wrong.len();
    Ok(
        Finding::passed(format!("{count} wrong settings are refused"))
            .with("settings", count as f64),
    )
}

/// Lines of a setting with values that it does not have.
fn wrong_lines(setting: &Setting) -> Vec<String> {
    let values = match &setting.kind {
        SettingKind::Number { max, .. } => vec![
            "".to_owned(),
            "NaN".to_owned(),
            "one".to_owned(),
            format!("{}", max * 2.0 + 1.0),
        ],
        SettingKind::Choice { .. } => vec!["".to_owned(), "no such choice".to_owned()],
        SettingKind::Path | SettingKind::Text => Vec::new(),
    };
    let line = |value: &String| format!("{}={value}\n", setting.name);
    values.iter().map(line).collect()
}
