//! Running a command and measuring what it uses.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Time after which a command is regarded as hanging, however busy the machine is.
const HANGS: Duration = Duration::from_secs(60);

/// The result of a command.
pub struct End {
    pub code: i32,
    pub error: String,
    /// Processor time.
    pub cpu: Duration,
    /// Peak memory (RSS), KiB.
    pub memory_kib: i64,
}

/// Runs a command to its end, and kills it when it hangs.
pub fn run(command: &mut Command, errors: &Path) -> End {
    let file = std::fs::File::create(errors).unwrap();
    #[allow(clippy::zombie_processes)] // wait4 below waits, and returns the resources used.
    let child = command.stdout(Stdio::null()).stderr(file).spawn().unwrap();
    let begun = Instant::now();
    let pid = child.id() as libc::pid_t;
    let (mut status, mut killed) = (0, false);
    // SAFETY: plain data, for which zeros are a value.
    let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
    // SAFETY: our own child, which nobody else waits for, and live variables.
    while unsafe { libc::wait4(pid, &mut status, libc::WNOHANG, &mut usage) } == 0 {
        if begun.elapsed() > HANGS && !killed {
            // SAFETY: our own child, not waited for yet.
            unsafe { libc::kill(pid, libc::SIGKILL) };
            killed = true;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let time = |t: libc::timeval| {
        Duration::from_secs(t.tv_sec as u64) + Duration::from_micros(t.tv_usec as u64)
    };
    End {
        code: if libc::WIFEXITED(status) { libc::WEXITSTATUS(status) } else { -1 },
        error: std::fs::read_to_string(errors).unwrap(),
        cpu: time(usage.ru_utime) + time(usage.ru_stime),
        memory_kib: usage.ru_maxrss,
    }
}
