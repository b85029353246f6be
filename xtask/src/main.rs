//! What a person would otherwise have to remember.

mod plugins;

use std::process::{Command, ExitCode};

const TASKS: &str = "\
cargo xtask ci        all that continuous integration runs
cargo xtask plugins   builds the models as plugins into target/htex-plugins
cargo xtask generate  makes what spec/ has from the code again: schemas, pages, conformance files";

fn main() -> ExitCode {
    let tasks: Vec<String> = std::env::args().skip(1).collect();
    match tasks.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["plugins"] => plugins::build(),
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
    let assets = [
        "run",
        "--package",
        "htex-format",
        "--example",
        "conformance",
    ];
    let models = ["run", "--package", "htex-model", "--features", "schemars"];
    let schema = ["--example", "descriptor_schema"];
    let code = run(&cargo, &assets);
    if code != ExitCode::SUCCESS {
        return code;
    }
    let code = run(&cargo, &[&models[..], &schema].concat());
    if code != ExitCode::SUCCESS {
        return code;
    }
    let checks = ["run", "--package", "htex-check", "--example"];
    run(&cargo, &[&checks[..], &["model_checks"]].concat())
}

/// Runs a program in the workspace's folder.
pub(crate) fn run(program: &str, arguments: &[&str]) -> ExitCode {
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
