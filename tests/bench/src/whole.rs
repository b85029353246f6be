//! Whole programs: time from their start to their end, and the most memory they had.

use std::process::{Command, Stdio};
use std::time::Instant;

/// Runs a program: seconds, and MiB at most (RSS).
///
/// # Errors
/// A sentence, when it does not start or fails.
pub fn run(command: &mut Command) -> Result<(f64, f64), String> {
    let begun = Instant::now();
    #[allow(clippy::zombie_processes)] // wait4 below waits, and tells what was used.
    let child = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(|error| format!("{command:?}: {error}"))?;
    let mut status = 0;
    // SAFETY: plain data, for which zeros are a value.
    let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
    // SAFETY: our own child, which nobody else waits for, and live variables.
    let waited = unsafe { libc::wait4(child.id() as libc::pid_t, &mut status, 0, &mut usage) };
    let seconds = begun.elapsed().as_secs_f64();
    if waited < 0 || !libc::WIFEXITED(status) || libc::WEXITSTATUS(status) != 0 {
        return Err(format!("{command:?} failed"));
    }
    Ok((seconds, usage.ru_maxrss as f64 / 1024.0))
}
