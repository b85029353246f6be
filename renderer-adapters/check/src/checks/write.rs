//! Writing, and what is said of it.

use std::time::Duration;

use htex_check::{Finding, Found, resident_bytes};
use htex_device::Status;

use crate::case::{Case, failed, write_all};
use crate::checks::describe::library;

/// Blocks over which memory must not grow.
const BLOCKS: usize = 10_000;
const BLOCK: usize = 256;
/// Longest time of samples for a device with a clock, seconds.
const PACED_S: f64 = 10.0;
/// Devices that are opened and closed.
const OPENED: usize = 100;
/// Growth of the resident memory that is allowed, bytes.
const GROWTH: f64 = 2.0 * 1024.0 * 1024.0;

/// Blocks of any size are taken in the end.
pub(crate) fn blocks(case: &Case) -> Found {
    let (mut device, _) = case.open()?;
    let block = case.capabilities()?.block_frames as usize;
    let sizes = [1, 7, block, 3 * block + 1];
    let tone = case.tone(sizes[3])?;
    for size in sizes {
        let none = device.write(&[], Duration::ZERO).map_err(failed)?;
        if none != 0 {
            return Err(Finding::failed(format!("it takes {none} of no frames")));
        }
        write_all(device.as_mut(), &tone[..size])?;
    }
    Ok(Finding::passed(format!(
        "blocks of 0 to {} frames are taken",
        sizes[3]
    )))
}

/// It counts what it took.
pub(crate) fn status(case: &Case) -> Found {
    let (mut device, settings) = case.open()?;
    let before = device.status();
    if before
        != (Status {
            latency_s: before.latency_s,
            ..Status::default()
        })
    {
        return Err(Finding::failed(format!(
            "nothing was written, and it says {before:?}"
        )));
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
    if let Ok(native) = library(case) {
        let can = case.adapter.capabilities(&settings).map_err(failed)?;
        let format = htex_device::StreamFormat {
            rate_hz: can.default_rate_hz,
            block_frames: can.block_frames,
        };
        let opened = native.open_native(&case.settings()?, &format);
        opened
            .and_then(|device| device.checked_status())
            .map_err(failed)?;
    }
    Ok(Finding::passed("frames and peak are counted").with("latency_s", status.latency_s))
}

/// The process does not grow with what is written, or as devices come and go.
pub(crate) fn memory(case: &Case) -> Found {
    if resident_bytes().is_none() {
        return Ok(Finding::skipped("resident memory is read on Linux only"));
    }
    let can = case.capabilities()?;
    let most = (PACED_S * can.default_rate_hz / BLOCK as f64) as usize;
    let blocks = if can.paced { BLOCKS.min(most) } else { BLOCKS };
    let tone = case.tone(BLOCK)?;
    let (mut device, _) = case.open()?;
    let mut write = |count: usize| (0..count).try_for_each(|_| write_all(device.as_mut(), &tone));
    write(blocks / 10)?;
    let before = resident_bytes().unwrap_or_default();
    write(blocks)?;
    let written = resident_bytes().unwrap_or_default() - before;
    drop(device);
    let come_and_go = |count: usize| (0..count).try_for_each(|_| case.open().map(drop));
    let opened = if can.paced { OPENED / 20 } else { OPENED };
    come_and_go(opened)?;
    let before = resident_bytes().unwrap_or_default();
    come_and_go(opened)?;
    let come = resident_bytes().unwrap_or_default() - before;
    let kib = |bytes: f64| (bytes / 1024.0).round();
    let (w, c) = (kib(written), kib(come));
    let message =
        format!("{blocks} blocks grow the process by {w} KiB, {opened} openings by {c} KiB");
    let finding = match written.max(come) > GROWTH {
        true => Finding::failed(message),
        false => Finding::passed(message),
    };
    Ok(finding
        .with("blocks_bytes", written)
        .with("openings_bytes", come))
}
