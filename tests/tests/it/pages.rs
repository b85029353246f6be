//! Tests, files, functions, options and defaults that the pages name exist.

use std::collections::BTreeSet;
use std::path::Path;

use htex_host::{LoadedModel, Registry};
use htex_tests::workspace;

/// Calls a function with the name and text of each Rust and Python source in the workspace.
fn sources(folder: &Path, each: &mut dyn FnMut(&str, &str)) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.is_dir() && name != "target" && !name.starts_with('.') {
            sources(&path, each);
        } else if keyword_of(name).is_some() {
            each(name, &std::fs::read_to_string(&path).unwrap());
        }
    }
}

/// How a function begins in a source with this name.
fn keyword_of(name: &str) -> Option<&'static str> {
    match Path::new(name).extension()?.to_str()? {
        "rs" => Some("fn "),
        "py" => Some("def "),
        _ => None,
    }
}

fn known_functions() -> BTreeSet<String> {
    let mut known = BTreeSet::new();
    sources(&workspace(), &mut |name, text| {
        if let Some(keyword) = keyword_of(name) {
            let after = text.split(keyword).skip(1);
            let names = after.filter_map(|rest| rest.split(['(', '<']).next());
            known.extend(names.map(str::to_owned));
        }
    });
    known
}

fn page(name: &str) -> String {
    std::fs::read_to_string(workspace().join(name)).unwrap()
}

/// Names of the tests in the workspace's sources: functions after `#[test]`, and in Python those
/// that pytest collects.
fn known_tests() -> BTreeSet<String> {
    let mut tests = BTreeSet::new();
    sources(&workspace(), &mut |name, text| {
        let Some(keyword) = keyword_of(name) else {
            return;
        };
        let marked = match keyword {
            "def " => text.split("\ndef test_").skip(1).collect(),
            _ => text.split("#[test]").skip(1).collect::<Vec<_>>(),
        };
        for rest in marked {
            let (from, start) = match keyword {
                "def " => (Some(rest), "test_"),
                _ => (rest.split_once(keyword).map(|(_, rest)| rest), ""),
            };
            let name = from.and_then(|rest| rest.split(['(', '<']).next());
            tests.extend(name.map(|name| format!("{start}{name}")));
        }
    });
    tests
}

/// The texts between backticks.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Each promise links to the tests that check it, each in the file that the link names. Statements
/// of trust, and of where protection ends, need no test.
#[test]
fn the_promises_of_security_name_their_tests() {
    const WITHOUT: [&str; 4] =
        ["The program itself", "**What the user says**", "**Dask**", "A switch on the amplifier"];
    let (root, text) = (workspace(), page("SECURITY.md"));
    let (text, _) = text.split_once("\n## Reporting").unwrap();
    let mut seen = BTreeSet::new();
    for promise in text.split("\n- ").skip(1) {
        let links = promise.split("[`").skip(1);
        let links: Vec<(&str, &str)> = links
            .map(|link| {
                let (name, rest) = link.split_once("`](").unwrap();
                (name, rest.split_once(')').unwrap().0)
            })
            .collect();
        let is_without = WITHOUT.iter().any(|start| promise.starts_with(start));
        assert_eq!(links.is_empty(), is_without, "{promise}");
        for (name, file) in links {
            let code = std::fs::read_to_string(root.join(file)).unwrap_or_default();
            let is_test = code.split("#[test]").skip(1).any(|part| {
                let (head, _) = part.split_once('{').unwrap_or_default();
                head.contains(&format!("fn {name}("))
            });
            assert!(is_test, "SECURITY.md: there is no test {name} in {file}");
            seen.insert(name);
        }
    }
    assert!(seen.len() > 20, "{} tests", seen.len());
}

