//! Devices play samples. A program selects a device by its name. Without the feature `scene`, each
//! call returns an error that names this feature.

use std::ffi::c_char;

use crate::status::htex_status;

/// An open device. Only one thread at a time may use a device. An `id` of 0 never stands for a
/// device.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct htex_device {
    /// Private.
    pub id: u64,
}

/// Statistics of a device since it was opened. Set `size` to sizeof(htex_device_counts) before the
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
    /// Number of times that the device ran out of samples.
    pub underruns: u64,
    /// Time from writing a sample to its output, s.
    pub latency_s: f64,
    /// Largest absolute value written, in the device's unit.
    pub peak: f64,
}

/// [any thread; asks drivers] Writes a JSON array of the kinds of devices that this library can
/// play on. Each entry has an `id`, a `name`, `endpoints` (the devices of this kind that are
/// connected now) and a `problem`. `problem` is null, or states why the endpoints cannot be listed,
/// for example what to install. `out`, `capacity` and `length` work as in htex_asset_manifest_json.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_device_list_json(
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::list_json(out, capacity, length) }
}

/// [any thread; asks drivers] Writes a description of a device as JSON. `descriptor` lists the
/// device's settings and states what happens to the samples (`mapping`). `capabilities` states what
/// the device can do with the given settings: the quantity of its samples, its sample rates and its
/// largest magnitude. If the device cannot be used with these settings, `capabilities` is null and
/// `problem` states the reason. `name` and `settings` are as in htex_device_open. `out`, `capacity`
/// and `length` work as in htex_asset_manifest_json.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_device_info_json(
    name: *const c_char,
    settings: *const c_char,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::info_json(name, settings, out, capacity, length) }
}

/// [any thread; asks drivers] Opens a device, which is then at rest. `name` is the device's id, or
/// its short name, such as `sdl`, `parametric`, `channels` or `file`. `settings` holds lines of the
/// form NAME=VALUE; NULL selects the defaults. `rate_hz` is the sample rate; 0 selects the device's
/// own. The samples must have the quantity and unit that htex_device_info_json states for the
/// device. If the device expects fractions of full scale, set the gain of the voice so that it
/// converts newtons to these fractions. This call refuses a finger display that is driven by a
/// voltage. Such a display needs a separate process that removes the voltage if the program dies;
/// use the command `htex play`, which starts this process.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_device_open(
    name: *const c_char,
    settings: *const c_char,
    rate_hz: f64,
    out: *mut htex_device,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::open(name, settings, rate_hz, out) }
}

/// [one thread at a time] Writes the device's sample rate, Hz.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_device_rate_hz(device: htex_device, out: *mut f64) -> htex_status {
    // SAFETY: the caller passed this pointer.
    unsafe { calls::rate_hz(device, out) }
}

/// [one thread at a time; waits] Passes samples to a device. The device takes as many samples as it
/// can within `timeout_ms`, and `written` receives the number of these samples. The first samples
/// start the device. If later samples arrive too late, the device goes to rest and the call fails.
/// After an error the device stays at rest.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_device_write(
    device: htex_device,
    samples: *const f32,
    frames: usize,
    timeout_ms: u32,
    written: *mut usize,
) -> htex_status {
    // SAFETY: the caller passed these pointers.
    unsafe { calls::write(device, samples, frames, timeout_ms, written) }
}

/// [one thread at a time] Writes what the device has done since it was opened, for example how many
/// samples it has played. Set `out->size` before the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn htex_device_status(
    device: htex_device,
    out: *mut htex_device_counts,
) -> htex_status {
    // SAFETY: the caller passed this pointer.
    unsafe { calls::status(device, out) }
}

/// [one thread at a time; waits] Plays all samples that were written, then brings the device to
/// rest. The device `file` now saves its file under the final name. No more samples can be written
/// after this call.
#[unsafe(no_mangle)]
pub extern "C" fn htex_device_finish(device: htex_device) -> htex_status {
    calls::finish(device)
}

/// [one thread at a time; may wait] Frees a device. If htex_device_finish was not called before,
/// the device goes to rest at once. The device `file` then discards its unfinished file.
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
    //! Versions of the device calls for builds without devices. Each one returns an error.
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
