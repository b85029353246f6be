//! The common part of arguments and listings for devices and for sources.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use htex_base::finding::plain;
use htex_check::device::Subject;
use htex_device::{
    AdapterKind, Descriptor, Known, Origin, Profile, Registry, Search, Setting, SettingKind,
};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::output::{tamed, warn};

/// Returns the places to search: the named files and folders, then the environment's and the
/// user's.
pub(crate) fn search(files: &[PathBuf], dirs: &[PathBuf]) -> Search {
    Search { files: files.to_vec(), dirs: dirs.to_vec(), ..Search::default() }
}

/// Returns each path after its flag, for another run of this program.
pub(crate) fn again<'a>(pairs: impl Iterator<Item = (&'static str, &'a PathBuf)>) -> Vec<OsString> {
    pairs.flat_map(|(flag, path)| [flag.into(), path.into()]).collect()
}

/// Finds an adapter: the library file of this name if it exists, else the short name or id.
pub(crate) fn named<A: AdapterKind + ?Sized>(
    name: &str,
    known: impl FnOnce() -> Result<Registry<A>, Failure>,
) -> Result<Known<A>, Failure> {
    let file = Path::new(name);
    // A folder does not count. A folder called `sdl` must not hide the device of that name.
    if file.is_file() {
        return Ok(Known::load(file)?);
    }
    Ok(known()?.find(name)?.clone())
}

/// Finds an adapter as [`named`] does, but for a checker, which loads a library itself.
pub(crate) fn subject<A: AdapterKind + ?Sized>(
    name: &str,
    known: impl FnOnce() -> Result<Registry<A>, Failure>,
) -> Result<Subject<A>, Failure> {
    if Path::new(name).is_file() {
        return Ok(Subject::Library(name.into()));
    }
    let known = known()?.find(name)?.clone();
    Ok(match known.origin {
        Origin::Library(path) => Subject::Library(path),
        Origin::Builtin => Subject::Builtin(known.adapter),
    })
}

/// Prints the notes of a search on standard error.
pub(crate) fn reported<A: AdapterKind + ?Sized>(found: Registry<A>) -> Registry<A> {
    let notes: Vec<String> = found.notes().iter().map(ToString::to_string).collect();
    warn(&notes);
    found
}

/// Describes an adapter and the connected devices as JSON. A missing driver is reported with the
/// adapter and is not an error.
pub(crate) fn listed_json<A: AdapterKind + ?Sized>(known: &Known<A>) -> Value {
    let descriptor = known.descriptor();
    let (endpoints, problem) = match known.endpoints() {
        Ok(endpoints) => (endpoints, None),
        Err(error) => (Vec::new(), Some(error.to_string())),
    };
    let mut listed = json!({
        "id": descriptor.id,
        "name": descriptor.name,
        "version": descriptor.version,
        "summary": descriptor.summary,
        "origin": known.origin.to_string(),
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

/// Describes all adapters of a kind as text: settings, connected devices, and the notes of the
/// search.
pub(crate) fn listed_text<A: AdapterKind + ?Sized>(all: &Registry<A>) -> String {
    let mut text = format!("{}s\n", A::WORD);
    text.extend(all.all().iter().map(adapter_text));
    for note in all.notes() {
        text += &format!("note: {}\n", plain(&note.to_string()));
    }
    text
}

fn adapter_text<A: AdapterKind + ?Sized>(known: &Known<A>) -> String {
    // `print` keeps line breaks, so a text of a native library could add lines of its own.
    let descriptor = &tamed(known.descriptor());
    let (name, version) = (descriptor.short_name(), &descriptor.version);
    let mut text = format!("  {name:8} {version:8} {:20} {}\n", descriptor.id, known.origin);
    text += &format!("           {}\n", descriptor.summary);
    let setting = |s: &Setting| format!("{}={}", s.name, s.default.as_deref().unwrap_or("…"));
    let settings: Vec<String> = descriptor.settings.iter().map(setting).collect();
    text += &format!("           settings: {}\n", settings.join(" "));
    match known.endpoints() {
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
pub(crate) fn descriptor_text(descriptor: &Descriptor) -> String {
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
