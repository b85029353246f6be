//! Whole programs: time from their start to their end, and the most memory they had.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Between two looks at a program's memory.
const LOOK: Duration = Duration::from_millis(2);

/// Runs a program twice: for the seconds it takes, and for the most MiB it has in memory (RSS); not a number where the
/// system does not tell.
///
/// # Errors
/// A sentence, when it does not start or fails.
pub fn run(command: &mut Command) -> Result<(f64, f64), String> {
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let begun = Instant::now();
    finish(start(command)?, command)?;
    let seconds = begun.elapsed().as_secs_f64();
    let mut child = start(command)?;
    let mut most_kib = f64::NAN;
    // What the system tells of a program that has ended counts the memory of the one that started it, too.
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

/// The most that a running program has had in memory so far, KiB.
fn peak_kib(process: u32) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse().ok()
}
