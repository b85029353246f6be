//! SDL, loaded and initialised on first use, once for each library.
#![allow(unsafe_code)] // The library's functions are C.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use htex_base::native::Library;
use htex_device::DeviceError;

use crate::sdl::table::Table;

/// Names of the installed library, which are tried in turn.
#[cfg(windows)]
const NAMES: &[&str] = &["SDL2.dll"];
#[cfg(target_os = "macos")]
const NAMES: &[&str] = &["libSDL2-2.0.0.dylib", "libSDL2.dylib"];
#[cfg(not(any(windows, target_os = "macos")))]
const NAMES: &[&str] = &["libSDL2-2.0.so.0", "libSDL2-2.0.so"];

/// `SDL_INIT_JOYSTICK`.
const JOYSTICK: u32 = 0x200;
/// A program without windows has no focus and no message loop. Signals must remain the program's
/// own.
const HINTS: [(&std::ffi::CStr, &std::ffi::CStr); 3] = [
    (c"SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS", c"1"),
    (c"SDL_JOYSTICK_THREAD", c"1"),
    (c"SDL_NO_SIGNAL_HANDLERS", c"1"),
];

/// Loaded libraries, by the setting that named them. They are never unloaded.
static LOADED: Mutex<BTreeMap<String, &'static Driver>> = Mutex::new(BTreeMap::new());

pub(crate) struct Driver {
    /// The setting that named the library.
    pub(crate) path: String,
    pub(crate) table: Table,
}

impl Driver {
    /// Loads the library at `path`, or the installed one if `path` is empty.
    pub(crate) fn load(path: &str) -> Result<&'static Self, DeviceError> {
        let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(driver) = loaded.get(path) {
            return Ok(driver);
        }
        let table = match path {
            "" => installed()?,
            _ => named(path)?,
        };
        start(&table)?;
        let path = path.to_owned();
        let driver: &'static Self = Box::leak(Box::new(Self { path: path.clone(), table }));
        loaded.insert(path, driver);
        Ok(driver)
    }
}

fn start(table: &Table) -> Result<(), DeviceError> {
    // SAFETY: texts that end in zero; initialising is allowed at any time, and counted.
    let code = unsafe {
        for (name, value) in HINTS {
            (table.set_hint)(name.as_ptr(), value.as_ptr());
        }
        // Otherwise SDL refuses to start in a program whose `main` is not its own.
        (table.set_main_ready)();
        (table.init)(JOYSTICK)
    };
    match code {
        0 => Ok(()),
        _ => {
            Err(DeviceError::Missing(format!("SDL cannot look for joysticks: {}", table.reason())))
        }
    }
}

fn installed() -> Result<Table, DeviceError> {
    let package = if cfg!(target_os = "linux") {
        "the package `libsdl2-2.0-0` (Debian, Ubuntu) or `SDL2`"
    } else {
        "SDL 2 from libsdl.org"
    };
    // SAFETY: SDL's own names.
    let table = Table::of(unsafe { Library::installed(NAMES) });
    table.map_err(|reason| {
        DeviceError::Missing(format!(
            "SDL 2 is not installed: {reason}. Install {package}, or name the library by the setting `driver`"
        ))
    })
}

/// Loads a library by a path or a bare name. A bare name means a file in the current folder, else a
/// library of the system.
fn named(path: &str) -> Result<Table, DeviceError> {
    // SAFETY: the user named this library as a driver.
    let table = Table::of(unsafe { Library::from_name(path) });
    table.map_err(|reason| DeviceError::Setting {
        name: "driver".to_owned(),
        what: format!("`{path}` cannot be loaded as SDL 2: {reason}"),
    })
}
