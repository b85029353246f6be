//! The adapters that a program finds.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::{Adapter, Descriptor, DeviceError, NativeAdapter};

/// The environment variable with folders of devices, separated as in `PATH`.
const VARIABLE: &str = "HTEX_DEVICE_PATH";

/// Where native devices are searched. Earlier places take precedence over later ones:
/// `files`, `dirs`, `HTEX_DEVICE_PATH`, the user's folder, built in.
#[derive(Debug, Clone)]
pub struct DeviceSearch {
    /// Libraries by their files; one that cannot be loaded is an error.
    pub files: Vec<PathBuf>,
    /// Folders of libraries; one that cannot be read is an error, a library in it that cannot be
    /// loaded a [`DeviceNote`].
    pub dirs: Vec<PathBuf>,
    /// Whether to look into the folders that the variable `HTEX_DEVICE_PATH` names.
    pub env: bool,
    /// Whether to look into `htex/devices` in the user's data folder (`$XDG_DATA_HOME`, else
    /// `~/.local/share`).
    pub user_dir: bool,
}

impl Default for DeviceSearch {
    /// All places except `files` and `dirs`.
    fn default() -> Self {
        Self {
            files: Vec::new(),
            dirs: Vec::new(),
            env: true,
            user_dir: true,
        }
    }
}

/// Where an adapter's code comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DeviceOrigin {
    /// Linked into this program.
    Builtin,
    /// A native library, which runs with all rights of this program.
    Library(PathBuf),
}

impl std::fmt::Display for DeviceOrigin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Builtin => f.write_str("built in"),
            Self::Library(path) => path.display().fmt(f),
        }
    }
}

/// An adapter that was found.
#[derive(Clone)]
pub struct KnownDevice {
    /// The adapter.
    pub adapter: Arc<dyn Adapter>,
    /// Where it comes from.
    pub origin: DeviceOrigin,
}

impl KnownDevice {
    /// The adapter's descriptor.
    pub fn descriptor(&self) -> &Descriptor {
        self.adapter.descriptor()
    }

    fn id(&self) -> &str {
        &self.descriptor().id
    }

    fn is_named(&self, name: &str) -> bool {
        self.descriptor().short_name().eq_ignore_ascii_case(name)
    }
}

impl std::fmt::Debug for KnownDevice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut tuple = f.debug_tuple("KnownDevice");
        tuple.field(&self.id()).field(&self.origin).finish()
    }
}

/// Something found during the search that is not an error.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum DeviceNote {
    /// Two adapters have the same id; the one found first is used.
    Shadowed {
        /// The id.
        id: String,
        /// The one that is used.
        used: DeviceOrigin,
        /// The one that is not.
        shadowed: DeviceOrigin,
    },
    /// Two adapters of different ids have the same short name, which means the one found first.
    SameName {
        /// The short name.
        name: String,
        /// The id it means.
        means: String,
        /// The id that must be written out.
        other: String,
    },
    /// A file or folder that was not named could not be loaded or read.
    LeftOut(DeviceError),
}

impl std::fmt::Display for DeviceNote {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Shadowed { id, used, shadowed } => {
                write!(f, "device {id} ({used}) is used in place of ({shadowed})")
            }
            Self::SameName { name, means, other } => write!(
                f,
                "device `{name}` means {means}; write `{other}` in full for the other one"
            ),
            Self::LeftOut(error) => write!(f, "a device is left out: {error}"),
        }
    }
}

/// Adapters by id and by short name.
#[derive(Debug, Clone, Default)]
pub struct Devices {
    known: Vec<KnownDevice>,
    notes: Vec<DeviceNote>,
}

impl Devices {
    /// Only those linked into a program.
    pub fn new(builtin: Vec<Arc<dyn Adapter>>) -> Self {
        let mut devices = Self::default();
        devices.add_builtin(builtin);
        devices
    }

    /// Those that a search finds, then those linked into a program.
    ///
    /// # Errors
    /// When one of the search's `files` cannot be loaded, or one of its `dirs` cannot be read.
    pub fn search(
        builtin: Vec<Arc<dyn Adapter>>,
        search: &DeviceSearch,
    ) -> Result<Self, DeviceError> {
        let mut devices = Self::default();
        for path in &search.files {
            devices.add_file(path)?;
        }
        for dir in &search.dirs {
            devices.add_folder(dir)?;
        }
        for dir in unnamed_folders(search) {
            if let Err(error) = devices.add_folder(&dir) {
                devices.notes.push(DeviceNote::LeftOut(error));
            }
        }
        devices.add_builtin(builtin);
        Ok(devices)
    }

