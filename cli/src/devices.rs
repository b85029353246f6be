//! Arguments for finding devices and for their settings, shared by several commands.

use std::collections::BTreeMap;
#[cfg(feature = "check")]
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
#[cfg(feature = "lab")]
use htex_device::Input;
use htex_device::{Adapter, AdapterEntry, DeviceError, Devices, Direction, Search};
use htex_device_builtin::Optional;

use crate::failure::Failure;
use crate::output::warn;

/// Says how to build this program with a device that it lacks.
pub(crate) fn built_with(left_out: &Optional) -> String {
    let Optional { what, feature, package, .. } = left_out;
    let needs = package.map(|package| format!(", which on Linux needs {package}"));
    let needs = needs.unwrap_or_default();
    format!("`cargo install --path cli --features {feature}` builds one with {what}{needs}")
}

/// Returns the devices of this program in display order. The first input replays recordings.
fn builtin() -> Vec<Arc<dyn Adapter>> {
    let recordings: Vec<Arc<dyn Adapter>> = vec![
        #[cfg(feature = "lab")]
        Arc::new(htex_lab::record::Replay),
    ];
    recordings.into_iter().chain(htex_device_builtin::devices()).collect()
}

/// Options that set where htex searches for devices.
#[derive(Args, Default)]
#[command(next_help_heading = "Devices")]
pub(crate) struct DeviceArgs {
    /// Load the device in this native library; may be given several times. A library runs with all
    /// your rights, so load only a library that you trust
    #[arg(long, value_name = "FILE")]
    device_file: Vec<PathBuf>,

    /// Search this folder for device libraries, before the folders in HTEX_DEVICE_PATH and the
    /// user's own folder; may be given several times
    #[arg(long, value_name = "DIR")]
    device_dir: Vec<PathBuf>,
}

impl DeviceArgs {
    /// Returns the devices that are found. Prints the notes of the search as warnings, e.g. that a
    /// device shadows another one.
    pub(crate) fn devices(&self) -> Result<Devices, Failure> {
        let devices = self.devices_quietly()?;
        let notes: Vec<String> = devices.notes().iter().map(ToString::to_string).collect();
        warn(&notes);
        Ok(devices)
    }

    /// Returns the devices as [`Self::devices`] does, but prints nothing.
    pub(crate) fn devices_quietly(&self) -> Result<Devices, Failure> {
        Ok(Devices::search(builtin(), &self.search())?)
    }

    /// Returns the devices without loading the libraries in folders. The devices in these libraries
    /// can only be listed.
    pub(crate) fn described(&self) -> Result<Devices, Failure> {
        let search = Search { only_descriptors: true, ..self.search() };
        Ok(Devices::search(builtin(), &search)?)
    }

    fn search(&self) -> Search {
        let (files, dirs) = (self.device_file.clone(), self.device_dir.clone());
        Search { files, dirs, ..Search::default() }
    }

    /// Returns the reason why no output of this name exists, if this build leaves it out.
    pub(crate) fn missing(name: &str) -> Option<DeviceError> {
        let instead =
            "`--device` names another device, and `htex synth` and `htex render` write files";
        left_out(name, instead)
    }

    /// Opens the input that `NAME:TARGET` names.
    #[cfg(feature = "lab")]
    pub(crate) fn open_input(
        &self,
        text: &str,
        profile: Option<&str>,
        given: &BTreeMap<String, String>,
    ) -> Result<Box<dyn Input>, Failure> {
        let name = text.split(':').next().unwrap_or_default();
        let opened = self.devices()?.open_input(text, profile, given);
        opened.map_err(|error| explained(name, Direction::Input, error).into())
    }

    /// Returns these arguments as words of a command line, for another run of this program.
    #[cfg(feature = "check")]
    pub(crate) fn again(&self) -> Vec<OsString> {
        let files = self.device_file.iter().map(|path| ("--device-file", path));
        let dirs = self.device_dir.iter().map(|path| ("--device-dir", path));
        files.chain(dirs).flat_map(|(flag, path)| [flag.into(), path.into()]).collect()
    }
}

/// Returns the reason why no device of this name exists, if this build leaves it out. `instead` is
/// a sentence on what to use instead.
fn left_out(name: &str, instead: &str) -> Option<DeviceError> {
    let left_out = Optional::left_out(name)?;
    let (what, how) = (left_out.what, built_with(&left_out));
    let why = format!("this htex is built without {what}; {how}. {instead}");
    Some(DeviceError::Missing(why))
}

