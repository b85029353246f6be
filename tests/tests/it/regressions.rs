//! Runs every seed of the fuzz targets, and every input that fuzzing has found, through its target.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use htex_fuzzing::{TARGETS, container, run, seeds, with_checksums};
use htex_tests::workspace;

/// All files in a target's folder; empty if the folder does not exist.
fn files(folder: &Path) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder).into_iter().flatten();
    files.map(|file| file.unwrap().path()).collect()
}

/// Whether the target accepts the file.
fn takes(target: &str, file: &Path) -> bool {
    let input = std::fs::read(file).unwrap();
    let taken = std::panic::catch_unwind(|| run(target, &input));
    taken.unwrap_or_else(|_| panic!("{}: see above", file.display()))
}

fn names(folder: &Path) -> BTreeSet<String> {
    let name = |file: PathBuf| file.file_stem().unwrap().to_str().unwrap().to_owned();
    files(folder).into_iter().map(name).collect()
}

#[test]
fn checksums_are_mended_and_nothing_else() {
    let whole = container(b"{}", [("x", &b"abc"[..])]);
    assert_eq!(with_checksums(&whole), whole);
    let at = whole.windows(3).position(|three| three == b"abc").unwrap();
    let mut changed = whole.clone();
    changed[at] = b'X';
    let expected = container(b"{}", [("x", &b"Xbc"[..])]);
    assert_eq!(with_checksums(&changed), expected);
}

#[test]
fn regressions_stay_mended() {
    for target in TARGETS {
        for file in files(&workspace().join("tests/regressions").join(target.name)) {
            takes(target.name, &file);
        }
    }
}

#[test]
fn seeds_are_read_and_used() {
    for target in TARGETS {
        let all = files(&workspace().join("fuzz/seeds").join(target.name));
        let taken = all.iter().filter(|file| takes(target.name, file)).count();
        println!("{}: {taken} of {} seeds are taken", target.name, all.len());
        assert!(taken > 0, "no seed of {} gets beyond the reader", target.name);
    }
}

#[test]
fn every_format_of_recordings_is_fuzzed() {
    for format in htex_author::recording::FORMATS {
        let named = |target: &htex_fuzzing::Target| target.name == format.extensions[0];
        assert!(TARGETS.iter().any(named), "{}", format.name);
    }
}

/// Modules are only checked to exist, because their bytes depend on the compiler.
#[test]
fn generated_seeds_are_fresh() {
    for (target, name, bytes) in seeds::seeds() {
        let has_module = bytes.windows(4).any(|window| window == b"\0asm");
        let is_fresh = |kept: &[u8]| has_module || kept == bytes;
        xtask::generated::file_with(format!("fuzz/seeds/{target}/{name}"), &bytes, is_fresh);
    }
}

#[test]
fn targets_programs_and_folders_have_the_same_names() {
    let targets: BTreeSet<String> = TARGETS.iter().map(|t| t.name.to_owned()).collect();
    for folder in ["fuzz/fuzz_targets", "fuzz/dictionaries", "fuzz/seeds"] {
        assert_eq!(names(&workspace().join(folder)), targets, "{folder}");
    }
    for name in names(&workspace().join("tests/regressions")) {
        assert!(targets.contains(&name), "unknown target {name}");
    }
    for target in TARGETS {
        let file = workspace().join("fuzz/fuzz_targets").join(target.name);
        let program = std::fs::read_to_string(file.with_extension("rs")).unwrap();
        assert!(program.contains(&format!("htex_fuzzing::{}(input)", target.name)));
    }
    let manifest = std::fs::read_to_string(workspace().join("fuzz/Cargo.toml")).unwrap();
    for name in &targets {
        assert!(manifest.contains(&format!("name = \"{name}\"")), "{name} is no program");
    }
}
