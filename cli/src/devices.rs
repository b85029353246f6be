//! Arguments for finding devices and for their settings, shared by several commands.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;
use htex_check::device::Subject;
use htex_device::{Adapter, DeviceError, Devices, KnownDevice, Settings};
use htex_device_builtin::Optional;

use crate::adapters;
use crate::failure::Failure;

/// Says how to build this program with a device or source that it lacks.
pub(crate) fn built_with(left_out: &Optional) -> String {
    let Optional { what, feature, package, .. } = left_out;
    format!(
        "`cargo install --path cli --features {feature}` builds one with {what}, which on Linux needs {package}"
    )
}

/// Returns the reason why no device or source of this name exists, if this build leaves it out.
/// `instead` is a sentence.
pub(crate) fn left_out(name: &str, instead: &str) -> Option<DeviceError> {
    let left_out = Optional::left_out(name)?;
    let (what, how) = (left_out.what, built_with(&left_out));
    let why = format!("this htex is built without {what}; {how}. {instead}");
    Some(DeviceError::Missing(why))
}

/// Where to search for devices.
#[derive(Args, Default)]
#[command(next_help_heading = "Devices")]
pub(crate) struct DeviceArgs {
    /// A device's native library (it runs with all your rights: load only what you trust); may be
    /// given several times
    #[arg(long, value_name = "FILE")]
    device_file: Vec<PathBuf>,

    /// A folder of such libraries, searched before HTEX_DEVICE_PATH and the user's own folder
    #[arg(long, value_name = "DIR")]
    device_dir: Vec<PathBuf>,
}

impl DeviceArgs {
    /// Returns the devices that are found. Reports those that shadow others on standard error.
    pub(crate) fn devices(&self) -> Result<Devices, Failure> {
        Ok(adapters::reported(self.devices_quietly()?))
    }

    /// Returns the devices as [`Self::devices`] does, but without reports.
    pub(crate) fn devices_quietly(&self) -> Result<Devices, Failure> {
        let search = adapters::search(&self.device_file, &self.device_dir);
        Ok(Devices::search(htex_device_builtin::devices(), &search)?)
    }

    /// Returns the reason why no device of this name exists, if this build leaves it out.
    pub(crate) fn missing(name: &str) -> Option<DeviceError> {
        let instead =
            "`--device` names another device, and `htex synth` and `htex render` write files";
        left_out(name, instead)
    }

    /// Returns the device in the file of this name if the file exists, else the device with this
    /// short name or id.
    pub(crate) fn named(&self, name: &str) -> Result<KnownDevice, Failure> {
        let found = adapters::named(name, || self.devices());
        found.map_err(|error| match Self::missing(name) {
            Some(why) if error.is_unknown_name() => why.into(),
            _ => error,
        })
    }

    /// Returns the device as [`Self::named`] does, but for a checker, which loads a library itself.
    pub(crate) fn subject(&self, name: &str) -> Result<Subject, Failure> {
        adapters::subject(name, || self.devices_quietly())
    }

    /// Returns these arguments for another run of this program.
    pub(crate) fn again(&self) -> Vec<OsString> {
        let files = self.device_file.iter().map(|path| ("--device-file", path));
        let dirs = self.device_dir.iter().map(|path| ("--device-dir", path));
        adapters::again(files.chain(dirs))
    }
}

/// The settings of a device or source.
#[derive(Args)]
#[command(next_help_heading = "Settings")]
pub(crate) struct SettingArgs {
    /// A named group of settings
    #[arg(long, value_name = "NAME")]
    profile: Option<String>,

    /// A setting of the device or source, e.g. rate_hz=20000, which overrides the profile; may be
    /// given several times
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

    /// Returns these arguments for another run of this program.
    pub(crate) fn again(&self) -> Vec<OsString> {
        let profile = self.profile.iter().map(|name| ("--profile", name));
        let settings = self.settings.iter().map(|pair| ("--set", pair));
        let pair = |(flag, value): (&str, &String)| [flag.into(), value.into()];
        profile.chain(settings).flat_map(pair).collect()
    }

    /// Returns all settings of an adapter.
    pub(crate) fn resolve(&self, adapter: &dyn Adapter) -> Result<Settings, Failure> {
        let given = self.given()?;
        let settings = Settings::resolve(adapter.descriptor(), self.profile(), &given)?;
        Ok(settings)
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
