//! The pages are true: the table and the picture in `docs/demonstration.md` are what `htex demo`
//! prints and draws, and the README's test command is the one that continuous integration runs.

use std::path::{Path, PathBuf};

use crate::common::Place;

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn text(file: &str) -> String {
    std::fs::read_to_string(workspace().join(file)).unwrap()
}

/// The blocks of a page in a language, without their fences.
fn blocks<'a>(page: &'a str, language: &str) -> Vec<&'a str> {
    let begin = format!("```{language}\n");
    let blocks = page.split(&begin).skip(1);
    blocks.map(|rest| rest.split("```").next().unwrap()).collect()
}

#[test]
fn the_table_and_the_picture_are_the_demonstrations() {
    let place = Place::new();
    let run = place.run(&["demo", "out"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    let page = text("docs/demonstration.md");
    let [table] = blocks(&page, "text")[..] else {
        unreachable!("docs/demonstration.md has one printed table")
    };
    let printed = run.text();
    for line in table.lines() {
        assert!(printed.lines().any(|p| p == line), "docs/demonstration.md: {line}\n{printed}");
    }
    // The header, and two models of five surfaces.
    assert_eq!(table.lines().count(), 11);
    let drawn = std::fs::read_to_string(place.path("out/spectra.svg")).unwrap();
    assert!(
        drawn == text("docs/figures/spectra.svg"),
        "docs/figures/spectra.svg: copy out/spectra.svg of `htex demo out` over it"
    );
    let rows = run.text().lines().filter(|line| line.split_whitespace().count() == 15).count();
    assert_eq!(rows, 30, "30 rows:\n{}", run.text());
    let surfaces = ["sandpaper", "fine-fabric", "coarse-fabric", "corrugated-paper", "vinyl"];
    let files = surfaces.map(|surface| format!("out/{surface}.htex"));
    let mut validate = vec!["validate", "--json"];
    validate.extend(files.iter().map(String::as_str));
    for answer in place.json(&validate).as_array().unwrap() {
        assert_eq!(answer["valid"], true);
        assert_eq!(answer["findings"].as_array().unwrap().len(), 0, "{answer}");
    }
    let report = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(report.contains("<svg") && report.contains("simulated"));
    assert!(!report.contains("src=\"http") && !report.contains("href=\"http"));
    assert!(place.path("out/vinyl-sbeta.wav").exists());
}

#[test]
fn continuous_integration_runs_the_test_command() {
    let readme = text("README.md");
    let tests = readme.split("## Tests").nth(1).unwrap();
    let command = blocks(tests, "sh")[0];
    assert!(text(".ci/run").ends_with(&format!("\n{command}")), "{command}");
}
