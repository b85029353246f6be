//! Whole programs: time from start to end, and peak memory.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Interval between two readings of a program's memory.
const LOOK: Duration = Duration::from_millis(2);

/// Runs a program twice: once for its time in seconds, once for its peak memory in MiB (RSS). The
/// memory is NaN if the system does not report it.
///
/// # Errors
/// When it does not start or fails.
pub(crate) fn run(command: &mut Command) -> Result<(f64, f64), String> {
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let begun = Instant::now();
    finish(start(command)?, command)?;
    let seconds = begun.elapsed().as_secs_f64();
    let mut child = start(command)?;
    let mut most_kib = f64::NAN;
    // For a program that has ended, the system's figure includes the memory of the program that
    // started it, so it is read while the program runs.
    while matches!(child.try_wait(), Ok(None)) {
        most_kib = peak_kib(child.id()).unwrap_or(most_kib);
        std::thread::sleep(LOOK);
    }
    finish(child, command)?;
    Ok((seconds, most_kib / 1024.0))
}

fn start(command: &mut Command) -> Result<Child, String> {
    let child = command.spawn();
    child.map_err(|error| format!("{command:?}: {error}"))
}

fn finish(mut child: Child, command: &Command) -> Result<(), String> {
    match child.wait() {
        Ok(status) if status.success() => Ok(()),
        _ => Err(format!("{command:?} failed")),
    }
}

/// Peak memory of a running program so far, KiB.
fn peak_kib(process: u32) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse().ok()
}
