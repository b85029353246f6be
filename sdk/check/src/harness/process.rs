//! Runs one check in a separate process.

use std::collections::VecDeque;
use std::io::Read;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::harness::{Finding, Outcome};

/// Maximum number of bytes of a child's output that are kept.
const MOST_OUTPUT: usize = 1 << 20;

/// Longest wait for the end of the output after the child has ended.
const AFTER_THE_END: Duration = Duration::from_secs(1);

/// Runs a program that writes one [`Finding`] as a line of JSON. If the program crashes or exceeds
/// `timeout`, returns a finding that states this.
pub(crate) fn run_process(command: &mut Command, timeout: Duration) -> Finding {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) => return Finding::skipped(format!("the check cannot be started: {error}")),
    };
    let (out, err) = (drain(child.stdout.take()), drain(child.stderr.take()));
    match wait(&mut child, timeout) {
        None => {
            let seconds = timeout.as_secs_f64();
            let message = format!("it did not end within {seconds} s");
            let finding = Finding::new(Outcome::TimedOut, message).with("timeout_s", seconds);
            announced(finding, last_finding(&text(&out)))
        }
        Some(status) => match last_finding(&text(&out)) {
            // The check printed this finding before a step that may crash.
            Some(finding) if finding.outcome == Outcome::Crashed => {
                announced(crashed(status, &text(&err)), Some(finding))
            }
            Some(finding) => finding,
            None => crashed(status, &text(&err)),
        },
    }
}

/// Completes the finding of a check that ended without a result, with the finding that it had
/// printed before.
fn announced(mut finding: Finding, said: Option<Finding>) -> Finding {
    if let Some(said) = said {
        finding.message = format!("{}; {}", finding.message, said.message);
        finding.numbers.extend(said.numbers);
    }
    finding
}

/// The last [`MOST_OUTPUT`] bytes of a child's output.
struct ChildOutput {
    kept: Arc<Mutex<VecDeque<u8>>>,
    /// Closed when the pipe has ended.
    end: Receiver<()>,
}

/// Reads a pipe to its end in a thread, so that the child never blocks on it.
fn drain(pipe: Option<impl Read + Send + 'static>) -> ChildOutput {
    let (open, end) = channel();
    let kept = Arc::new(Mutex::new(VecDeque::new()));
    let drained = ChildOutput { kept: Arc::clone(&kept), end };
    std::thread::spawn(move || {
        let _open: Sender<()> = open;
        let mut part = vec![0; 65_536];
        if let Some(mut pipe) = pipe {
            // A pipe that cannot be read counts as ended. The finding then has only the exit
            // status.
            while let Ok(len @ 1..) = pipe.read(&mut part) {
                let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
                kept.extend(&part[..len]);
                let excess = kept.len().saturating_sub(MOST_OUTPUT);
                kept.drain(..excess);
            }
        }
    });
    drained
}

fn text(drained: &ChildOutput) -> String {
    // A process that the child has started may keep the pipe open forever.
    let _ = drained.end.recv_timeout(AFTER_THE_END);
    let mut kept = drained.kept.lock().unwrap_or_else(PoisonError::into_inner);
    String::from_utf8_lossy(kept.make_contiguous()).into_owned()
}

/// Waits until the child ends. Kills it after `timeout`.
fn wait(child: &mut Child, timeout: Duration) -> Option<ExitStatus> {
    let end = Instant::now() + timeout;
    loop {
        if let Ok(Some(status)) = child.try_wait() {
            return Some(status);
        }
        if Instant::now() >= end {
            // These calls fail if the child has already ended.
            let _ = child.kill();
            let _ = child.wait();
            return None;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Returns the last line that is a finding. The model or device may print other lines.
fn last_finding(out: &str) -> Option<Finding> {
    out.lines().rev().find_map(|line| serde_json::from_str(line).ok())
}

fn crashed(status: ExitStatus, err: &str) -> Finding {
    let last = err.lines().rev().find(|line| !line.trim().is_empty());
    let said = last.map(|line| format!("; its last line: {line}")).unwrap_or_default();
    Finding::new(Outcome::Crashed, format!("the process ended with {status}{said}"))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_process_that_the_check_leaves_behind_delays_nothing() {
        let start = Instant::now();
        let mut check = Command::new("sh");
        check.args(["-c", "sleep 20 & echo left behind >&2"]);
        let finding = run_process(&mut check, Duration::from_secs(10));
        assert_eq!(finding.outcome, Outcome::Crashed);
        assert!(finding.message.contains("left behind"), "{}", finding.message);
        assert!(start.elapsed() < Duration::from_secs(10));
    }
}