/// Returns the error, or the reason why this build does not have a device of this name.
fn explained(name: &str, direction: Direction, error: DeviceError) -> DeviceError {
    if !matches!(error, DeviceError::Unknown { .. }) {
        return error;
    }
    let why = match direction {
        Direction::Output => DeviceArgs::missing(name),
        Direction::Input => left_out(name, "`htex device list` shows the inputs that it has"),
    };
    why.unwrap_or(error)
}

/// A device and its settings.
#[derive(Args)]
pub(crate) struct OneDeviceArgs {
    /// The device, by short name, id or library file
    #[arg(value_name = "FILE|ID")]
    pub(crate) device: String,

    /// Use the input if both an input and an output have this name
    #[arg(long)]
    input: bool,

    #[command(flatten)]
    pub(crate) devices: DeviceArgs,

    #[command(flatten)]
    pub(crate) settings: SettingArgs,
}

impl OneDeviceArgs {
    /// Returns the file of a library. A folder does not count: a folder called `sdl` must not hide
    /// the device of that name.
    pub(crate) fn file(&self) -> Option<&Path> {
        Some(Path::new(&self.device)).filter(|file| file.is_file())
    }

    /// Finds the device in `devices`: an output of this name, or else an input. With `--input`,
    /// finds only an input.
    pub(crate) fn find(&self, devices: &Devices) -> Result<AdapterEntry, DeviceError> {
        let name = &self.device;
        let found = match devices.find_output(name) {
            Ok(output) if !self.input => Ok(output),
            Err(error) if !self.input => devices.find_input(name).map_err(|_| error),
            _ => devices.find_input(name),
        };
        let direction = if self.input { Direction::Input } else { Direction::Output };
        found.cloned().map_err(|error| explained(name, direction, error))
    }

    /// Loads the library, or finds the device.
    pub(crate) fn load(&self) -> Result<AdapterEntry, Failure> {
        Ok(match self.file() {
            Some(file) => AdapterEntry::load(file)?,
            None => self.find(&self.devices.devices()?)?,
        })
    }

    /// Returns these arguments as words of a command line, for another run of this program.
    #[cfg(feature = "check")]
    pub(crate) fn again(&self) -> Vec<OsString> {
        let mut arguments = self.devices.again();
        arguments.extend(self.settings.again());
        arguments.extend(self.input.then(|| OsString::from("--input")));
        arguments.push((&self.device).into());
        arguments
    }
}

/// The settings of a device.
#[derive(Args)]
#[command(next_help_heading = "Settings")]
pub(crate) struct SettingArgs {
    /// Use this profile, i.e. this group of settings, of the device; `htex device info` lists the
    /// profiles
    #[arg(long, value_name = "NAME")]
    profile: Option<String>,

    /// Change a setting of the device, e.g. rate_hz=20000; may be given several times. Such a
    /// setting overrides the profile
    #[arg(long = "set", value_name = "NAME=VALUE")]
    settings: Vec<String>,
}

impl SettingArgs {
    pub(crate) fn profile(&self) -> Option<&str> {
        self.profile.as_deref()
    }

    /// Returns the settings that were given.
    pub(crate) fn given(&self) -> Result<BTreeMap<String, String>, Failure> {
        pairs("--set", &self.settings)
    }

    /// Returns these arguments as words of a command line, for another run of this program.
    #[cfg(feature = "check")]
    pub(crate) fn again(&self) -> Vec<OsString> {
        let profile = self.profile.iter().map(|name| ("--profile", name));
        let settings = self.settings.iter().map(|pair| ("--set", pair));
        let pair = |(flag, value): (&str, &String)| [flag.into(), value.into()];
        profile.chain(settings).flat_map(pair).collect()
    }
}

/// Parses the NAME=VALUE texts of a flag.
pub(crate) fn pairs(flag: &str, texts: &[String]) -> Result<BTreeMap<String, String>, Failure> {
    let pair = |text: &String| {
        let (name, value) = text
            .split_once('=')
            .ok_or_else(|| Failure::Usage(format!("{flag} {text}: it looks like NAME=VALUE")))?;
        Ok((name.to_owned(), value.to_owned()))
    };
    texts.iter().map(pair).collect()
}