    /// All adapters in use, each id once.
    pub fn all(&self) -> &[KnownDevice] {
        &self.known
    }

    /// Notes for the user: devices that shadow others, and those that could not be loaded.
    pub fn notes(&self) -> &[DeviceNote] {
        &self.notes
    }

    /// A device by its id or by its short name (`org.htex.file` or `file`, in any case).
    ///
    /// # Errors
    /// [`DeviceError::Unknown`] with the known names.
    pub fn find(&self, name: &str) -> Result<&KnownDevice, DeviceError> {
        let by_id = self.known.iter().find(|known| known.id() == name);
        let by_name = || self.known.iter().find(|known| known.is_named(name));
        by_id.or_else(by_name).ok_or_else(|| {
            let names = self.known.iter().map(|k| k.descriptor().short_name());
            DeviceError::Unknown {
                wanted: name.to_owned(),
                known: names.collect::<Vec<_>>().join(", "),
            }
        })
    }

    fn add_builtin(&mut self, builtin: Vec<Arc<dyn Adapter>>) {
        for adapter in builtin {
            let origin = DeviceOrigin::Builtin;
            self.add(KnownDevice { adapter, origin });
        }
    }

    fn add_file(&mut self, path: &Path) -> Result<(), DeviceError> {
        let adapter = Arc::new(NativeAdapter::load(path)?);
        let origin = DeviceOrigin::Library(path.to_owned());
        self.add(KnownDevice { adapter, origin });
        Ok(())
    }

    fn add_folder(&mut self, dir: &Path) -> Result<(), DeviceError> {
        let files = libraries_in(dir).map_err(|error| DeviceError::File {
            path: dir.display().to_string(),
            what: error.to_string(),
        })?;
        for file in files {
            if let Err(error) = self.add_file(&file) {
                self.notes.push(DeviceNote::LeftOut(error));
            }
        }
        Ok(())
    }

    /// Adds an adapter behind all others, unless its id is taken.
    fn add(&mut self, device: KnownDevice) {
        if let Some(used) = self.known.iter().find(|known| known.id() == device.id()) {
            self.notes.push(DeviceNote::Shadowed {
                id: device.id().to_owned(),
                used: used.origin.clone(),
                shadowed: device.origin,
            });
            return;
        }
        let name = device.descriptor().short_name();
        if let Some(first) = self.known.iter().find(|known| known.is_named(name)) {
            self.notes.push(DeviceNote::SameName {
                name: name.to_owned(),
                means: first.id().to_owned(),
                other: device.id().to_owned(),
            });
        }
        self.known.push(device);
    }
}

/// The folders of the environment variable and of the user.
fn unnamed_folders(search: &DeviceSearch) -> Vec<PathBuf> {
    let mut folders = Vec::new();
    if search.env {
        let value = std::env::var_os(VARIABLE).unwrap_or_default();
        folders.extend(std::env::split_paths(&value).filter(|dir| !dir.as_os_str().is_empty()));
    }
    folders.extend(user_folder().filter(|dir| search.user_dir && dir.exists()));
    folders
}

/// `htex/devices` in the user's data folder, by the XDG base directory specification, which has
/// relative paths ignored; on Windows in the local application data.
fn user_folder() -> Option<PathBuf> {
    let absolute = |variable: &str| {
        let path = PathBuf::from(std::env::var_os(variable)?);
        path.is_absolute().then_some(path)
    };
    let windows = || absolute("LOCALAPPDATA").filter(|_| cfg!(windows));
    let home = || absolute("HOME").map(|home| home.join(".local/share"));
    let base = absolute("XDG_DATA_HOME").or_else(windows).or_else(home)?;
    Some(base.join("htex/devices"))
}

/// The libraries in a folder, by name.
fn libraries_in(dir: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(dir)? {
        let path = entry?.path();
        if path.extension().and_then(|e| e.to_str()) == Some(std::env::consts::DLL_EXTENSION) {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
