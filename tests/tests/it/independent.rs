//! An independent reader and player of all specifications agrees on every conformance file, and on
//! the verdict on every changed document. It was written in Python from their text by someone who
//! had not read the sources (`tests/peers/independent`).

use std::path::PathBuf;
use std::process::Command;

use htex_tests::workspace;

#[test]
fn a_reader_written_from_the_text_agrees() {
    let python = python();
    let there = xtask::needs::PEERS.met(python.is_some());
    let Some(python) = python.filter(|_| there) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let probes = folder.path().join("probes.jsonl");
    let mut own = Command::new(std::env::current_exe().unwrap());
    let write = own.arg("have_the_ranges_of_their_schema").env("HTEX_PROBES_OUT", &probes);
    assert!(write.status().unwrap().success());
    let output = Command::new(&python)
        .args(["-m", "independent"])
        .arg(workspace().join("spec"))
        .arg("--probes")
        .arg(&probes)
        .current_dir(workspace().join("tests/peers"))
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stdout);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}{said}");
    println!("{told}");
}

/// The page that describes the format in 600 words, and the program of 60 lines that follows it.
#[test]
fn one_page_is_enough_to_play_at_conditions() {
    let page = std::fs::read_to_string(workspace().join("spec/htex-in-one-page.md")).unwrap();
    let is_word = |word: &&str| word.chars().any(char::is_alphanumeric);
    let words = page.split_whitespace().filter(is_word).count();
    assert!(words <= 600, "{words} words");
    let python = python();
    let there = xtask::needs::PEERS.met(python.is_some());
    let Some(python) = python.filter(|_| there) else {
        return;
    };
    let output = Command::new(&python)
        .arg("one_page.py")
        .arg(workspace().join("spec"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .current_dir(workspace().join("tests/peers"))
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stdout);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}{said}");
    println!("{told}");
}

/// The Python with the packages of `tests/peers/independent/requirements.txt` that the environment
/// names; otherwise the one of `.ci/run`, otherwise the system's.
fn python() -> Option<PathBuf> {
    let named = std::env::var_os("HTEX_PYTHON").map(PathBuf::from);
    let own = workspace().join("target/peers/bin/python");
    let known = named.into_iter().chain([own, "python3".into()]);
    let has = |python: &PathBuf| {
        let output = Command::new(python)
            .args(["-c", "import numpy, scipy, blake3, cryptography, jsonschema"])
            .output();
        output.is_ok_and(|output| output.status.success())
    };
    known.into_iter().find(has)
}
