//! Finds the adapters that a program can use. An adapter is built into the program or comes from a
//! native library.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use htex_base::native::folders::{data, libraries_in, listed, system};

use crate::{Adapter, Descriptor, DeviceError, Direction, Input, NativeAdapter, Settings};

/// Environment variable that lists folders of libraries, separated as in `PATH`.
const VARIABLE: &str = "HTEX_DEVICE_PATH";
/// The user's folder of libraries, relative to the data folder.
const FOLDER: &str = "htex/devices";

/// Where to search for native libraries of devices. The search has this order: `files`, `dirs`, the
/// folders in the environment variable `HTEX_DEVICE_PATH`, the user's folder, the folders that all
/// users share, and the adapters built into the program. If two adapters of one direction have the
/// same id, the adapter that is found first is used.
#[derive(Debug, Clone)]
pub struct Search {
    /// Library files to load. If one of these files cannot be loaded, the search fails.
    pub files: Vec<PathBuf>,
    /// Folders of libraries. If one of these folders cannot be read, the search fails. If a library
    /// in a folder cannot be loaded, the search continues and adds a [`Note`].
    pub dirs: Vec<PathBuf>,
    /// Whether to search the folders that the environment variable names.
    pub env: bool,
    /// Whether to search `htex/devices` in the user's data folder (`$XDG_DATA_HOME`, else
    /// `~/.local/share`), and then in the folders that all users share (`$XDG_DATA_DIRS`, else
    /// `/usr/local/share` and `/usr/share`).
    pub user_dir: bool,
    /// Whether to read only the descriptor file beside each library in a folder. In this case, the
    /// search loads no library. The program can list the devices that the search finds, but cannot
    /// open them.
    #[cfg(feature = "descriptions")]
    pub only_descriptors: bool,
}

impl Default for Search {
    /// Searches the environment variable and the user's folder; `files` and `dirs` are empty.
    fn default() -> Self {
        Self {
            files: Vec::new(),
            dirs: Vec::new(),
            env: true,
            user_dir: true,
            #[cfg(feature = "descriptions")]
            only_descriptors: false,
        }
    }
}

impl Search {
    /// Loads a library of a folder. Returns `None` if it must not be loaded and no descriptor is
    /// beside it.
    fn load(&self, file: &Path) -> Result<Option<AdapterEntry>, DeviceError> {
        #[cfg(feature = "descriptions")]
        if self.only_descriptors {
            let adapter = crate::described::adapter(file)?;
            let origin = || Origin::Library(file.to_owned());
            return Ok(adapter.map(|adapter| AdapterEntry { adapter, origin: origin() }));
        }
        AdapterEntry::load(file).map(Some)
    }
}

/// Where an adapter's code comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// Linked into this program.
    Builtin,
    /// A native library, which runs with all the rights of this program.
    Library(PathBuf),
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Builtin => f.write_str("built in"),
            Self::Library(path) => path.display().fmt(f),
        }
    }
}

/// An adapter that was found.
#[derive(Clone)]
pub struct AdapterEntry {
    /// The adapter.
    pub adapter: Arc<dyn Adapter>,
    /// Where its code comes from.
    pub origin: Origin,
}

impl AdapterEntry {
    /// Loads an adapter from a native library, whose code then runs with all the rights of this
    /// program.
    ///
    /// # Errors
    /// Returns an error if the file is not a library of this ABI.
    pub fn load(path: &Path) -> Result<Self, DeviceError> {
        let adapter = Arc::new(NativeAdapter::load(path)?);
        Ok(Self { adapter, origin: Origin::Library(path.to_owned()) })
    }

    /// Returns the adapter's name, version, direction, settings and profiles.
    pub fn descriptor(&self) -> &Descriptor {
        self.adapter.descriptor()
    }

    fn has_name(&self, name: &str) -> bool {
        self.descriptor().short_name().eq_ignore_ascii_case(name)
    }
}

impl std::fmt::Debug for AdapterEntry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Descriptor { id, direction, .. } = self.descriptor();
        f.debug_tuple("AdapterEntry").field(id).field(direction).field(&self.origin).finish()
    }
}

/// A note for the user about the search: a problem that is not an error.
#[allow(missing_docs)] // The variants say what a field is.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// Two adapters of one direction have the same id. The adapter that was found first is used.
    Shadowed { direction: Direction, id: String, used: Origin, shadowed: Origin },
    /// Two adapters of one direction with different ids have the same short name. The short name
    /// refers to the adapter that was found first.
    SameName {
        direction: Direction,
        name: String,
        /// The id that the short name means.
        means: String,
        /// The id of the other adapter, which must be written in full.
        other: String,
    },
    /// A library file could not be loaded, or a folder could not be read, and the user did not name
    /// this file or folder explicitly.
    LeftOut { error: DeviceError },
    /// A library in a folder has no descriptor, so the program cannot list its devices without
    /// running the library.
    Undescribed { library: PathBuf },
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Shadowed { direction, id, used, shadowed } => {
                write!(f, "{direction} {id} ({used}) is used in place of ({shadowed})")
            }
            Self::SameName { direction, name, means, other } => write!(
                f,
                "{direction} `{name}` means {means}; write `{other}` in full for the other one"
            ),
            Self::LeftOut { error } => write!(f, "a device is left out: {error}"),
            Self::Undescribed { library } => {
                let library = library.display();
                write!(
                    f,
                    "device {library} was not loaded, and no descriptor is beside it; `htex plugin export {library}` writes one"
                )
            }
        }
    }
}

/// The adapters that a program has found. An output and an input may have the same id and the same
/// short name. An example is a sound card, which is both an output and an input.
#[derive(Debug, Clone, Default)]
pub struct Devices {
    entries: Vec<AdapterEntry>,
    notes: Vec<Note>,
}

