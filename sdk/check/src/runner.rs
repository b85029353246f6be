//! Running checks: one in this process, or each in a process of its own.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::case::Case;
use crate::checks::abi::owner;
use crate::finding::{Finding, Outcome};
use crate::report::{CheckReport, Report};
use crate::table::{CHECKS, Check, find};

/// Most bytes of a child's output that are kept.
const MOST_OUTPUT: u64 = 1 << 20;

/// A program that runs one check and writes its [`Finding`] as a line of JSON: it is called with
/// `arguments`, then `FILE NAME --seed N`, and `--against FILE` where there is one.
#[derive(Debug, Clone)]
pub struct Runner {
    /// The program.
    pub program: PathBuf,
    /// Arguments before the file.
    pub arguments: Vec<OsString>,
}

/// How a model is checked.
#[derive(Debug, Clone)]
pub struct Options {
    /// Runs one check.
    pub runner: Runner,
    /// Seed of the voices.
    pub seed: u64,
    /// How long one check may take.
    pub timeout: Duration,
    /// Checks to run, with those that they need; all when `None`.
    pub only: Option<Vec<String>>,
    /// The same model as a file of another kind.
    pub against: Option<PathBuf>,
}

/// Runs the checks, each in a process of its own.
///
/// # Errors
/// A sentence, when `only` names a check that there is not.
pub fn check(file: &Path, options: &Options) -> Result<Report, String> {
    let chosen = chosen(options.only.as_deref())?;
    let mut outcomes: BTreeMap<&str, Outcome> = BTreeMap::new();
    let mut checks = Vec::new();
    for check in CHECKS.iter().filter(|check| chosen.contains(&check.name)) {
        let finding = missing(check, &outcomes).unwrap_or_else(|| run_child(file, check, options));
        outcomes.insert(check.name, finding.outcome);
        checks.push(CheckReport {
            check: check.name,
            finding,
        });
    }
    Ok(Report::new(
        file.display().to_string(),
        options.seed,
        checks,
    ))
}

/// Runs one check in this process: what crashes, crashes.
///
/// # Errors
/// A sentence, when there is no such check.
pub fn run_one(
    file: &Path,
    name: &str,
    seed: u64,
    against: Option<&Path>,
) -> Result<Finding, String> {
    let check = find(name).ok_or_else(|| unknown(name))?;
    let case = match Case::load(file, seed, against) {
        Ok(case) => case,
        Err(error) if owner(&error) == check.name => return Ok(error.into()),
        // What is broken is another check's matter; a marker is read before what follows it.
        Err(error) if comes_before(check.name, owner(&error)) => {
            return Ok(Finding::passed("what comes first is as it should be"));
        }
        Err(error) => {
            return Ok(Finding::skipped(format!(
                "the model does not load: {error}"
            )));
        }
    };
    Ok((check.run)(&case).unwrap_or_else(|finding| finding))
}

fn unknown(name: &str) -> String {
    let names: Vec<&str> = CHECKS.iter().map(|check| check.name).collect();
    format!("there is no check `{name}`; there are {}", names.join(", "))
}

/// Whether loading comes to `name` before it comes to `broken`.
fn comes_before(name: &str, broken: &str) -> bool {
    let order = ["marker", "exports", "descriptor"];
    let place = |name: &str| order.iter().position(|stage| *stage == name);
    matches!((place(name), place(broken)), (Some(a), Some(b)) if a < b)
}

/// The names given, and all that they need.
fn chosen(only: Option<&[String]>) -> Result<Vec<&'static str>, String> {
    let Some(only) = only else {
        return Ok(CHECKS.iter().map(|check| check.name).collect());
    };
    let mut chosen = Vec::new();
    let mut open: Vec<&str> = only.iter().map(String::as_str).collect();
    while let Some(name) = open.pop() {
        let check = find(name).ok_or_else(|| unknown(name))?;
        if !chosen.contains(&check.name) {
            chosen.push(check.name);
            open.extend(check.needs);
        }
    }
    Ok(chosen)
}

/// A finding for a check that needs one that did not pass.
fn missing(check: &Check, outcomes: &BTreeMap<&str, Outcome>) -> Option<Finding> {
    let passed =
        |name: &str| matches!(outcomes.get(name), Some(Outcome::Passed | Outcome::Warning));
    let missing = check.needs.iter().find(|name| !passed(name))?;
    Some(Finding::skipped(format!(
        "it needs `{missing}`, which did not pass"
    )))
}

fn run_child(file: &Path, check: &Check, options: &Options) -> Finding {
    let mut command = Command::new(&options.runner.program);
    command
        .args(&options.runner.arguments)
        .arg(file)
        .arg(check.name)
        .args(["--seed", &options.seed.to_string()]);
    if let Some(against) = &options.against {
        command.arg("--against").arg(against);
    }
    run_process(&mut command, options.timeout)
}

/// Runs a program that writes one [`Finding`] as a line of JSON; one that dies or does not end in
/// time gets its finding, too.
pub fn run_process(command: &mut Command, timeout: Duration) -> Finding {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) => return Finding::skipped(format!("the check cannot be started: {error}")),
    };
    let (out, err) = (drain(child.stdout.take()), drain(child.stderr.take()));
    match wait(&mut child, timeout) {
        None => {
            let seconds = timeout.as_secs_f64();
            let message = format!("it did not end within {seconds} s");
            Finding::new(Outcome::TimedOut, message).with("timeout_s", seconds)
        }
        Some(status) => finding(&text(out)).unwrap_or_else(|| crashed(status, &text(err))),
    }
}

/// Reads a pipe to its end, so that the child never waits for us; keeps its start.
fn drain(pipe: Option<impl Read + Send + 'static>) -> JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let mut kept = Vec::new();
        if let Some(mut pipe) = pipe {
            // What cannot be read is not there; the child's exit status tells.
            let _ = pipe.by_ref().take(MOST_OUTPUT).read_to_end(&mut kept);
            let _ = std::io::copy(&mut pipe, &mut std::io::sink());
        }
        kept
    })
}

fn text(drained: JoinHandle<Vec<u8>>) -> String {
    String::from_utf8_lossy(&drained.join().unwrap_or_default()).into_owned()
}

/// Waits for the child's end; kills it when that does not come in time.
fn wait(child: &mut Child, timeout: Duration) -> Option<ExitStatus> {
    let end = Instant::now() + timeout;
    loop {
        if let Ok(Some(status)) = child.try_wait() {
            return Some(status);
        }
        if Instant::now() >= end {
            // It may have ended meanwhile, which is as good.
            let _ = child.kill();
            let _ = child.wait();
            return None;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The last line that is a finding: a model may print lines of its own.
fn finding(out: &str) -> Option<Finding> {
    out.lines()
        .rev()
        .find_map(|line| serde_json::from_str(line).ok())
}

fn crashed(status: ExitStatus, err: &str) -> Finding {
    let last = err.lines().rev().find(|line| !line.trim().is_empty());
    let said = last
        .map(|line| format!("; it said: {line}"))
        .unwrap_or_default();
    Finding::new(
        Outcome::Crashed,
        format!("the process ended with {status}{said}"),
    )
}
