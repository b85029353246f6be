//! The README is true: its table and picture are the demonstration's, its test command is the one that continuous
//! integration runs, and its links lead to files.

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
    blocks
        .map(|rest| rest.split("```").next().unwrap())
        .collect()
}

#[test]
fn the_table_and_the_picture_are_the_demonstrations() {
    let place = Place::new();
    let run = place.run(&["demo", "out"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    let readme = text("README.md");
    let [table] = blocks(&readme, "text")[..] else {
        unreachable!("the README has one table")
    };
    let printed = run.text();
    for line in table.lines() {
        assert!(
            printed.lines().any(|p| p == line),
            "README.md: {line}\n{printed}"
        );
    }
    // The header, and two models of five surfaces.
    assert_eq!(table.lines().count(), 11);
    let drawn = std::fs::read_to_string(place.path("out/spectra.svg")).unwrap();
    assert!(
        drawn == text("docs/figures/spectra.svg"),
        "docs/figures/spectra.svg: copy out/spectra.svg of `htex demo out` over it"
    );
}

#[test]
fn continuous_integration_runs_the_test_command() {
    let readme = text("README.md");
    let tests = readme.split("## Tests").nth(1).unwrap();
    let command = blocks(tests, "sh")[0];
    assert!(
        text(".ci/run").ends_with(&format!("\n{command}")),
        "{command}"
    );
}

#[test]
fn links_lead_to_files() {
    for page in ["README.md", "docs/manual.md"] {
        let folder = workspace().join(page).parent().unwrap().to_owned();
        let text = text(page);
        for link in text.split("](").skip(1) {
            let link = link.split([')', '#']).next().unwrap();
            assert!(
                link.is_empty() || folder.join(link).exists(),
                "{page}: {link}"
            );
        }
    }
}
