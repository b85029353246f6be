//! Checks that an output device accepts blocks of any size, and that its status counts frames and
//! reports the peak.

use std::time::Duration;

use crate::harness::{CheckResult, Finding};
use htex_device::Status;

use crate::device::case::{Case, write_all};

/// Checks that the output takes blocks of any size, possibly in several calls.
pub(crate) fn blocks(case: &Case) -> CheckResult {
    let (mut device, _) = case.open_output()?;
    let block = case.capabilities()?.block_frames as usize;
    let sizes = [1, 7, block, 3 * block + 1];
    let tone = case.tone(sizes[3])?;
    for size in sizes {
        let none = device.write(&[], Duration::ZERO)?;
        if none != 0 {
            return Err(Finding::failed(format!("it takes {none} of no frames")));
        }
        write_all(device.as_mut(), &tone[..size])?;
    }
    Ok(Finding::passed(format!("blocks of 0 to {} frames are taken", sizes[3])))
}

/// Checks that the status counts frames and reports the peak.
pub(crate) fn status(case: &Case) -> CheckResult {
    let (mut device, _) = case.open_output()?;
    let before = device.status();
    // The latency may be known before anything is written.
    if before != (Status { latency_s: before.latency_s, ..Status::default() }) {
        return Err(Finding::failed(format!("nothing was written, and it says {before:?}")));
    }
    let tone = case.tone(1_000)?;
    for part in tone.chunks(300) {
        write_all(device.as_mut(), part)?;
    }
    let status = device.status();
    let peak = tone.iter().fold(0.0_f32, |peak, x| peak.max(x.abs()));
    let is_peak = (status.peak - f64::from(peak)).abs() <= 1e-6 * f64::from(peak);
    if status.frames_written != 1_000 || status.frames_played > 1_000 || !is_peak {
        let message = format!("1000 frames, peak {peak}, were written, and it says {status:?}");
        return Err(Finding::failed(message));
    }
    drop(device);
    if let Ok(native) = case.native() {
        let opened = native.open_native_output(&case.settings()?, &case.format()?);
        opened.and_then(|device| device.checked_status())?;
    }
    Ok(Finding::passed("frames and peak are counted").with("latency_s", status.latency_s))
}
