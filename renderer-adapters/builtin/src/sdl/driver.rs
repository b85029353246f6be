//! The SDL library, which is loaded and initialised on first use. If the program uses several SDL
//! libraries, each is initialised once.
#![allow(unsafe_code)] // The library's functions are C.

use htex_device::DeviceError;

use crate::driver::{DriverCache, DriverLibrary};
use crate::sdl::table::Table;

const LIBRARY: DriverLibrary = DriverLibrary {
    names: if cfg!(windows) {
        &["SDL2.dll"]
    } else if cfg!(target_os = "macos") {
        &["libSDL2-2.0.0.dylib", "libSDL2.dylib"]
    } else {
        &["libSDL2-2.0.so.0", "libSDL2-2.0.so"]
    },
    loaded_as: "SDL 2",
    setting: "driver",
    absent: "SDL 2 is not installed",
    remedy: if cfg!(target_os = "linux") {
        "Install the package `libsdl2-2.0-0` (Debian, Ubuntu) or `SDL2`, or name the library by the setting `driver`"
    } else {
        "Install SDL 2 from libsdl.org, or name the library by the setting `driver`"
    },
};

/// `SDL_INIT_JOYSTICK`.
const JOYSTICK: u32 = 0x200;
/// Hints for SDL. The first two are needed because a program without windows has no focus and no
/// message loop. The third leaves the handling of signals to the program.
const HINTS: [(&std::ffi::CStr, &std::ffi::CStr); 3] = [
    (c"SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS", c"1"),
    (c"SDL_JOYSTICK_THREAD", c"1"),
    (c"SDL_NO_SIGNAL_HANDLERS", c"1"),
];

static LOADED: DriverCache<Driver> = DriverCache::new();

pub(crate) struct Driver {
    /// The setting that named the library.
    pub(crate) path: String,
    pub(crate) table: Table,
}

impl Driver {
    /// Loads the library at `path`, or the installed library if `path` is empty.
    pub(crate) fn load(path: &str) -> Result<&'static Self, DeviceError> {
        LOADED.get_or_load(path, || {
            let table = LIBRARY.load(path, Table::from_library)?;
            start(&table)?;
            Ok(Self { path: path.to_owned(), table })
        })
    }
}

fn start(table: &Table) -> Result<(), DeviceError> {
    // SAFETY: texts that end in zero; initialising is allowed at any time, and counted.
    let code = unsafe {
        for (name, value) in HINTS {
            (table.set_hint)(name.as_ptr(), value.as_ptr());
        }
        // Without this call, SDL refuses to start in a program that does not use SDL's own `main`.
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
