//! Devices play samples, and are selected by name. Without the feature `scene`, each call returns
//! an error that says so.

use std::ffi::c_char;

use crate::status::htex_status;

/// An open device. Only one thread at a time may use it. Zero is not a device.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_device {
    /// Private.
    pub id: u64,
}

/// What a device has done since it was opened. Set `size` to sizeof(htex_device_counts) before the
/// call.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_device_counts {
    /// sizeof(htex_device_counts).
    pub size: u32,
    /// Number of samples written to the device.
    pub frames_written: u64,
    /// Number of samples played.
    pub frames_played: u64,
    /// Number of times the device ran out of samples.
    pub underruns: u64,
    /// Time from writing a sample to its output, s.
    pub latency_s: f64,
    /// Largest absolute value written, in the device's unit.
    pub peak: f64,
}

/// [any thread; asks drivers] Writes the devices of this library as JSON. Each has `id`, `name`,
/// `endpoints` (the names of what is connected now) and `problem`, which is null or says what to
/// install. Written as by htex_asset_manifest_json.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_device_list_json(
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    // SAFETY: the pointers are the caller's.
    unsafe { calls::list_json(out, capacity, length) }
}

/// [any thread; asks drivers] Writes a device as JSON. `descriptor` has its settings and says what
/// happens to the samples (`mapping`). `capabilities` holds what it can do with these settings: the
/// quantity of its samples, rates, the largest magnitude. If it cannot be used with them,
/// `capabilities` is null and `problem` says why. `settings` is as in htex_device_open.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_device_info_json(
    name: *const c_char,
    settings: *const c_char,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    // SAFETY: the pointers are the caller's.
    unsafe { calls::info_json(name, settings, out, capacity, length) }
}

/// [any thread; asks drivers] Opens a device at rest: `sdl`, `parametric`, `channels`, `file`, or
/// its id. `settings` holds lines NAME=VALUE; NULL for the defaults. `rate_hz` is the sample rate;
/// 0 for the device's own. Samples have the quantity that htex_device_info_json states. A texture's
/// samples in newtons become fractions of full scale through the gain of its voice. A display
/// driven by a voltage cannot be opened here: it needs a separate process that removes the voltage
/// if the program dies (`htex play`).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_device_open(
    name: *const c_char,
    settings: *const c_char,
    rate_hz: f64,
    out: *mut htex_device,
) -> htex_status {
    // SAFETY: the pointers are the caller's.
    unsafe { calls::open(name, settings, rate_hz, out) }
}

/// [one thread at a time] Writes the sample rate, Hz.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_device_rate_hz(device: htex_device, out: *mut f64) -> htex_status {
    // SAFETY: the place is the caller's.
    unsafe { calls::rate_hz(device, out) }
}

/// [one thread at a time; waits] Passes samples to a device, as many as it accepts within
/// `timeout_ms`, and writes their number to `written`. The first samples start the device. If later
/// samples arrive too late, it goes to rest and the call fails. After an error it stays at rest.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_device_write(
    device: htex_device,
    samples: *const f32,
    frames: usize,
    timeout_ms: u32,
    written: *mut usize,
) -> htex_status {
    // SAFETY: the pointers are the caller's.
    unsafe { calls::write(device, samples, frames, timeout_ms, written) }
}

/// [one thread at a time] Writes what the device has done so far.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_device_status(
    device: htex_device,
    out: *mut htex_device_counts,
) -> htex_status {
    // SAFETY: the place is the caller's.
    unsafe { calls::status(device, out) }
}

/// [one thread at a time; waits] Plays everything that was written, goes to rest, and saves the
/// result: a file appears under its name. Nothing can be written afterwards.
#[unsafe(no_mangle)]
pub extern "C" fn htex_device_finish(device: htex_device) -> htex_status {
    calls::finish(device)
}

/// [one thread at a time; may wait] Frees a device. If htex_device_finish was not called, the
/// device goes to rest at once and leaves no file behind.
#[unsafe(no_mangle)]
pub extern "C" fn htex_device_free(device: htex_device) -> htex_status {
    calls::free(device)
}

#[cfg(feature = "scene")]
#[path = "device/calls.rs"]
mod calls;
#[cfg(feature = "scene")]
pub(crate) use calls::clear;

#[cfg(not(feature = "scene"))]
mod calls {
    //! Replacements in a library without devices.
    use super::*;
    use crate::status::{Failure, guarded};

    fn absent() -> htex_status {
        guarded(|| {
            Err(Failure::plain(
                htex_status::HTEX_STATUS_UNSUPPORTED,
                "this build of the library has no devices; build it with the feature `scene`",
            ))
        })
    }

    pub(super) unsafe fn list_json(_: *mut c_char, _: usize, _: *mut usize) -> htex_status {
        absent()
    }

    pub(super) unsafe fn info_json(
        _: *const c_char,
        _: *const c_char,
        _: *mut c_char,
        _: usize,
        _: *mut usize,
    ) -> htex_status {
        absent()
    }

    pub(super) unsafe fn open(
        _: *const c_char,
        _: *const c_char,
        _: f64,
        _: *mut htex_device,
    ) -> htex_status {
        absent()
    }

    pub(super) unsafe fn rate_hz(_: htex_device, _: *mut f64) -> htex_status {
        absent()
    }

    pub(super) unsafe fn write(
        _: htex_device,
        _: *const f32,
        _: usize,
        _: u32,
        _: *mut usize,
    ) -> htex_status {
        absent()
    }

    pub(super) unsafe fn status(_: htex_device, _: *mut htex_device_counts) -> htex_status {
        absent()
    }

    pub(super) fn finish(_: htex_device) -> htex_status {
        absent()
    }

    pub(super) fn free(_: htex_device) -> htex_status {
        absent()
    }
}
