//! Scenes: loading, planning, following a finger, rendering. Without the feature `scene`, each call
//! returns an error that names this feature.

use std::ffi::c_char;

use crate::options::htex_open_options;
use crate::reader::htex_files;
use crate::status::htex_status;

/// A scene that plays: surfaces, a finger's motion over them, and the samples that result. Only one
/// thread at a time may use a scene. An `id` of 0 never stands for a scene.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_scene {
    /// Private.
    pub id: u64,
}

/// Options for opening a scene. Set `size` to sizeof(htex_scene_options), and all other fields to
/// zero for the defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_scene_options {
    /// sizeof(htex_scene_options).
    pub size: u32,
    /// Sample rate, Hz; 0 for 20000.
    pub rate_hz: f64,
}

/// Position and motion of a finger over a scene.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_finger {
    /// sizeof(htex_finger).
    pub size: u32,
    /// Scanning speed, mm/s; negative on the back stroke.
    pub speed_mm_s: f64,
    /// Normal force, N; not negative.
    pub force_n: f64,
    /// Position x, mm. If the position is unknown, set both `x_mm` and `y_mm` to NAN. The finger
    /// then touches every surface that has no region.
    pub x_mm: f64,
    /// Position y, mm; see `x_mm`.
    pub y_mm: f64,
}

/// [any thread; reads files] Loads a scene file and its assets, and plans which processing stages
/// the scene needs. The call does not open the device that the scene file names, so the rendered
/// samples have the unit of the assets. `open` and `options` may be NULL for the defaults.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_scene_open(
    path: *const c_char,
    open: *const htex_open_options,
    options: *const htex_scene_options,
    out: *mut htex_scene,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::open_path(path, open, options, out) }
}

/// [any thread; reads files] Does the same as htex_scene_open, for a Windows path in UTF-16.
#[cfg(windows)]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_scene_open_wide(
    path: *const u16,
    open: *const htex_open_options,
    options: *const htex_scene_options,
    out: *mut htex_scene,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::open_wide(path, open, options, out) }
}

/// [any thread] Does the same as htex_scene_open, for a scene file in memory. The library reads the
/// other files of the scene through `files`. The library uses the bytes and `files` only during the
/// call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_scene_from_bytes(
    bytes: *const u8,
    len: usize,
    files: *const htex_files,
    open: *const htex_open_options,
    options: *const htex_scene_options,
    out: *mut htex_scene,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::from_bytes(bytes, len, files, open, options, out) }
}

/// [one thread at a time; not the real-time thread] Frees a scene.
#[unsafe(no_mangle)]
pub extern "C" fn htex_scene_free(scene: htex_scene) -> htex_status {
    calls::free(scene)
}

/// [one thread at a time] Writes the scene's plan as JSON: which processing stages run, which are
/// left out, and why. `out`, `capacity` and `length` work as in htex_asset_manifest_json.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_scene_plan_json(
    scene: htex_scene,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::plan_json(scene, out, capacity, length) }
}

/// [one thread at a time] Writes the sample rate of the scene, Hz.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_scene_rate_hz(scene: htex_scene, out: *mut f64) -> htex_status {
    // SAFETY: the caller passed this pointer.
    unsafe { calls::rate_hz(scene, out) }
}

/// [one thread at a time; real-time: neither allocates nor locks] Sets the position and motion of
/// the finger. The call has an effect only if the scene's motion is `live`, which means that the
/// program supplies the motion.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_scene_set_finger(
    scene: htex_scene,
    finger: *const htex_finger,
) -> htex_status {
    // SAFETY: the caller passed this pointer to a finger.
    unsafe { calls::set_finger(scene, finger) }
}

/// [one thread at a time; real-time: neither allocates nor locks] Renders the next `frames`
/// samples. `rendered` receives the number of samples that were rendered. Fewer than `frames`
/// samples are rendered at the end of the scene. If a model fails, its surface becomes silent, the
/// other surfaces play on, and the call returns the error.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_scene_render(
    scene: htex_scene,
    out: *mut f32,
    frames: usize,
    rendered: *mut usize,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::render(scene, out, frames, rendered) }
}

/// [one thread at a time; real-time: neither allocates nor locks] Makes the scene end as soon as
/// possible: the next samples fade to silence.
#[unsafe(no_mangle)]
pub extern "C" fn htex_scene_stop(scene: htex_scene) -> htex_status {
    calls::stop(scene)
}

#[cfg(feature = "scene")]
#[path = "scene/calls.rs"]
mod calls;
#[cfg(feature = "scene")]
pub(crate) use calls::clear;

#[cfg(not(feature = "scene"))]
mod calls {
    //! The scene calls in builds without the feature `scene`. Each one returns an error.
    use super::*;
    use crate::status::{Failure, guarded};

    fn absent() -> htex_status {
        guarded(|| {
            Err(Failure::plain(
                htex_status::HTEX_STATUS_UNSUPPORTED,
                "this build of the library has no scenes; build it with the feature `scene`",
            ))
        })
    }

    pub(super) unsafe fn open_path(
        _: *const c_char,
        _: *const htex_open_options,
        _: *const htex_scene_options,
        _: *mut htex_scene,
    ) -> htex_status {
        absent()
    }

    #[cfg(windows)]
    pub(super) unsafe fn open_wide(
        _: *const u16,
        _: *const htex_open_options,
        _: *const htex_scene_options,
        _: *mut htex_scene,
    ) -> htex_status {
        absent()
    }

    pub(super) unsafe fn from_bytes(
        _: *const u8,
        _: usize,
        _: *const htex_files,
        _: *const htex_open_options,
        _: *const htex_scene_options,
        _: *mut htex_scene,
    ) -> htex_status {
        absent()
    }

    pub(super) fn free(_: htex_scene) -> htex_status {
        absent()
    }

    pub(super) unsafe fn plan_json(
        _: htex_scene,
        _: *mut c_char,
        _: usize,
        _: *mut usize,
    ) -> htex_status {
        absent()
    }

    pub(super) unsafe fn rate_hz(_: htex_scene, _: *mut f64) -> htex_status {
        absent()
    }

    pub(super) unsafe fn set_finger(_: htex_scene, _: *const htex_finger) -> htex_status {
        absent()
    }

    pub(super) unsafe fn render(
        _: htex_scene,
        _: *mut f32,
        _: usize,
        _: *mut usize,
    ) -> htex_status {
        absent()
    }

    pub(super) fn stop(_: htex_scene) -> htex_status {
        absent()
    }
}
