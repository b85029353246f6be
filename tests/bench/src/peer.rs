//! A program that is compared with: it says which tasks it has, then does one a line.
//!
//! Protocol: at its start it prints `skip TASK: reason` for what it cannot do, and `ready TASK …`; then it
//! reads a task's name a line and answers `seconds units ok`.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// A running peer.
pub struct Peer {
    name: &'static str,
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    tasks: Vec<String>,
}

impl Peer {
    /// Starts a program; what it cannot do is said on standard error.
    ///
    /// # Errors
    /// A sentence: why it does not run.
    pub fn start(name: &'static str, command: &mut Command) -> Result<Self, String> {
        let spawned = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut child = spawned.map_err(|error| format!("{name} does not start: {error}"))?;
        let (Some(to), Some(from)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(format!("{name} has no pipes"));
        };
        let mut peer = Self {
            name,
            child,
            to,
            from: BufReader::new(from),
            tasks: Vec::new(),
        };
        loop {
            let line = peer.line()?;
            if let Some(reason) = line.strip_prefix("skip ") {
                eprintln!("{name}: skipped {reason}");
            } else if let Some(tasks) = line.strip_prefix("ready ") {
                peer.tasks = tasks.split_whitespace().map(str::to_owned).collect();
                return Ok(peer);
            }
        }
    }

    /// Whether it can do a task.
    pub fn can(&self, task: &str) -> bool {
        self.tasks.iter().any(|known| known == task)
    }

    /// Does a task once: seconds a unit.
    ///
    /// # Errors
    /// A sentence, when it ends or answers anything but numbers.
    pub fn run(&mut self, task: &str) -> Result<f64, String> {
        writeln!(self.to, "{task}")
            .and_then(|()| self.to.flush())
            .map_err(|error| format!("{} ended at {task}: {error}", self.name))?;
        let line = self.line()?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let number = |i: usize| words.get(i).and_then(|w| w.parse::<f64>().ok());
        match (number(0), number(1), words.get(2)) {
            (Some(seconds), Some(units), Some(&"ok")) if units > 0.0 => Ok(seconds / units),
            _ => Err(format!("{} answered {task} with {line:?}", self.name)),
        }
    }

    fn line(&mut self) -> Result<String, String> {
        let mut line = String::new();
        match self.from.read_line(&mut line) {
            Ok(0) => Err(format!("{} ended early", self.name)),
            Ok(_) => Ok(line.trim().to_owned()),
            Err(error) => Err(format!("{}: {error}", self.name)),
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // It ends by itself when its input does; this only hurries it.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
