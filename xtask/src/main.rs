//! What a person would otherwise have to remember.

use std::path::PathBuf;
use std::process::{Command, ExitCode};

use xtask::plugins;

const TASKS: &str = "\
cargo xtask ci        all that continuous integration runs
cargo xtask plugins   builds the models as plugins into target/htex-plugins, native and WASM;
                      --native-only or --wasm-only builds the one kind
cargo xtask generate  makes what spec/ has from the code again: schemas, pages, conformance files";

fn main() -> ExitCode {
    let tasks: Vec<String> = std::env::args().skip(1).collect();
    match tasks.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["plugins"] => built(&[plugins::native, plugins::wasm]),
        ["plugins", "--native-only"] => built(&[plugins::native]),
        ["plugins", "--wasm-only"] => built(&[plugins::wasm]),
        ["ci"] => run("bash", &[".ci/run"]),
        ["generate"] => generate(),
        _ => {
            eprintln!("{TASKS}");
            ExitCode::from(2)
        }
    }
}

/// Makes what the specification has from the code.
fn generate() -> ExitCode {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let made: [&[&str]; 4] = [
        &["htex-format", "--example", "conformance"],
        &[
            "htex-model",
            "--features",
            "schemars",
            "--example",
            "descriptor_schema",
        ],
        &["htex-check", "--example", "model_checks"],
        &["htex-scene", "--example", "scene_pages"],
    ];
    for what in made {
        let code = run(&cargo, &[&["run", "--package"], what].concat());
        if code != ExitCode::SUCCESS {
            return code;
        }
    }
    ExitCode::SUCCESS
}

/// Builds, and prints where what was built is.
fn built(builds: &[fn() -> Result<PathBuf, String>]) -> ExitCode {
    let mut folder = PathBuf::new();
    for build in builds {
        match build() {
            Ok(path) => folder = path,
            Err(error) => {
                eprintln!("xtask: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    println!("{}", folder.display());
    ExitCode::SUCCESS
}

/// Runs a program in the workspace's folder.
fn run(program: &str, arguments: &[&str]) -> ExitCode {
    let workspace = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    match Command::new(program)
        .args(arguments)
        .current_dir(workspace)
        .status()
    {
        Ok(status) if status.success() => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("xtask: cannot run {program}: {error}");
            ExitCode::FAILURE
        }
    }
}
