//! Loads native libraries (`.so`, `.dylib`, `.dll`), from a file or by a name that the system's
//! loader searches for.
//!
//! A library is never unloaded, because function pointers, open devices and voices point into its
//! memory.
//!
//! Apart from tests, only this crate loads libraries. As for all other files, a library's file name
//! without a folder means a file in the current folder. The system's loader searches for the
//! library only in two cases: for the library of NI-DAQmx, and for a `driver` setting without a
//! folder, if the current folder has no file of this name.

#[cfg(feature = "key")]
pub mod description;
pub mod folders;

pub use crate::table_of_symbols;

#[cfg(any(unix, windows))]
use std::error::Error;
use std::ffi::OsStr;
use std::io;
use std::path::{Path, absolute};

#[derive(Debug, Clone, Copy)]
pub struct Library(&'static Loaded);

/// The places in which the system's loader searched for a name, for messages.
const SEARCHED: &str = if cfg!(windows) {
    "; the current folder has no such file, and the system finds none in its folders or in the folders of PATH"
} else {
    "; the current folder has no such file, and the system's loader was asked for it (LD_LIBRARY_PATH, the cache of \
     ldconfig, /lib, /usr/lib)"
};

#[cfg(any(unix, windows))]
use libloading::Library as Loaded;

/// The type of a loaded library on systems that have no native libraries.
#[cfg(not(any(unix, windows)))]
#[derive(Debug)]
enum Loaded {}

impl Library {
    /// Loads the library in a file. A relative path, such as a file name without a folder, is
    /// relative to the current folder. The loader's search path is not used.
    ///
    /// # Safety
    /// The caller must trust the library, because this call runs the library's initialisers with
    /// all rights of this program.
    ///
    /// # Errors
    /// Returns an error if the file does not exist, or is not a library for this machine.
    pub unsafe fn from_file(path: &Path) -> io::Result<Self> {
        // The loader would search its own folders for a bare name. Only an absolute path prevents
        // this.
        let path = absolute(path)?;
        // SAFETY: guaranteed by the caller.
        unsafe { load(path.as_os_str()) }
    }

    /// Loads the library that the system's loader finds by this name, such as `libnidaqmx.so.1`.
    ///
    /// # Safety
    /// The caller must trust the library, because this call runs the library's initialisers with
    /// all rights of this program.
    ///
    /// # Errors
    /// Returns an error if the loader does not find a library, or cannot load it.
    pub unsafe fn from_system(name: &str) -> io::Result<Self> {
        // SAFETY: guaranteed by the caller.
        unsafe { load(OsStr::new(name)) }
    }

    /// Loads the library that a setting names: a path, or a name without a folder. A name without a
    /// folder means a file in the current folder or, if there is no such file, the library that the
    /// system's loader finds by this name.
    ///
    /// # Safety
    /// The caller must trust the library, because this call runs the library's initialisers with
    /// all rights of this program.
    ///
    /// # Errors
    /// Returns an error if there is no such library, or it cannot be loaded.
    pub unsafe fn from_name(path: &str) -> io::Result<Self> {
        let file = Path::new(path);
        let is_bare = file.components().count() == 1 && !file.is_absolute();
        if !is_bare || file.is_file() {
            // SAFETY: guaranteed by the caller.
            return unsafe { Self::from_file(file) };
        }
        // SAFETY: guaranteed by the caller.
        let found = unsafe { Self::from_system(path) };
        found.map_err(|reason| io::Error::other(format!("{reason}{SEARCHED}")))
    }

    /// Tries several names in order, and loads the first library that the system's loader finds.
    ///
    /// # Safety
    /// The caller must trust the libraries, because this call runs a library's initialisers with
    /// all rights of this program.
    ///
    /// # Errors
    /// Returns an error if the loader finds none of the libraries. The message gives the reason for
    /// each library.
    pub unsafe fn installed(names: &[&str]) -> io::Result<Self> {
        let mut reasons = Vec::new();
        for name in names {
            // SAFETY: guaranteed by the caller.
            match unsafe { Self::from_system(name) } {
                Ok(library) => return Ok(library),
                Err(reason) => reasons.push(reason.to_string()),
            }
        }
        Err(io::Error::other(reasons.join("; ")))
    }

    /// Returns the function or variable with this name.
    ///
    /// # Safety
    /// The symbol must have the type `T`.
    #[must_use]
    pub unsafe fn symbol<T: Copy>(self, name: &str) -> Option<T> {
        // SAFETY: guaranteed by the caller.
        unsafe { symbol(self.0, name) }
    }
}

/// Looks up functions that a library must have. `missing` makes the error for a missing function.
pub struct Symbols<'a, E> {
    pub library: Library,
    pub missing: &'a dyn Fn(&'static str) -> E,
}

impl<E> Symbols<'_, E> {
    /// Returns the function with this name.
    ///
    /// # Safety
    /// The symbol must have the type `T`.
    ///
    /// # Errors
    /// Returns an error if the library does not have the function.
    pub unsafe fn get<T: Copy>(&self, name: &'static str) -> Result<T, E> {
        // SAFETY: guaranteed by the caller.
        unsafe { self.library.symbol(name) }.ok_or_else(|| (self.missing)(name))
    }
}

/// Makes a table of functions from a library (through [`Symbols`]) or from a module (through any
/// value that has a method `get`). The name of each function is the prefix followed by the name of
/// the field. For a library the macro is unsafe, because each symbol must have the type of its
/// field. If a function is missing, the function that calls the macro returns early with the error.
/// Fields that are not functions follow after a semicolon.
#[macro_export]
macro_rules! table_of_symbols {
    ($symbols:expr, $table:ident, $prefix:literal, $($field:ident)* $(; $other:ident: $value:expr)*) => {
        $table {
            $($field: $symbols.get(concat!($prefix, stringify!($field)))?,)*
            $($other: $value,)*
        }
    };
}

/// # Safety
/// The symbol has the type `T`.
#[cfg(any(unix, windows))]
unsafe fn symbol<T: Copy>(loaded: &Loaded, name: &str) -> Option<T> {
    // SAFETY: guaranteed by the caller.
    let found = unsafe { loaded.get::<T>(name) };
    found.ok().map(|symbol| *symbol)
}

#[cfg(not(any(unix, windows)))]
unsafe fn symbol<T>(loaded: &Loaded, _: &str) -> Option<T> {
    match *loaded {}
}

#[cfg(not(any(unix, windows)))]
unsafe fn load(_: &OsStr) -> io::Result<Library> {
    let none = "there are no native libraries on this platform; use a WASM module";
    Err(io::Error::other(none))
}

/// # Safety
/// Runs the library's initialisers.
#[cfg(any(unix, windows))]
unsafe fn load(name: &OsStr) -> io::Result<Library> {
    // SAFETY: guaranteed by the caller.
    let loaded = unsafe { libloading::Library::new(name) };
    let library = loaded.map_err(|error| io::Error::other(reason(&error)))?;
    Ok(Library(Box::leak(Box::new(library))))
}

/// Returns the message of the system's loader, which is the source of libloading's error.
#[cfg(any(unix, windows))]
fn reason(error: &libloading::Error) -> String {
    match error.source() {
        Some(source) => source.to_string(),
        None => error.to_string(),
    }
}
