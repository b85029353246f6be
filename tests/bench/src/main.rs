//! Compares htex with plain loops in C and with Python libraries, in one interleaved run:
//! `cargo xtask bench`.
//!
//! Everything runs on one thread, in turns, so that other load on the machine affects all alike.
//! The table contains the minimum time of each task, and the spread of all its times. A peer that
//! is not installed is skipped with a message.

mod case;
mod ours;
mod peer;
mod table;
mod whole;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use case::Case;
use peer::Peer;
use table::{Row, Rows};

/// Number of rounds of all tasks.
const ROUNDS: usize = 9;
/// Number of rounds of whole programs.
const WHOLE_ROUNDS: usize = 5;
const SECONDS: &str = "600";

/// Rows: our task, its unit, and the peers' tasks with the target ratio for each.
const ROWS: &[Row] = table::rows();

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("bench: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let json = match &arguments[..] {
        [] => None,
        [flag, file] if flag == "--json" => Some(PathBuf::from(file)),
        _ => return Err("usage: cargo xtask bench [--json FILE]".into()),
    };
    let folder = tempfile::tempdir()?;
    let case = Case::new(folder.path())?;
    let mut peers = [start_c(&case), start_python(&case)];
    for peer in peers.iter().filter_map(|peer| peer.as_ref().err()) {
        eprintln!("{peer}");
    }
    let mut rows = Rows::new(ROWS);
    measure(&case, &mut peers, &mut rows)?;
    measure_whole(folder.path(), &mut rows)?;
    print!("{}", rows.to_text());
    if let Some(file) = json {
        std::fs::write(file, rows.to_json()?)?;
    }
    Ok(())
}

fn measure(
    case: &Case,
    peers: &mut [Result<Peer, String>; 2],
    rows: &mut Rows,
) -> Result<(), Box<dyn std::error::Error>> {
    let mut tasks = Vec::new();
    for row in ROWS {
        tasks.push(ours::task(case, row.ours)?);
    }
    for round in 0..ROUNDS {
        eprint!("\rround {} of {ROUNDS}", round + 1);
        for (i, row) in ROWS.iter().enumerate() {
            rows.ours(i).push(tasks[i]()?);
            for (k, against) in row.against.iter().enumerate() {
                if let Ok(peer) = &mut peers[against.peer as usize]
                    && peer.can(against.task)
                {
                    rows.theirs(i, k).push(peer.run(against.task)?);
                }
            }
        }
    }
    eprintln!();
    Ok(())
}

/// Measures ten minutes of texture to a file, and a recording to an asset, as a user would run
/// them.
fn measure_whole(folder: &Path, rows: &mut Rows) -> Result<(), Box<dyn std::error::Error>> {
    let Some(htex) = std::env::var_os("HTEX_BENCH_COMMAND") else {
        eprintln!("whole programs: skipped, HTEX_BENCH_COMMAND does not name the htex command");
        return Ok(());
    };
    let path = |name: &str| folder.join(name);
    let python = std::env::var_os("HTEX_BENCH_PYTHON");
    for _ in 0..WHOLE_ROUNDS {
        let mut synth = Command::new(&htex);
        synth.arg("synth").arg(path("asset.htex"));
        synth.args(["--model", "ar", "--seconds", SECONDS, "-o"]);
        let (seconds, mib) = whole::run(synth.arg(path("ours.wav")))?;
        rows.whole_ours(seconds, mib);
        let Some(python) = &python else { continue };
        let mut script = Command::new(python);
        script.env("OMP_NUM_THREADS", "1").env("OPENBLAS_NUM_THREADS", "1");
        script.arg(peers_folder().join("synth.py")).arg(path("case.json"));
        match whole::run(script.arg(path("theirs.wav")).arg(SECONDS)) {
            Ok((seconds, mib)) => rows.whole_theirs(seconds, mib),
            Err(error) => eprintln!("{error}"),
        }
    }
    Ok(())
}

fn peers_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../peers")
}

/// Compiles the plain loops with optimisation and starts them.
fn start_c(case: &Case) -> Result<Peer, String> {
    let program = case.folder.join("plain");
    let compiler = std::env::var_os("CC").unwrap_or_else(|| "cc".into());
    let compiled = Command::new(&compiler)
        .args(["-O3", "-march=native", "-o"])
        .arg(&program)
        .arg(peers_folder().join("plain.c"))
        .arg("-lm")
        .output()
        .map_err(|error| format!("C is left out: {}: {error}", compiler.display()))?;
    if !compiled.status.success() {
        let said = String::from_utf8_lossy(&compiled.stderr);
        return Err(format!("C is left out: plain.c does not compile: {said}"));
    }
    let mut command = Command::new(program);
    command.arg(case.ar().len().to_string());
    Peer::start("C", command.args(case.ar().iter().map(f64::to_string)))
}

fn start_python(case: &Case) -> Result<Peer, String> {
    let Some(python) = std::env::var_os("HTEX_BENCH_PYTHON") else {
        return Err("Python is skipped: none with NumPy and SciPy was found".to_owned());
    };
    let mut command = Command::new(python);
    Peer::start("Python", command.arg(peers_folder().join("peers.py")).arg(&case.folder))
}
