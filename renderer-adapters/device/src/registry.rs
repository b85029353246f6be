//! The adapters of devices or sources that a program can find.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use htex_base::native::folders::{data, libraries_in, listed};

use crate::library::Table;
use crate::loaded::Native;
use crate::{Descriptor, DeviceError, Endpoint};

/// Where to search for native libraries of devices or sources. Earlier places take precedence over
/// later ones: `files`, `dirs`, the environment variable (`HTEX_DEVICE_PATH`, `HTEX_SOURCE_PATH`),
/// the user's folder, built in.
#[derive(Debug, Clone)]
pub struct Search {
    /// Library files to load. A file that cannot be loaded is an error.
    pub files: Vec<PathBuf>,
    /// Folders of libraries. A folder that cannot be read is an error. A library in it that cannot
    /// be loaded is only a [`Note`].
    pub dirs: Vec<PathBuf>,
    /// Whether to search the folders that the environment variable names.
    pub env: bool,
    /// Whether to search `htex/devices` or `htex/sources` in the user's data folder
    /// (`$XDG_DATA_HOME`, else `~/.local/share`).
    pub user_dir: bool,
}

impl Default for Search {
    /// All places except `files` and `dirs`.
    fn default() -> Self {
        Self { files: Vec::new(), dirs: Vec::new(), env: true, user_dir: true }
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

/// A kind of adapter: for devices or for sources.
pub trait AdapterKind: Send + Sync + 'static {
    /// The C functions of a native library of this kind.
    type Table: Table;
    /// `device` or `source`.
    const WORD: &'static str;
    /// The environment variable that lists folders of libraries, separated as in `PATH`.
    const VARIABLE: &'static str;
    /// The user's folder of libraries, relative to the data folder.
    const FOLDER: &'static str;

    /// Returns the adapter's name, version, settings and profiles.
    fn about(&self) -> &Descriptor;

    /// Lists the devices or sources that are connected now.
    ///
    /// # Errors
    /// When a driver is missing: the message says what to install.
    fn connected(&self) -> Result<Vec<Endpoint>, DeviceError>;

    /// Wraps the adapter of a native library.
    fn of_native(native: Native<Self::Table>) -> Arc<Self>;

    /// Returns the error that there is no adapter called `wanted`.
    fn unknown(wanted: String, known: String) -> DeviceError;
}

/// An adapter that was found.
pub struct Known<A: ?Sized> {
    /// The adapter.
    pub adapter: Arc<A>,
    /// Where its code comes from.
    pub origin: Origin,
}

impl<A: AdapterKind + ?Sized> Known<A> {
    /// Loads the adapter of a native library, which runs with all the rights of this program.
    ///
    /// # Errors
    /// When the file is not a library of this kind.
    pub fn load(path: &Path) -> Result<Self, DeviceError> {
        Ok(Self {
            adapter: A::of_native(Native::load(path)?),
            origin: Origin::Library(path.to_owned()),
        })
    }

    /// Returns the adapter's name, version, settings and profiles.
    pub fn descriptor(&self) -> &Descriptor {
        self.adapter.about()
    }

    /// Lists the devices or sources that are connected now.
    ///
    /// # Errors
    /// When a driver is missing: the message says what to install.
    pub fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        self.adapter.connected()
    }

    fn id(&self) -> &str {
        &self.descriptor().id
    }

    fn is_named(&self, name: &str) -> bool {
        self.descriptor().short_name().eq_ignore_ascii_case(name)
    }
}

impl<A: ?Sized> Clone for Known<A> {
    fn clone(&self) -> Self {
        Self { adapter: Arc::clone(&self.adapter), origin: self.origin.clone() }
    }
}

impl<A: AdapterKind + ?Sized> std::fmt::Debug for Known<A> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut tuple = f.debug_tuple("Known");
        tuple.field(&self.id()).field(&self.origin).finish()
    }
}

/// Something found during the search that is not an error. `kind` is `device` or `source`.
#[allow(missing_docs)] // The variants say what a field is.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// Two adapters have the same id; the one found first is used.
    Shadowed { kind: &'static str, id: String, used: Origin, shadowed: Origin },
    /// Two adapters with different ids have the same short name. The short name means the one found
    /// first.
    SameName {
        kind: &'static str,
        name: String,
        /// The id that the short name means.
        means: String,
        /// The id of the other adapter, which must be written in full.
        other: String,
    },
    /// A file or folder that the user did not name could not be loaded or read.
    LeftOut { kind: &'static str, error: DeviceError },
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Shadowed { kind, id, used, shadowed } => {
                write!(f, "{kind} {id} ({used}) is used in place of ({shadowed})")
            }
            Self::SameName { kind, name, means, other } => write!(
                f,
                "{kind} `{name}` means {means}; write `{other}` in full for the other one"
            ),
            Self::LeftOut { kind, error } => write!(f, "a {kind} is left out: {error}"),
        }
    }
}

