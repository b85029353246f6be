//! The common part of adapters that use a native driver: finding the driver's library, loading the
//! table of its functions, and reserving the hardware that the driver controls.
#![allow(unsafe_code, reason = "a loader: the user asked to run the driver's initialisers")]

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;
use std::sync::{Mutex, PoisonError};

use htex_base::native::Library;
use htex_device::DeviceError;

/// The library of a driver, which is loaded at run time.
pub(crate) struct DriverLibrary {
    /// Names of the installed library, which are tried in turn.
    pub(crate) names: &'static [&'static str],
    /// For messages: what a library named by the user is loaded as.
    pub(crate) loaded_as: &'static str,
    /// The setting that names a library.
    pub(crate) setting: &'static str,
    /// The sentence that no library is installed.
    pub(crate) absent: &'static str,
    /// The sentence that says what to do if no library is installed.
    pub(crate) remedy: &'static str,
}

impl DriverLibrary {
    /// Loads the library that a setting names: a path or a bare name. A bare name means a file in
    /// the current folder or, if there is none, a library of the system. An empty text means the
    /// installed library. `table` looks up the library's functions.
    pub(crate) fn load<T, E: Display>(
        &self,
        path: &str,
        table: impl Fn(Library) -> Result<T, E>,
    ) -> Result<T, DeviceError> {
        let Self { names, loaded_as, setting, absent, remedy } = self;
        let is_installed = path.is_empty();
        // SAFETY: the user named this library as a driver, or these are the driver's own names.
        let library = unsafe {
            if is_installed { Library::installed(names) } else { Library::from_name(path) }
        };
        let loaded = library.map_err(|error| error.to_string());
        let loaded = loaded.and_then(|library| table(library).map_err(|error| error.to_string()));
        loaded.map_err(|reason| {
            if is_installed {
                return DeviceError::Missing(format!("{absent}: {reason}. {remedy}"));
            }
            let what = format!("`{path}` cannot be loaded as {loaded_as}: {reason}");
            DeviceError::setting(*setting, what)
        })
    }
}

/// The loaded drivers. The key is the setting that named the driver. Drivers are never unloaded,
/// because a driver may have its own threads.
pub(crate) struct DriverCache<T: 'static>(Mutex<BTreeMap<String, &'static T>>);

impl<T> DriverCache<T> {
    pub(crate) const fn new() -> Self {
        Self(Mutex::new(BTreeMap::new()))
    }

    /// Returns the driver at `path`. Loads it if this is the first use.
    pub(crate) fn get_or_load(
        &self,
        path: &str,
        load: impl FnOnce() -> Result<T, DeviceError>,
    ) -> Result<&'static T, DeviceError> {
        // Locked while the library is loaded, so that it is loaded only once.
        let mut loaded = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(driver) = loaded.get(path) {
            return Ok(driver);
        }
        let driver: &'static T = Box::leak(Box::new(load()?));
        loaded.insert(path.to_owned(), driver);
        Ok(driver)
    }
}

/// Defines the struct `Table` with a function pointer for each given symbol of a C library, and
/// `Table::from_library`, which looks up the symbols. The types must match the library's header.
/// `hint` is appended to the message that a function is missing.
macro_rules! driver_table {
    (
        extern $abi:tt, hint: $hint:literal;
        $($name:ident = $symbol:literal : ($($argument:ty),*) $(-> $result:ty)?,)*
    ) => {
        pub(crate) struct Table {
            $(pub(crate) $name: unsafe extern $abi fn($($argument),*) $(-> $result)?,)*
        }

        impl Table {
            /// Looks up the functions of a library.
            ///
            /// # Errors
            /// Names the function that the library lacks.
            pub(crate) fn from_library(library: htex_base::native::Library) -> Result<Self, String> {
                $(
                    // SAFETY: the name is the library's, and its header states the type.
                    let $name = unsafe { library.symbol($symbol) };
                    let $name = $name.ok_or(concat!("it has no `", $symbol, "`", $hint))?;
                )*
                Ok(Self { $($name,)* })
            }
        }
    };
}
pub(crate) use driver_table;

/// What open devices have reserved. A key is the adapter, the driver, and the name of the reserved
/// hardware.
static CLAIMED: Mutex<BTreeSet<[String; 3]>> = Mutex::new(BTreeSet::new());

/// A reservation of hardware that an open device uses exclusively, such as an output. It is needed
/// because drivers reserve hardware late or not at all. Dropping the reservation releases the
/// hardware.
pub(crate) struct Claim([String; 3]);

impl Claim {
    /// Reserves hardware. `key` is the adapter, the driver, and the name of the hardware. `name` is
    /// its name in messages.
    ///
    /// # Errors
    /// Returns an error if another device has reserved the same hardware.
    pub(crate) fn reserve(key: [&str; 3], name: &str) -> Result<Self, DeviceError> {
        let key = key.map(str::to_owned);
        let mut claimed = CLAIMED.lock().unwrap_or_else(PoisonError::into_inner);
        if claimed.insert(key.clone()) {
            return Ok(Self(key));
        }
        let what = format!("{name} is open already; finish or drop that device first");
        Err(DeviceError::Busy(what))
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        let mut claimed = CLAIMED.lock().unwrap_or_else(PoisonError::into_inner);
        claimed.remove(&self.0);
    }
}
