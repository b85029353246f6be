//! Takes each guard out of a copy of the last commit, and asks whether a case fails:
//! `cargo run -p htex-hard-cases --example guards`, with a part of a file's name to try just those.
//! Exit status 1 if a guard is missed by nobody.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed run.

use std::path::Path;
use std::process::{Command, ExitCode};

use htex_hard_cases::guards::{GUARDS, Guard};

fn main() -> ExitCode {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let target = workspace.join("target/guards");
    let copy = target.join("copy");
    fresh_copy(&workspace, &copy);
    let mut missed = 0;
    for guard in GUARDS.iter().filter(|g| g.file.contains(&wanted)) {
        let noticed = is_missed_by_a_case(guard, &copy, &target);
        missed += u32::from(!noticed);
        let answer = if noticed { "noticed" } else { "NOT NOTICED" };
        println!("{answer}: {}: {}", guard.file, guard.with);
    }
    ExitCode::from(u8::from(missed > 0))
}

/// The last commit in a folder of its own.
fn fresh_copy(workspace: &Path, copy: &Path) {
    if copy.exists() {
        std::fs::remove_dir_all(copy).unwrap();
    }
    let cloned = Command::new("git")
        .args(["clone", "--quiet", "--local"])
        .args([workspace, copy])
        .status();
    assert!(cloned.unwrap().success(), "git clone");
}

/// Whether the tests that should hold a guard fail without it. They must build.
fn is_missed_by_a_case(guard: &Guard, copy: &Path, target: &Path) -> bool {
    let file = copy.join(guard.file);
    let code = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, code.replacen(guard.with, guard.without, 1)).unwrap();
    let features: &[&str] = if guard.pipeline {
        &[]
    } else {
        &["--no-default-features"]
    };
    let cargo = |more: &[&str]| {
        let mut command = Command::new("cargo");
        command
            .args([
                "test",
                "--quiet",
                "--package",
                "htex-hard-cases",
                "--test",
                "table",
            ])
            .args(features)
            .args(more)
            .current_dir(copy)
            .env("CARGO_TARGET_DIR", target.join("target"));
        command.output().unwrap().status.success()
    };
    assert!(cargo(&["--no-run"]), "{} does not build", guard.without);
    let held_by: Vec<&str> = guard.held_by.split(' ').collect();
    let noticed = !cargo(&[&["--"][..], &held_by].concat());
    std::fs::write(&file, code).unwrap();
    noticed
}
