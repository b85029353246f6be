//! libhtex: the player, the libraries and the scenes of [`htex`] as C functions. `include/htex.h`
//! is generated from this crate.
//!
//! - C refers to objects by handles, which are numbers. A call returns an error if the object was
//!   freed, if the number was never a handle, or if another thread is using the object. None of
//!   these mistakes causes undefined behaviour (see the module `handles`).
//! - A call returns a [`htex_status`]. [`htex_last_error`] returns the text of the calling thread's
//!   last error. No call unwinds.
//! - A struct of options begins with its size in bytes. In every other field, zero selects the
//!   default. Fields that an older header lacks count as zero, so programs that were compiled
//!   against that header still run.
#![warn(missing_docs)]
#![allow(non_camel_case_types)] // The names of the C header.
#![allow(clippy::missing_safety_doc)] // Stated once: see `pointers`.

mod asset;
#[cfg(target_family = "wasm")]
// Pages call these functions by their exported names.
#[allow(unreachable_pub)]
mod browser;
mod device;
mod handles;
mod library;
mod log;
mod memory;
mod motion;
mod options;
mod pointers;
mod reader;
mod scene;
mod shutdown;
mod signed;
mod status;
mod voice;

/// Helpers for writing C functions. The crate in `sdk/bindings/web/author` adds one C function, for
/// which it uses these helpers. The helpers are not part of the C interface.
#[doc(hidden)]
pub mod calls {
    pub use crate::memory::{allocate, free};
    pub use crate::pointers::{needed_text, place, slice};
    pub use crate::status::{Failure, guarded};
}

#[cfg(windows)]
pub use asset::htex_asset_open_wide;
pub use asset::{
    htex_asset, htex_asset_band, htex_asset_condition, htex_asset_condition_count, htex_asset_free,
    htex_asset_from_bytes, htex_asset_level_rms, htex_asset_magnitude, htex_asset_manifest_json,
    htex_asset_name, htex_asset_open, htex_asset_open_reader, htex_asset_representation_count,
    htex_asset_representation_model, htex_asset_unit, htex_band, htex_condition,
};
#[cfg(target_family = "wasm")]
pub use browser::{htex_alloc, htex_free};
pub use device::{
    htex_device, htex_device_counts, htex_device_finish, htex_device_free, htex_device_info_json,
    htex_device_list_json, htex_device_open, htex_device_rate_hz, htex_device_status,
    htex_device_write,
};
#[cfg(windows)]
pub use library::htex_library_open_wide;
pub use library::{
    htex_library, htex_library_asset, htex_library_count, htex_library_entry_json,
    htex_library_free, htex_library_from_bytes, htex_library_name, htex_library_open,
    htex_library_open_reader, htex_library_page_count, htex_library_page_json,
};
pub use log::{htex_log_callback, htex_log_level, htex_set_log};
pub use motion::htex_motion;
pub use options::{
    HTEX_ENGINE_CHECKED, HTEX_ENGINE_OFF, HTEX_ENGINE_SIGNALS, htex_bytes, htex_open_options,
    htex_voice_options,
};
pub use reader::{htex_files, htex_reader};
#[cfg(windows)]
pub use scene::htex_scene_open_wide;
pub use scene::{
    htex_finger, htex_scene, htex_scene_free, htex_scene_from_bytes, htex_scene_open,
    htex_scene_options, htex_scene_plan_json, htex_scene_rate_hz, htex_scene_render,
    htex_scene_set_finger, htex_scene_stop,
};
pub use shutdown::htex_shutdown;
pub use status::{htex_last_error, htex_status, htex_status_text};
pub use voice::{
    htex_envelope, htex_voice, htex_voice_coverage, htex_voice_envelope, htex_voice_envelope_edges,
    htex_voice_free, htex_voice_is_silent, htex_voice_model, htex_voice_new, htex_voice_render,
    htex_voice_render_add, htex_voice_render_path, htex_voice_reset, htex_voice_set_gain,
    htex_voice_set_motion,
};

/// Version of this interface: the major version in the upper 16 bits, the minor version in the
/// lower 16. 0x00010000 is 1.0. A new minor version only adds functions, fields and values.
pub const HTEX_API_VERSION: u32 = 0x0001_0002;

/// [any thread] Returns the interface version of the loaded library, in the same format as
/// HTEX_API_VERSION.
#[unsafe(no_mangle)]
pub extern "C" fn htex_api_version() -> u32 {
    HTEX_API_VERSION
}

/// [any thread] Returns the version of the library, such as "0.2.0". The text stays valid and must
/// not be freed.
#[unsafe(no_mangle)]
pub extern "C" fn htex_version() -> *const std::ffi::c_char {
    const TEXT: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    TEXT.as_ptr().cast()
}