/// Adapters of one kind, by id and by short name.
pub struct Registry<A: ?Sized> {
    known: Vec<Known<A>>,
    notes: Vec<Note>,
}

impl<A: ?Sized> Default for Registry<A> {
    fn default() -> Self {
        Self { known: Vec::new(), notes: Vec::new() }
    }
}

impl<A: ?Sized> Clone for Registry<A> {
    fn clone(&self) -> Self {
        Self { known: self.known.clone(), notes: self.notes.clone() }
    }
}

impl<A: AdapterKind + ?Sized> std::fmt::Debug for Registry<A> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(&self.known).finish()
    }
}

impl<A: AdapterKind + ?Sized> Registry<A> {
    /// Creates a registry of only the adapters linked into a program.
    pub fn new(builtin: Vec<Arc<A>>) -> Self {
        let mut found = Self::default();
        found.add_builtin(builtin);
        found
    }

    /// Creates a registry of the adapters that a search finds, followed by those linked into the
    /// program.
    ///
    /// # Errors
    /// When one of the search's `files` cannot be loaded, or one of its `dirs` cannot be read.
    pub fn search(builtin: Vec<Arc<A>>, search: &Search) -> Result<Self, DeviceError> {
        let mut found = Self::default();
        for path in &search.files {
            found.add_file(path)?;
        }
        for dir in &search.dirs {
            found.add_folder(dir)?;
        }
        for dir in unnamed_folders::<A>(search) {
            if let Err(error) = found.add_folder(&dir) {
                found.notes.push(Note::LeftOut { kind: A::WORD, error });
            }
        }
        // Last, so that a library can replace a built-in adapter of the same id.
        found.add_builtin(builtin);
        Ok(found)
    }

    /// Returns all adapters in use, each id once.
    pub fn all(&self) -> &[Known<A>] {
        &self.known
    }

    /// Returns notes for the user about adapters that shadow others and libraries that could not be
    /// loaded.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Finds an adapter by its id or its short name (`org.htex.file` or `file`, case-insensitive).
    ///
    /// # Errors
    /// [`DeviceError::Unknown`] or [`DeviceError::UnknownSource`] with the known names.
    pub fn find(&self, name: &str) -> Result<&Known<A>, DeviceError> {
        let by_id = self.known.iter().find(|known| known.id() == name);
        let by_name = || self.known.iter().find(|known| known.is_named(name));
        by_id.or_else(by_name).ok_or_else(|| {
            let names = self.known.iter().map(|k| k.descriptor().short_name());
            A::unknown(name.to_owned(), names.collect::<Vec<_>>().join(", "))
        })
    }

    fn add_builtin(&mut self, builtin: Vec<Arc<A>>) {
        for adapter in builtin {
            let origin = Origin::Builtin;
            self.add(Known { adapter, origin });
        }
    }

    fn add_file(&mut self, path: &Path) -> Result<(), DeviceError> {
        self.add(Known::load(path)?);
        Ok(())
    }

    fn add_folder(&mut self, dir: &Path) -> Result<(), DeviceError> {
        let files = libraries_in(dir, None).map_err(|error| DeviceError::File {
            path: dir.display().to_string(),
            what: error.to_string(),
        })?;
        for file in files {
            if let Err(error) = self.add_file(&file) {
                self.notes.push(Note::LeftOut { kind: A::WORD, error });
            }
        }
        Ok(())
    }

    /// Appends an adapter, unless its id is already present.
    fn add(&mut self, one: Known<A>) {
        if let Some(used) = self.known.iter().find(|known| known.id() == one.id()) {
            self.notes.push(Note::Shadowed {
                kind: A::WORD,
                id: one.id().to_owned(),
                used: used.origin.clone(),
                shadowed: one.origin,
            });
            return;
        }
        let name = one.descriptor().short_name();
        if let Some(first) = self.known.iter().find(|known| known.is_named(name)) {
            self.notes.push(Note::SameName {
                kind: A::WORD,
                name: name.to_owned(),
                means: first.id().to_owned(),
                other: one.id().to_owned(),
            });
        }
        self.known.push(one);
    }
}

/// Returns the folders of the environment variable and of the user, which nobody named explicitly.
fn unnamed_folders<A: AdapterKind + ?Sized>(search: &Search) -> impl Iterator<Item = PathBuf> {
    let listed = search.env.then(|| listed(A::VARIABLE));
    let own = search.user_dir.then(|| data(A::FOLDER)).flatten();
    listed.into_iter().flatten().chain(own)
}
