//! Checks how a device finishes, aborts and closes.

use std::time::Duration;

use htex_device::{Direction, Input, Output};

use crate::device::case::{Case, check_closed, read_all, write_all};
use crate::harness::{CheckResult, Finding, Growth};

/// Maximum number of blocks that the check of memory plays or reads.
const BLOCKS: usize = 10_000;
/// Block sizes of writes and reads in the check of memory, frames.
const WRITE_BLOCK: usize = 256;
const READ_BLOCK: usize = 64;
/// Longest total duration of the samples that an output with a clock plays, or an input reads,
/// seconds.
const PACED_S: f64 = 10.0;
const READ_S: f64 = 5.0;
/// Number of devices that the check of memory opens and closes.
const OPENED: usize = 100;

/// Checks that a device does nothing more after its end.
pub(crate) fn finishes(case: &Case) -> CheckResult {
    match case.direction() {
        Direction::Output => finishes_output(case),
        Direction::Input => finishes_input(case),
    }
}

/// Checks that all frames are played, and that nothing can be written afterwards.
fn finishes_output(case: &Case) -> CheckResult {
    let (mut device, _) = case.open_output()?;
    let tone = case.tone(1_000)?;
    write_all(device.as_mut(), &tone)?;
    let files = files(case);
    device.finish()?;
    let status = device.status();
    if status.frames_played != 1_000 {
        let played = status.frames_played;
        let message = format!("1000 frames were written, and {played} came out");
        return Err(Finding::failed(message));
    }
    check_closed([
        ("a write after the end", device.write(&tone, Duration::ZERO).map(drop)),
        ("finish after the end", device.finish()),
    ])?;
    drop(device);
    // Only the numbers of files are compared, because finishing may rename them.
    if self::files(case).len() < files.len() {
        return Err(Finding::failed("what was written is gone when the device is closed"));
    }
    Ok(Finding::passed("all frames came out, and writes afterwards are refused"))
}

/// Checks that the input can be neither read nor started after its end, and that a second end
/// changes nothing.
fn finishes_input(case: &Case) -> CheckResult {
    let mut input = case.started()?;
    read_all(input.as_mut(), 3)?;
    input.finish()?;
    input.finish()?;
    let mut samples = vec![0.0; input.stream().channels.len()];
    check_closed([
        ("a start after the end", input.start()),
        ("a read after the end", input.read(&mut samples, Duration::ZERO).map(drop)),
    ])?;
    Ok(Finding::passed("nothing is delivered after the end"))
}

/// Checks that closing without `finish` leaves no file behind.
pub(crate) fn aborts(case: &Case) -> CheckResult {
    let before = files(case);
    let (mut device, _) = case.open_output()?;
    write_all(device.as_mut(), &case.tone(1_000)?)?;
    drop(device);
    let after = files(case);
    match after.iter().find(|file| !before.contains(file)) {
        Some(file) => Err(Finding::failed(format!("`{file}` is left behind"))),
        None => Ok(Finding::passed("nothing is left behind")),
    }
}

fn files(case: &Case) -> Vec<String> {
    let entries = std::fs::read_dir(case.folder.path()).into_iter().flatten();
    let names = entries.flatten().map(|entry| entry.file_name());
    names.map(|name| name.to_string_lossy().into_owned()).collect()
}

/// Checks that a closed handle is refused, even after another device was opened.
pub(crate) fn handles(case: &Case) -> CheckResult {
    let native = case.native()?;
    let (settings, format) = (case.settings()?, case.format()?);
    match case.direction() {
        Direction::Output => {
            let mut closed = native.open_native_output(&settings, &format)?;
            closed.close_and_keep_handle()?;
            for another in [false, true] {
                let _open = another.then(|| case.open_output()).transpose()?;
                check_closed([
                    ("`write` of a closed handle", closed.write(&[0.0], Duration::ZERO).map(drop)),
                    ("`status` of a closed handle", closed.checked_status().map(drop)),
                    ("`finish` of a closed handle", closed.finish()),
                    ("`close` of a closed handle", closed.close_and_keep_handle()),
                ])?;
            }
        }
        Direction::Input => {
            let mut closed = native.open_native_input(&settings)?;
            closed.close_and_keep_handle()?;
            let mut samples = vec![0.0; closed.stream().channels.len()];
            for another in [false, true] {
                let _open = another.then(|| case.open_input()).transpose()?;
                check_closed([
                    ("`start` of a closed handle", closed.start()),
                    (
                        "`read` of a closed handle",
                        closed.read(&mut samples, Duration::ZERO).map(drop),
                    ),
                    ("`stream` of a closed handle", closed.stream_again().map(drop)),
                    ("`finish` of a closed handle", closed.finish()),
                    ("`close` of a closed handle", closed.close_and_keep_handle()),
                ])?;
            }
        }
    }
    Ok(Finding::passed("a closed handle is refused"))
}

/// Checks that the memory of the process does not grow as samples are written or read, or as
/// devices are opened and closed.
pub(crate) fn memory(case: &Case) -> CheckResult {
    crate::harness::memory(|| match case.direction() {
        Direction::Output => memory_of_output(case),
        Direction::Input => memory_of_input(case),
    })
}

fn memory_of_output(case: &Case) -> Result<[Growth; 2], Finding> {
    let can = case.capabilities()?;
    let most = (PACED_S * can.default_rate_hz / WRITE_BLOCK as f64) as usize;
    let blocks = if can.paced { BLOCKS.min(most) } else { BLOCKS };
    let tone = case.tone(WRITE_BLOCK)?;
    let (mut device, _) = case.open_output()?;
    let write = |count: usize| (0..count).try_for_each(|_| write_all(device.as_mut(), &tone));
    let written = Growth::measure(blocks, "blocks", write)?;
    drop(device);
    // A device with a clock takes longer to open and close, so fewer are opened.
    let opened = if can.paced { OPENED / 20 } else { OPENED };
    let open = |count: usize| (0..count).try_for_each(|_| case.open_output().map(drop));
    Ok([written, Growth::measure(opened, "openings", open)?])
}

fn memory_of_input(case: &Case) -> Result<[Growth; 2], Finding> {
    let mut input = case.started()?;
    let most = (READ_S * input.stream().rate_hz / READ_BLOCK as f64) as usize;
    let read =
        |count: usize| (0..count).try_for_each(|_| read_all(input.as_mut(), READ_BLOCK).map(drop));
    let read = Growth::measure(BLOCKS.min(most.max(1)), "blocks", read)?;
    drop(input);
    let open = |count: usize| (0..count).try_for_each(|_| case.started().map(drop));
    Ok([read, Growth::measure(OPENED, "openings", open)?])
}