/// Every kind of input has a test for what the page says about it: a test, a fuzz target, or a file
/// of tests. What other pages name as a test is one.
#[test]
fn each_threat_has_its_test() {
    let (root, text, tests) = (workspace(), page("docs/threats.md"), known_tests());
    let is_test = |name: &str| {
        if name.contains('/') {
            name.contains("/tests/") && root.join(name).is_file()
        } else {
            tests.contains(name) || htex_fuzzing::TARGETS.iter().any(|t| t.name == name)
        }
    };
    let rows = text.lines().filter(|line| line.starts_with("| "));
    let mut kinds = BTreeSet::new();
    for row in rows.filter(|line| !line.contains("shown by")) {
        let cells: Vec<&str> = row.trim_matches(['|', ' ']).split(" | ").collect();
        let [kind, _, _, shown] = cells[..] else {
            panic!("not four cells: {row}");
        };
        let named: Vec<&str> = code(shown).collect();
        assert!(!named.is_empty(), "{kind}: no test is named");
        for name in named {
            assert!(is_test(name), "{kind}: {name} is no test");
        }
        assert!(kinds.insert(kind), "{kind}: two rows");
    }
    assert!(kinds.len() > 45, "{} kinds", kinds.len());
    // The last cells of other pages, which also name flags.
    let mut seen = 0;
    for name in ["docs/driving-a-display.md", "docs/paper.md"] {
        let text = page(name);
        let rows = text.lines().filter(|line| line.starts_with("| ") && !line.contains("shown by"));
        for row in rows {
            let shown = row.trim_end_matches(" |").rsplit(" | ").next().unwrap();
            for test in code(shown) {
                assert!(is_test(test) || test.starts_with('-'), "{name}: {test} is no test: {row}");
                seen += 1;
            }
        }
    }
    assert!(seen > 80, "{seen} tests are named");
}

#[test]
fn the_paths_and_functions_that_the_page_of_the_paper_names_are_there() {
    let (root, text, known) = (workspace(), page("docs/paper.md"), known_functions());
    let (mut paths, mut functions) = (0, 0);
    for name in code(&text) {
        if let Some(function) = name.strip_suffix("()") {
            assert!(known.contains(function), "there is no function {function}");
            functions += 1;
        } else if name.contains('/') || root.join(name).exists() {
            assert!(root.join(name).exists(), "there is no {name}");
            paths += 1;
        }
    }
    assert!(paths > 40 && functions > 10, "{paths} paths, {functions} functions");
}

/// The workspace paths that a page names, without patterns.
fn paths(text: &str) -> impl Iterator<Item = &str> {
    code(text).filter(|name| {
        let folder = name.split('/').next().unwrap_or_default();
        let is_path = name.contains('/') && !name.contains([' ', '*']) && !folder.is_empty();
        is_path && workspace().join(folder).is_dir()
    })
}

#[test]
fn the_map_is_short_and_what_it_names_is_there() {
    let (root, text, known) = (workspace(), page("ARCHITECTURE.md"), known_functions());
    let lines = text.lines().count();
    assert!(lines <= 150, "ARCHITECTURE.md has {lines} lines");
    let (_, invariants) = text.split_once("## Invariants").unwrap();
    let rows = invariants.lines().filter(|line| line.starts_with("| ") && line.contains('`'));
    for row in rows {
        let test = code(row.split(" | ").nth(1).unwrap()).next().unwrap();
        assert!(known.contains(test), "there is no test {test}");
    }
    let decisions = std::fs::read_dir(root.join("docs/decisions"))
        .unwrap()
        .map(|entry| std::fs::read_to_string(entry.unwrap().path()).unwrap());
    for text in decisions.chain([text]) {
        for path in paths(&text) {
            assert!(root.join(path).exists(), "there is no {path}");
        }
    }
}

/// An option's default as a user would write it.
fn default(model: &LoadedModel, option: &str) -> String {
    let options = &model.descriptor().options;
    let option = options.iter().find(|o| o.name == option);
    let option = option.unwrap_or_else(|| panic!("{} has no option of that name", model.id()));
    match option.choices.get(option.default as usize) {
        Some(choice) => choice.clone(),
        None => option.default.to_string(),
    }
}

#[test]
fn the_numbers_of_the_paper_are_the_options_defaults() {
    let (registry, text) = (Registry::builtin(), page("docs/paper.md"));
    let mut seen = BTreeSet::new();
    for name in code(&text) {
        let Some((option, value)) = name.split_once('=') else {
            continue;
        };
        let Some((model, option)) = option.split_once('.') else {
            continue;
        };
        let mut models = registry.models().iter();
        let model = models.find(|m| m.short_name() == model).unwrap();
        assert_eq!(default(model, option), value, "{name}");
        seen.insert(name);
    }
    for number in [
        "ar.order=6",
        "mfcc.coefficients=10",
        "speak.count=10",
        "speak.jnd=0.12",
        "sbeta.points=10",
    ] {
        assert!(seen.contains(number), "the page does not give {number}");
    }
}
