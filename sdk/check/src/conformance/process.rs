//! Runs a reader program once, with limits on its time and its output.

use std::io::Read;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Maximum number of bytes that a reader may print.
pub(super) const MOST_OUTPUT: usize = 16 << 20;

/// Number of bytes that are kept of what a reader writes to standard error.
const MOST_ERRORS: usize = 64 << 10;

/// Longest wait for the end of the output after the process group was killed. Only a process that
/// left the group can still hold the pipe.
const AFTER_THE_END: Duration = Duration::from_secs(1);

/// How a reader ended.
pub(super) enum Ended {
    /// With exit status 0, and this output.
    Answered(Vec<u8>),
    /// Otherwise: what is wrong, as a sentence about the reader.
    Failed(String),
    /// Somebody asked the runner to stop.
    Stopped,
}

/// Runs a reader, and kills its process group at the end, whatever the end was.
pub(super) fn run(
    mut command: Command,
    time_limit: Duration,
    stop: &(dyn Fn() -> bool + Sync),
) -> std::io::Result<Ended> {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = command.spawn()?;
    let too_much = Arc::new(AtomicBool::new(false));
    let out = drain(child.stdout.take(), MOST_OUTPUT, Some(Arc::clone(&too_much)));
    let errors = drain(child.stderr.take(), MOST_ERRORS, None);
    let end = Instant::now() + time_limit;
    let why = loop {
        if too_much.load(Ordering::Relaxed) {
            break Some(Ended::Failed(format!(
                "it printed more than {} MiB, and was stopped",
                MOST_OUTPUT >> 20
            )));
        }
        if has_ended(&mut child) {
            break None;
        }
        if stop() {
            break Some(Ended::Stopped);
        }
        if Instant::now() >= end {
            let seconds = time_limit.as_secs_f64();
            break Some(Ended::Failed(format!(
                "it did not end within {seconds} s, and was stopped"
            )));
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    // The group is killed before the call of `wait`, because until then no other process can get
    // the reader's number.
    kill(&mut child);
    let status = child.wait()?;
    Ok(match why {
        Some(why) => why,
        None => match (out.bytes(), too_much.load(Ordering::Relaxed)) {
            (_, true) => Ended::Failed(format!("it printed more than {} MiB", MOST_OUTPUT >> 20)),
            (out, _) if status.success() => Ended::Answered(out),
            _ => Ended::Failed(failed(status, &errors.bytes())),
        },
    })
}

fn failed(status: ExitStatus, errors: &[u8]) -> String {
    let errors = String::from_utf8_lossy(errors);
    let last = errors.lines().rev().find(|line| !line.trim().is_empty());
    let said = last.map(|line| format!("; its last line: {}", shortened(line)));
    format!("it ended with {status}{}", said.unwrap_or_default())
}

/// Returns the start of a text that came from a reader, on one line.
pub(super) fn shortened(text: &str) -> String {
    const MOST: usize = 200;
    // Only the beginning of a long text is used.
    let start: String = text.trim().chars().take(4 * MOST).collect();
    let line = start.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut chars = line.chars();
    let kept: String = chars.by_ref().take(MOST).collect();
    if chars.next().is_some() { kept + "…" } else { kept }
}

/// The output of a reader, collected by a thread.
struct Collected {
    bytes: Arc<Mutex<Vec<u8>>>,
    /// Closed when the pipe has ended.
    end: Receiver<()>,
}

impl Collected {
    fn bytes(self) -> Vec<u8> {
        let _ = self.end.recv_timeout(AFTER_THE_END);
        std::mem::take(&mut self.bytes.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Reads a pipe to its end in a thread, so that the reader never waits for it. Without a flag,
/// keeps the last `most` bytes. With a flag, sets the flag and stops as soon as there are more than
/// `most` bytes.
fn drain(
    pipe: Option<impl Read + Send + 'static>,
    most: usize,
    too_much: Option<Arc<AtomicBool>>,
) -> Collected {
    let (open, end) = channel::<()>();
    let bytes = Arc::new(Mutex::new(Vec::new()));
    let collected = Collected { bytes: Arc::clone(&bytes), end };
    std::thread::spawn(move || {
        let _open = open;
        let mut part = vec![0; 65_536];
        let Some(mut pipe) = pipe else { return };
        while let Ok(len @ 1..) = pipe.read(&mut part) {
            let mut bytes = bytes.lock().unwrap_or_else(PoisonError::into_inner);
            bytes.extend(&part[..len]);
            let excess = bytes.len().saturating_sub(most);
            if excess == 0 {
                continue;
            }
            match &too_much {
                Some(flag) => {
                    flag.store(true, Ordering::Relaxed);
                    return;
                }
                None => drop(bytes.drain(..excess)),
            }
        }
    });
    collected
}

/// Returns whether the reader has ended. The caller still has to call `wait`.
#[cfg(unix)]
fn has_ended(child: &mut Child) -> bool {
    use rustix::process::{WaitId, WaitIdOptions, waitid};
    let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    match pid(child).map(|pid| waitid(WaitId::Pid(pid), options)) {
        Some(Ok(status)) => status.is_some(),
        Some(Err(rustix::io::Errno::INTR)) => false,
        // The call failed; `Child::wait` then returns the reason.
        _ => true,
    }
}

#[cfg(not(unix))]
fn has_ended(child: &mut Child) -> bool {
    child.try_wait().map_or(true, |status| status.is_some())
}

#[cfg(unix)]
fn kill(child: &mut Child) {
    if let Some(pid) = pid(child) {
        // It fails if no process of the group is left.
        let _ = rustix::process::kill_process_group(pid, rustix::process::Signal::KILL);
    }
}

#[cfg(not(unix))]
fn kill(child: &mut Child) {
    // It fails if the reader has ended.
    let _ = child.kill();
}

#[cfg(unix)]
fn pid(child: &Child) -> Option<rustix::process::Pid> {
    i32::try_from(child.id()).ok().and_then(rustix::process::Pid::from_raw)
}
