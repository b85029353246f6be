//! Native libraries (`.so`, `.dylib`, `.dll`), loaded from a file or by a name that the system's loader searches.
//!
//! No library is ever unloaded: function pointers, open devices and voices point into it.

use std::error::Error;
use std::ffi::OsStr;
use std::path::{Path, absolute};

/// A library cannot be loaded; contains the system loader's message.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct LoadError(String);

/// A loaded library.
#[derive(Debug, Clone, Copy)]
pub struct Library(&'static libloading::Library);

impl Library {
    /// Loads the library in a file. A relative path, a bare file name among them, starts at the current folder; the
    /// loader's search path is not used.
    ///
    /// # Safety
    /// Runs the library's initialisers with all rights of this program.
    ///
    /// # Errors
    /// When the file is absent, or not a library for this machine.
    pub unsafe fn from_file(path: &Path) -> Result<Self, LoadError> {
        let path = absolute(path).map_err(|error| LoadError(error.to_string()))?;
        // SAFETY: guaranteed by the caller.
        unsafe { load(path.as_os_str()) }
    }

    /// Loads the library that the system's loader finds by its name, such as `libnidaqmx.so.1`.
    ///
    /// # Safety
    /// Runs the library's initialisers with all rights of this program.
    ///
    /// # Errors
    /// When the loader finds none, or cannot load it.
    pub unsafe fn from_system(name: &str) -> Result<Self, LoadError> {
        // SAFETY: guaranteed by the caller.
        unsafe { load(OsStr::new(name)) }
    }

    /// Returns the function or variable of this name.
    ///
    /// # Safety
    /// The symbol has the type `T`.
    #[must_use]
    pub unsafe fn symbol<T: Copy>(self, name: &str) -> Option<T> {
        // SAFETY: guaranteed by the caller.
        let found = unsafe { self.0.get::<T>(name) };
        found.ok().map(|symbol| *symbol)
    }
}

/// # Safety
/// Runs the library's initialisers.
unsafe fn load(name: &OsStr) -> Result<Library, LoadError> {
    // SAFETY: guaranteed by the caller.
    let loaded = unsafe { libloading::Library::new(name) };
    let library = loaded.map_err(|error| LoadError(reason(&error)))?;
    Ok(Library(Box::leak(Box::new(library))))
}

/// Returns the system loader's message, which is the source of libloading's error.
fn reason(error: &libloading::Error) -> String {
    match error.source() {
        Some(source) => source.to_string(),
        None => error.to_string(),
    }
}
