//! Implementation of the device calls.

use std::ffi::c_char;
use std::time::Duration;

use htex::device::{
    AdapterEntry, DeviceError, Devices, Direction, Output, Quantity, Settings, StreamFormat,
};
use serde_json::json;

use super::{htex_device, htex_device_counts};
use crate::handles::{Kind, Table};
use crate::pointers::{needed_text, place, slice, text, write_text};
use crate::status::{Failure, guarded, htex_status};

/// An open device, and its sample rate.
struct OpenDevice {
    device: Box<dyn Output>,
    rate_hz: f64,
}

static DEVICES: Table<OpenDevice> = Table::new(Kind::Device);

impl From<DeviceError> for Failure {
    fn from(error: DeviceError) -> Self {
        let status = match error {
            DeviceError::Setting { .. }
            | DeviceError::Rate { .. }
            | DeviceError::Unknown { .. } => htex_status::HTEX_STATUS_INVALID_ARGUMENT,
            DeviceError::File { .. } => htex_status::HTEX_STATUS_IO,
            _ => htex_status::HTEX_STATUS_DEVICE,
        };
        Self::new(status, error)
    }
}

/// Frees all devices.
///
/// # Safety
/// As [`Table::clear`].
pub(crate) unsafe fn clear() -> Result<(), Failure> {
    // SAFETY: as here.
    unsafe { DEVICES.clear() }
}

fn devices() -> Devices {
    Devices::new(htex_device_builtin::devices())
}

fn write_json(
    document: &serde_json::Value,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> Result<(), Failure> {
    // SAFETY: the caller of the C function passed these pointers.
    unsafe { write_text(&document.to_string(), out, capacity, length) }
}

pub(super) unsafe fn list_json(
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let devices = devices();
        let all = devices.of_direction(Direction::Output).map(|known| {
            let descriptor = known.descriptor();
            let (endpoints, problem) = match known.adapter.endpoints() {
                Ok(endpoints) => (endpoints, None),
                Err(problem) => (Vec::new(), Some(problem.to_string())),
            };
            json!({ "id": descriptor.id, "name": descriptor.short_name(),
                "endpoints": endpoints, "problem": problem })
        });
        write_json(&all.collect(), out, capacity, length)
    })
}

/// Finds a device by its name, and parses its settings.
///
/// # Safety
/// Both texts must follow the rule in the documentation of the module `pointers`.
unsafe fn device_and_settings(
    devices: &Devices,
    name: *const c_char,
    settings: *const c_char,
) -> Result<(&AdapterEntry, Settings), Failure> {
    // SAFETY: as here.
    let (name, lines) = unsafe { (needed_text(name)?, text(settings)?) };
    let known = devices.find_output(name)?;
    let settings = Settings::from_lines(known.descriptor(), lines.unwrap_or_default())?;
    Ok((known, settings))
}

pub(super) unsafe fn info_json(
    name: *const c_char,
    settings: *const c_char,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let devices = devices();
        // SAFETY: the caller passed these texts.
        let (known, settings) = unsafe { device_and_settings(&devices, name, settings) }?;
        let (can, problem) = match known.adapter.capabilities(&settings) {
            Ok(can) => (Some(can), None),
            Err(problem) => (None, Some(problem.to_string())),
        };
        let document = json!({ "descriptor": known.descriptor(),
            "capabilities": can, "problem": problem });
        write_json(&document, out, capacity, length)
    })
}

const DRIVEN: Failure = Failure::plain(
    htex_status::HTEX_STATUS_UNSUPPORTED,
    "the device drives a display by a voltage, which a process beside the program must take away if the program dies; use `htex play`",
);

pub(super) unsafe fn open(
    name: *const c_char,
    settings: *const c_char,
    rate_hz: f64,
    out: *mut htex_device,
) -> htex_status {
    guarded(|| {
        let devices = devices();
        // SAFETY: the caller passed these pointers.
        let ((known, settings), out) =
            unsafe { (device_and_settings(&devices, name, settings)?, place(out)?) };
        let can = known.adapter.capabilities(&settings)?;
        // A file with the quantity of a display is allowed, because it drives no voltage.
        if can.quantity == Quantity::DisplayVoltage && can.paced {
            return Err(DRIVEN);
        }
        let rate_hz = if rate_hz == 0.0 { can.default_rate_hz } else { rate_hz };
        let format = StreamFormat { rate_hz, block_frames: can.block_frames };
        let device = known.adapter.open_output(&settings, &format)?;
        out.id = DEVICES.insert(OpenDevice { device, rate_hz })?;
        Ok(())
    })
}

pub(super) unsafe fn rate_hz(device: htex_device, out: *mut f64) -> htex_status {
    guarded(|| {
        let open = DEVICES.exclusive(device.id)?;
        // SAFETY: the caller passed this pointer.
        *unsafe { place(out) }? = open.rate_hz;
        Ok(())
    })
}

pub(super) unsafe fn write(
    device: htex_device,
    samples: *const f32,
    frames: usize,
    timeout_ms: u32,
    written: *mut usize,
) -> htex_status {
    guarded(|| {
        let mut open = DEVICES.exclusive(device.id)?;
        // SAFETY: the caller passed these pointers.
        let (samples, written) = unsafe { (slice(samples, frames)?, place(written)?) };
        // `written` is set first, so that it is also correct if the device fails.
        *written = 0;
        let timeout = Duration::from_millis(timeout_ms.into());
        *written = open.device.write(samples, timeout)?;
        Ok(())
    })
}

pub(super) unsafe fn status(device: htex_device, out: *mut htex_device_counts) -> htex_status {
    guarded(|| {
        let open = DEVICES.exclusive(device.id)?;
        // SAFETY: the caller passed this pointer.
        let out = unsafe { place(out) }?;
        if (out.size as usize) < size_of::<htex_device_counts>() {
            return Err(Failure::argument(
                "the counts' `size` is wrong; set it to sizeof(htex_device_counts)",
            ));
        }
        let status = open.device.status();
        *out = htex_device_counts {
            size: out.size,
            frames_written: status.frames_written,
            frames_played: status.frames_played,
            underruns: status.underruns,
            latency_s: status.latency_s,
            peak: status.peak,
        };
        Ok(())
    })
}

pub(super) fn finish(device: htex_device) -> htex_status {
    guarded(|| Ok(DEVICES.exclusive(device.id)?.device.finish()?))
}

pub(super) fn free(device: htex_device) -> htex_status {
    guarded(|| DEVICES.remove(device.id).map(drop))
}
