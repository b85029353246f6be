//! The tests that `docs/threats.md` and `docs/driving-a-display.md` name are there.
#![allow(clippy::unwrap_used)] // Helpers of tests are tests.

use std::collections::BTreeSet;
use std::path::Path;

use htex_tests::workspace;

/// All words of the workspace's Rust sources that are functions' names.
fn functions(folder: &Path, names: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.is_dir() && name != "target" && !name.starts_with('.') {
            functions(&path, names);
        } else if name.ends_with(".rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            let after = text.split("fn ").skip(1);
            names.extend(after.filter_map(|rest| rest.split(['(', '<']).next().map(str::to_owned)));
        }
    }
}

#[test]
fn the_tests_that_the_pages_name_are_there() {
    let root = workspace();
    let mut known = BTreeSet::new();
    functions(&root, &mut known);
    known.extend(
        htex_fuzzing::TARGETS
            .iter()
            .map(|target| target.name.to_owned()),
    );
    let mut seen = 0;
    for page in ["docs/threats.md", "docs/driving-a-display.md"] {
        let text = std::fs::read_to_string(root.join(page)).unwrap();
        let rows = text
            .lines()
            .filter(|line| line.starts_with("| ") && !line.contains("shown by"));
        for row in rows {
            let shown = row.trim_end_matches(" |").rsplit(" | ").next().unwrap();
            for name in shown.split('`').skip(1).step_by(2) {
                let is_there = match name.contains('/') {
                    true => root.join(name).is_file(),
                    false => known.contains(name) || name.starts_with('-'),
                };
                assert!(is_there, "{page}: {name} is not there: {row}");
                seen += 1;
            }
        }
    }
    assert!(seen > 30, "{seen} tests are named");
}
