//! Checks of writing and of the status.

use std::time::Duration;

use crate::harness::{Finding, Found, Growth};
use htex_device::Status;

use crate::device::adapter::{Case, write_all};

/// Number of blocks over which memory must not grow.
const BLOCKS: usize = 10_000;
const BLOCK: usize = 256;
/// Longest total duration of samples for a device with a clock, seconds.
const PACED_S: f64 = 10.0;
/// Number of devices that are opened and closed.
const OPENED: usize = 100;

/// Blocks of any size must be taken in the end.
pub(crate) fn blocks(case: &Case) -> Found {
    let (mut device, _) = case.open()?;
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

/// Frames and peak must be counted.
pub(crate) fn status(case: &Case) -> Found {
    let (mut device, settings) = case.open()?;
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
        let can = case.adapter.capabilities(&settings)?;
        let format = htex_device::StreamFormat {
            rate_hz: can.default_rate_hz,
            block_frames: can.block_frames,
        };
        let opened = native.open_native(&case.settings()?, &format);
        opened.and_then(|device| device.checked_status())?;
    }
    Ok(Finding::passed("frames and peak are counted").with("latency_s", status.latency_s))
}

/// The process must not grow with the samples written, or as devices are opened and closed.
pub(crate) fn memory(case: &Case) -> Found {
    crate::harness::memory(|| {
        let can = case.capabilities()?;
        let most = (PACED_S * can.default_rate_hz / BLOCK as f64) as usize;
        let blocks = if can.paced { BLOCKS.min(most) } else { BLOCKS };
        let tone = case.tone(BLOCK)?;
        let (mut device, _) = case.open()?;
        let write = |count: usize| (0..count).try_for_each(|_| write_all(device.as_mut(), &tone));
        let written = Growth::measure(blocks, "blocks", write)?;
        drop(device);
        // Opening and closing a device with a clock takes longer.
        let opened = if can.paced { OPENED / 20 } else { OPENED };
        let open = |count: usize| (0..count).try_for_each(|_| case.open().map(drop));
        Ok([written, Growth::measure(opened, "openings", open)?])
    })
}
