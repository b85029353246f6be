//! Checks of the marker, exports, descriptor, endpoints, capabilities, settings and arrays.

use crate::harness::{CheckResult, Finding, made_up_extensions};
use htex_device::abi::Code;
use htex_device::{Descriptor, DeviceError, Direction, Setting, SettingKind, Settings};

use crate::device::case::{Case, skip_missing};

const INVALID_SETTING: i64 = Code::InvalidSetting as i64;

/// Always passes, because a library that could be loaded has the marker and the exports.
pub(crate) fn loaded(case: &Case) -> CheckResult {
    case.native()?;
    Ok(Finding::passed("the library was loaded"))
}

/// Checks the descriptor of a built-in device. For a library, loading has already checked it.
pub(crate) fn descriptor(case: &Case) -> CheckResult {
    let descriptor = case.adapter.descriptor();
    descriptor.check()?;
    let (id, version) = (&descriptor.id, &descriptor.version);
    let (settings, profiles) = (descriptor.settings.len(), descriptor.profiles.len());
    let message = format!("{id} {version}: {settings} settings, {profiles} profiles");
    Ok(Finding::passed(message).with("settings", settings as f64))
}

/// Checks that the device reports made-up extensions as absent.
pub(crate) fn extensions(case: &Case) -> CheckResult {
    let native = case.native()?;
    made_up_extensions(|id| native.has_extension(id))
}

/// Checks that each endpoint names a setting of the descriptor. An empty list or a missing driver
/// is valid.
pub(crate) fn endpoints(case: &Case) -> CheckResult {
    let descriptor = case.adapter.descriptor();
    let known = |name: &str| descriptor.settings.iter().any(|setting| setting.name == name);
    match case.adapter.endpoints() {
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

/// Checks the capabilities with the given settings and with each profile.
pub(crate) fn capabilities(case: &Case) -> CheckResult {
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
    let limit = can.limit.map_or("no limit".to_owned(), |limit| format!("limit {limit} {unit}"));
    Ok(Finding::passed(format!("{limit}, {}", can.rates)))
}

/// Checks that unusable settings are refused, by `open` and by an output's `capabilities`.
pub(crate) fn bad_settings(case: &Case) -> CheckResult {
    let native = case.native()?;
    let (descriptor, settings) = (case.adapter.descriptor(), case.settings()?);
    if case.direction() == Direction::Input {
        native.open_native_input(&settings).map_err(skip_missing)?;
        return refused(descriptor, &settings, |lines| native.refusal_of_open(lines, 0.0, 0));
    }
    let format = case.format()?;
    let asked = refused(descriptor, &settings, |lines| {
        match native.capabilities_of(lines) {
            Ok(_) => None,
            // If the error text names no setting, the whole text is in `what`.
            Err(DeviceError::Setting { name, what }) if name.is_empty() => {
                Some((INVALID_SETTING, what))
            }
            Err(DeviceError::Setting { name, what }) => {
                Some((INVALID_SETTING, format!("{name}: {what}")))
            }
            Err(error) => Some((0, error.to_string())),
        }
    });
    let asked = asked.map_err(|finding| of_call("capabilities", finding))?;
    let refusal = |lines: &str| native.refusal_of_open(lines, format.rate_hz, format.block_frames);
    refused(descriptor, &settings, refusal).map_err(|finding| of_call("open", finding))?;
    Ok(asked)
}

fn of_call(call: &str, finding: Finding) -> Finding {
    Finding::failed(format!("`{call}`: {}", finding.message))
}

/// Unusable lines of settings, and how the text of the resulting error must begin.
struct WrongLines {
    what: String,
    lines: String,
    /// Beginning of the error text: a setting's name, or the line; empty for an empty line.
    begins: String,
}

/// Checks that unusable lines are refused with a text that begins with the setting's name.
/// `refusal` returns the status and the text, or `None` if the adapter accepts the lines.
fn refused(
    descriptor: &Descriptor,
    settings: &Settings,
    refusal: impl Fn(&str) -> Option<(i64, String)>,
) -> CheckResult {
    let wrong = wrong(descriptor, &settings.to_lines(descriptor));
    for WrongLines { what, lines, begins } in &wrong {
        let Some((status, text)) = refusal(lines) else {
            return Err(Finding::failed(format!("it takes {what}")));
        };
        let is_named = text
            .strip_prefix(begins.as_str())
            .is_some_and(|rest| rest.starts_with(": ") || begins.is_empty());
        if status != INVALID_SETTING {
            return Err(Finding::failed(format!(
                "{what} is refused, but not as an invalid setting: {text}"
            )));
        }
        if !is_named || text.is_empty() {
            return Err(Finding::failed(format!(
                "{what} is refused with the text `{text}`; it must begin with `{begins}: `"
            )));
        }
    }
    let count = wrong.len();
    Ok(Finding::passed(format!("{count} wrong settings are refused by name"))
        .with("settings", count as f64))
}

/// Builds settings with exactly one error each; all other settings are valid.
fn wrong(descriptor: &Descriptor, good: &str) -> Vec<WrongLines> {
    let mut single = vec![
        "no_such_setting_=1\n".to_owned(),
        "no line of settings\n".to_owned(),
        "\n".to_owned(),
    ];
    single.extend(descriptor.settings.iter().flat_map(wrong_lines));
    let in_place = single.into_iter().map(|line| {
        let begins = line.trim_end().split('=').next().unwrap_or_default();
        // Leaves out the valid line of the same setting, because two lines for one setting would be
        // a second error.
        let others = good.lines().filter(|l| !l.starts_with(&format!("{begins}=")));
        let others: String = others.flat_map(|l| [l, "\n"]).collect();
        WrongLines {
            what: format!("the line `{}`", line.trim_end()),
            lines: format!("{others}{line}"),
            begins: begins.to_owned(),
        }
    });
    let twice = good.lines().map(|line| WrongLines {
        what: format!("a second line `{line}`"),
        lines: format!("{good}{line}\n"),
        begins: line.split('=').next().unwrap_or_default().to_owned(),
    });
    in_place.chain(twice).collect()
}

/// Returns lines that give a setting an invalid value.
fn wrong_lines(setting: &Setting) -> Vec<String> {
    let values = match &setting.kind {
        SettingKind::Number { max, .. } => {
            vec![
                "".to_owned(),
                "NaN".to_owned(),
                "one".to_owned(),
                format!("{}", max + max.abs() + 1.0),
            ]
        }
        SettingKind::Choice { .. } => vec!["".to_owned(), "no such choice".to_owned()],
        SettingKind::Path | SettingKind::Text => Vec::new(),
    };
    let line = |value: &String| format!("{}={value}\n", setting.name);
    values.iter().map(line).collect()
}

/// Checks that unusable arrays are refused, and that no call writes beyond the arrays that it gets.
pub(crate) fn arrays(case: &Case) -> CheckResult {
    case.native()?.check_arrays(&case.settings()?, &case.format()?)?;
    let kept = "null and misaligned arrays are refused, and nothing is written beyond an array";
    Ok(Finding::passed(kept))
}