impl Devices {
    /// Creates a collection of the adapters linked into the program, without a search.
    pub fn new(builtin: Vec<Arc<dyn Adapter>>) -> Self {
        let mut devices = Self::default();
        devices.add_builtin(builtin);
        devices
    }

    /// Searches for adapters in native libraries, and adds the adapters linked into the program at
    /// the end.
    ///
    /// # Errors
    /// Returns an error if one of the search's `files` cannot be loaded, or one of its `dirs`
    /// cannot be read.
    pub fn search(builtin: Vec<Arc<dyn Adapter>>, search: &Search) -> Result<Self, DeviceError> {
        let mut devices = Self::default();
        for path in &search.files {
            devices.add(AdapterEntry::load(path)?);
        }
        for dir in &search.dirs {
            devices.add_folder(dir, search)?;
        }
        let listed = search.env.then(|| listed(VARIABLE)).into_iter().flatten();
        let own = || data(FOLDER).into_iter().chain(system(FOLDER));
        let own = search.user_dir.then(own).into_iter().flatten();
        for dir in listed.chain(own) {
            if let Err(error) = devices.add_folder(&dir, search) {
                devices.notes.push(Note::LeftOut { error });
            }
        }
        // The built-in adapters are added last, so that a library can replace a built-in adapter of
        // the same id.
        devices.add_builtin(builtin);
        Ok(devices)
    }

    /// Returns all adapters in use. No two adapters of the same direction have the same id.
    pub fn all(&self) -> &[AdapterEntry] {
        &self.entries
    }

    /// Returns notes for the user about libraries that could not be loaded, and about adapters with
    /// the same id or the same short name as another adapter.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Finds an output by its id (e.g. `org.htex.file`) or by its short name (e.g. `file`). The id
    /// is case-sensitive, and the short name is not.
    ///
    /// # Errors
    /// [`DeviceError::Unknown`] with the known names.
    pub fn find_output(&self, name: &str) -> Result<&AdapterEntry, DeviceError> {
        self.find(Direction::Output, name)
    }

    /// Finds an input by its id or short name, with the same rules as [`Self::find_output`].
    ///
    /// # Errors
    /// [`DeviceError::Unknown`] with the known names.
    pub fn find_input(&self, name: &str) -> Result<&AdapterEntry, DeviceError> {
        self.find(Direction::Input, name)
    }

    /// Opens the input that `NAME:TARGET` names, e.g. `file:rec.csv` or `daq:Dev1/ai0:5`, with a
    /// profile and further settings. The part after the first colon becomes the value of the
    /// setting that [`Descriptor::target`] names.
    ///
    /// # Errors
    /// Returns an error if the name is unknown, a setting is invalid, or the input cannot be
    /// opened.
    pub fn open_input(
        &self,
        text: &str,
        profile: Option<&str>,
        given: &BTreeMap<String, String>,
    ) -> Result<Box<dyn Input>, DeviceError> {
        let (name, value) = match text.split_once(':') {
            Some((name, value)) => (name, Some(value)),
            None => (text, None),
        };
        let adapter = &self.find_input(name)?.adapter;
        let mut given = given.clone();
        if let (Some(target), Some(value)) = (&adapter.descriptor().target, value) {
            given.insert(target.clone(), value.to_owned());
        }
        adapter.open_input(&Settings::resolve(adapter.descriptor(), profile, &given)?)
    }

    fn find(&self, direction: Direction, name: &str) -> Result<&AdapterEntry, DeviceError> {
        let by_id = self.of_direction(direction).find(|entry| entry.descriptor().id == name);
        let by_name = || self.of_direction(direction).find(|entry| entry.has_name(name));
        by_id.or_else(by_name).ok_or_else(|| {
            let names = self.of_direction(direction).map(|entry| entry.descriptor().short_name());
            let known = names.collect::<Vec<_>>().join(", ");
            DeviceError::Unknown { direction, wanted: name.to_owned(), known }
        })
    }

    /// Returns the adapters of one direction, without the shadowed adapters.
    pub fn of_direction(&self, direction: Direction) -> impl Iterator<Item = &AdapterEntry> {
        self.entries.iter().filter(move |entry| entry.descriptor().direction == direction)
    }

    fn add_builtin(&mut self, builtin: Vec<Arc<dyn Adapter>>) {
        for adapter in builtin {
            self.add(AdapterEntry { adapter, origin: Origin::Builtin });
        }
    }

    fn add_folder(&mut self, dir: &Path, search: &Search) -> Result<(), DeviceError> {
        let files = libraries_in(dir, None).map_err(|error| DeviceError::File {
            path: dir.display().to_string(),
            what: error.to_string(),
        })?;
        for file in files {
            match search.load(&file) {
                Ok(Some(entry)) => self.add(entry),
                Ok(None) => self.notes.push(Note::Undescribed { library: file }),
                Err(error) => self.notes.push(Note::LeftOut { error }),
            }
        }
        Ok(())
    }

    /// Appends an adapter, unless its id is already present in its direction.
    fn add(&mut self, entry: AdapterEntry) {
        let Descriptor { direction, id, .. } = entry.descriptor().clone();
        let used = self.of_direction(direction).find(|other| other.descriptor().id == id);
        let used = used.map(|used| used.origin.clone());
        if let Some(used) = used {
            self.notes.push(Note::Shadowed { direction, id, used, shadowed: entry.origin });
            return;
        }
        let name = entry.descriptor().short_name();
        let first = self.of_direction(direction).find(|other| other.has_name(name));
        let means = first.map(|first| first.descriptor().id.clone());
        if let Some(means) = means {
            let name = name.to_owned();
            self.notes.push(Note::SameName { direction, name, means, other: id });
        }
        self.entries.push(entry);
    }
}
