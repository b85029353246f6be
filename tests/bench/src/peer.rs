//! A peer: a program that lists its tasks, and then runs one task for each line of input.
//!
//! Protocol: at its start it prints `skip TASK: reason` for tasks that it does not support, and
//! `ready TASK …`. Then it reads a task's name from each line and replies `seconds units ok`.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// A running peer.
pub(crate) struct Peer {
    name: &'static str,
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    tasks: Vec<String>,
}

impl Peer {
    /// Starts a program. Tasks that it does not support are reported on standard error.
    ///
    /// # Errors
    /// Why it does not run.
    pub(crate) fn start(name: &'static str, command: &mut Command) -> Result<Self, String> {
        let spawned = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut child = spawned.map_err(|error| format!("{name} does not start: {error}"))?;
        let (Some(to), Some(from)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(format!("{name} has no pipes"));
        };
        let mut peer = Self { name, child, to, from: BufReader::new(from), tasks: Vec::new() };
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

    /// Whether it supports a task.
    pub(crate) fn can(&self, task: &str) -> bool {
        self.tasks.iter().any(|known| known == task)
    }

    /// Runs a task once and returns seconds per unit.
    ///
    /// # Errors
    /// When it ends, or replies anything except numbers.
    pub(crate) fn run(&mut self, task: &str) -> Result<f64, String> {
        writeln!(self.to, "{task}")
            .and_then(|()| self.to.flush())
            .map_err(|error| format!("{} ended at {task}: {error}", self.name))?;
        let line = self.line()?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let number = |i: usize| words.get(i).and_then(|w| w.parse::<f64>().ok());
        match (number(0), number(1), words.get(2)) {
            (Some(seconds), Some(units), Some(&"ok")) if units > 0.0 => Ok(seconds / units),
            _ => Err(format!("{} replied to {task} with {line:?}", self.name)),
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
        // It would end when its input does; this ends it sooner.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
