//! The SDL 2 functions that this adapter calls, as `SDL_joystick.h`, `SDL.h`, `SDL_hints.h` and
//! `SDL_error.h` declare them.
#![allow(unsafe_code)] // A loader: the library's functions are C.

use std::ffi::{CStr, c_char, c_int, c_void};

use crate::driver::driver_table;

/// A joystick that SDL has opened.
pub(crate) type Handle = *mut c_void;

driver_table! {
    extern "C", hint: "; SDL 2.0.18 or later is needed";
    set_main_ready = "SDL_SetMainReady": (),
    set_hint = "SDL_SetHint": (*const c_char, *const c_char) -> c_int,
    init = "SDL_InitSubSystem": (u32) -> c_int,
    error = "SDL_GetError": () -> *const c_char,
    update = "SDL_JoystickUpdate": (),
    lock = "SDL_LockJoysticks": (),
    unlock = "SDL_UnlockJoysticks": (),
    count = "SDL_NumJoysticks": () -> c_int,
    name = "SDL_JoystickNameForIndex": (c_int) -> *const c_char,
    instance = "SDL_JoystickGetDeviceInstanceID": (c_int) -> i32,
    open = "SDL_JoystickOpen": (c_int) -> Handle,
    close = "SDL_JoystickClose": (Handle),
    attached = "SDL_JoystickGetAttached": (Handle) -> c_int,
    has_rumble = "SDL_JoystickHasRumble": (Handle) -> c_int,
    rumble = "SDL_JoystickRumble": (Handle, u16, u16, u32) -> c_int,
}

impl Table {
    /// Returns the reason for the last failure in this thread.
    pub(crate) fn reason(&self) -> String {
        // SAFETY: SDL returns a text that ends in zero and lasts until the thread's next call.
        text(unsafe { (self.error)() })
    }
}

/// Copies a text of SDL. Returns an empty text for a null pointer.
pub(crate) fn text(at: *const c_char) -> String {
    if at.is_null() {
        return String::new();
    }
    // SAFETY: SDL's texts end in zero.
    let text = unsafe { CStr::from_ptr(at) };
    text.to_string_lossy().replace(['\n', '\r'], " ")
}
