use clap::Args;
use htex_base::finding::plain;
use htex_device::{AdapterEntry, Descriptor, Direction, Profile, Setting, SettingKind};
use serde_json::{Value, json};

use crate::devices::DeviceArgs;
use crate::failure::{Exit, Failure};
use crate::invocation;
use crate::output::{print, print_json, tamed};

/// List all output and input devices.
///
/// An adapter is the code for one kind of device, e.g. sound cards. The command prints each
/// adapter, its settings, and the connected devices of its kind. Notes at the end name the adapters
/// that htex found but does not use.
///
/// htex searches for adapters in this order: --device-file, --device-dir, the folders in
/// HTEX_DEVICE_PATH, the user's folder, the folders of all users, the adapters built into this
/// program. If two outputs or two inputs have the same id, htex uses only the first that it finds.
///
/// The command does not load the native libraries that it finds in these folders. Instead, it reads
/// the descriptor files beside these libraries, which `htex plugin export` and `htex plugin
/// install` write. To list the connected devices of such a library, name the library with
/// --device-file.
#[derive(Args)]
pub(crate) struct List {
    #[command(flatten)]
    devices: DeviceArgs,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The environment variable that sets how much the OpenXR loader prints. If the variable is not
/// set, the loader prints errors on a machine without an OpenXR runtime.
const LOADER_PRINTS: &str = "XR_LOADER_DEBUG";

impl List {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        match listed_quietly() {
            Some(exit) => Ok(exit),
            None => self.list(),
        }
    }

    fn list(&self) -> Result<Exit, Failure> {
        let devices = self.devices.described()?;
        let notes = devices.notes().iter().map(ToString::to_string);
        let directions = [Direction::Output, Direction::Input].into_iter();
        if self.json {
            let entries = directions.flat_map(|direction| devices.of_direction(direction));
            print_json(&json!({
                "devices": entries.map(listed_json).collect::<Vec<_>>(),
                "notes": notes.collect::<Vec<_>>(),
            }))?;
        } else {
            let section = |direction| {
                let entries: String = devices.of_direction(direction).map(listed_text).collect();
                format!("{direction}s\n{entries}")
            };
            let mut text: String = directions.map(section).collect();
            text.extend(notes.map(|note| format!("note: {}\n", plain(&note))));
            print(&text)?;
        }
        Ok(Exit::SUCCESS)
    }
}

/// Runs the command in a second process, in which the OpenXR loader prints nothing. (A process
/// cannot safely change its own environment.) Returns `None` if the user or this program has
/// already set the variable [`LOADER_PRINTS`], or if no second process can be started.
fn listed_quietly() -> Option<Exit> {
    if std::env::var_os(LOADER_PRINTS).is_some() {
        return None;
    }
    let mut command = invocation::program().ok()?.command();
    command.args(invocation::arguments()).env(LOADER_PRINTS, "none");
    Some(match command.status().ok()?.code() {
        Some(0) => Exit::SUCCESS,
        Some(code) if code == i32::from(Exit::USAGE.code()) => Exit::USAGE,
        // This case includes a process that a signal ended: such a process has no exit code.
        _ => Exit::FAILURE,
    })
}

/// Describes an adapter and the connected devices as JSON. A missing driver is no error: the
/// description of the adapter states the problem.
fn listed_json(entry: &AdapterEntry) -> Value {
    let descriptor = entry.descriptor();
    let (endpoints, problem) = match entry.adapter.endpoints() {
        Ok(endpoints) => (endpoints, None),
        Err(error) => (Vec::new(), Some(error.to_string())),
    };
    let mut listed = json!({
        "id": descriptor.id,
        "name": descriptor.name,
        "version": descriptor.version,
        "summary": descriptor.summary,
        "direction": descriptor.direction,
        "target": descriptor.target,
        "origin": entry.origin.to_string(),
        "settings": descriptor.settings,
        "profiles": descriptor.profiles,
        "mapping": descriptor.mapping,
        "endpoints": endpoints,
    });
    if let (Some(problem), Some(listed)) = (problem, listed.as_object_mut()) {
        listed.insert("problem".to_owned(), problem.into());
    }
    listed
}

/// Describes an adapter as text: settings and connected devices.
fn listed_text(entry: &AdapterEntry) -> String {
    // `print` keeps line breaks, so without this a text from a native library could add lines to
    // the output.
    let descriptor = &tamed(entry.descriptor());
    let (name, version) = (descriptor.short_name(), &descriptor.version);
    let mut text = format!("  {name:8} {version:8} {:20} {}\n", descriptor.id, entry.origin);
    text += &format!("           {}\n", descriptor.summary);
    let setting = |s: &Setting| format!("{}={}", s.name, s.default.as_deref().unwrap_or("…"));
    let settings: Vec<String> = descriptor.settings.iter().map(setting).collect();
    text += &format!("           settings: {}\n", settings.join(" "));
    match entry.adapter.endpoints() {
        Ok(endpoints) => {
            for there in endpoints.iter().map(tamed) {
                let choice = format!("{}={}", there.setting, there.name);
                text += &format!("           {choice}  {}\n", there.summary);
            }
        }
        Err(error) => text += &format!("           not usable here: {error}\n"),
    }
    text
}

/// Describes an adapter with all its settings and profiles as text.
pub(super) fn descriptor_text(descriptor: &Descriptor) -> String {
    let Descriptor { id, name, version, summary, .. } = descriptor;
    let settings: String = descriptor.settings.iter().map(setting).collect();
    let profiles: String = descriptor.profiles.iter().map(profile).collect();
    let none = |text: String| if text.is_empty() { "  none\n".to_owned() } else { text };
    let (settings, profiles) = (none(settings), none(profiles));
    format!("{name} ({id} {version})\n{summary}\n\nsettings\n{settings}\nprofiles\n{profiles}")
}

fn setting(setting: &Setting) -> String {
    let values = match &setting.kind {
        SettingKind::Number { min, max } => format!("{min} to {max}"),
        SettingKind::Choice { values } => values.join(" or "),
        SettingKind::Path => "a file".to_owned(),
        SettingKind::Text => "text".to_owned(),
    };
    let default = match &setting.default {
        Some(default) => match &setting.live_default {
            Some(live) => format!("[{default}; {live} with --motion]"),
            None => format!("[{default}]"),
        },
        None => "(must be given)".to_owned(),
    };
    let (name, description) = (&setting.name, &setting.description);
    format!("  {name}: {values} {default}\n      {description}\n")
}

fn profile(profile: &Profile) -> String {
    let fixed = profile.settings.iter();
    let fixed: Vec<String> = fixed.map(|(name, value)| format!("{name}={value}")).collect();
    let (name, summary) = (&profile.name, &profile.summary);
    format!("  {name}: {summary}\n      {}\n", fixed.join(" "))
}
