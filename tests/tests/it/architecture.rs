//! Allowed dependencies between crates: the table of ARCHITECTURE.md.

use std::collections::BTreeSet;

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand};
use htex_tests::workspace;

/// A crate, and the workspace crates that it may depend on. `plugin` stands for the models.
const ARROWS: &[(&str, &[&str])] = &[
    ("xtask", &[]),
    ("htex-object-server", &[]),
    ("htex-base", &[]),
    ("htex-dsp", &[]),
    ("htex-player", &[]),
    ("htex-model", &["htex-base", "htex-dsp"]),
    ("plugin", &["htex-dsp", "htex-model"]),
    ("htex-host", &["htex-base", "htex-dsp", "htex-model", "plugin"]),
    ("htex-format", &["htex-base", "htex-model"]),
    ("htex-device", &["htex-base"]),
    ("htex-device-builtin", &["htex-base", "htex-dsp", "htex-device"]),
    ("htex-recording", &["htex-base", "htex-dsp", "htex-format"]),
    ("htex-play", &["htex-dsp", "htex-player", "htex-host", "htex-format"]),
    (
        "htex-author",
        &["htex-base", "htex-dsp", "htex-host", "htex-format", "htex-recording", "htex-play"],
    ),
    (
        "htex-exchange",
        &[
            "htex-base",
            "htex-dsp",
            "plugin",
            "htex-host",
            "htex-format",
            "htex-play",
            "htex-author",
        ],
    ),
    (
        "htex-build",
        &["htex-base", "htex-host", "htex-format", "htex-play", "htex-author", "htex-exchange"],
    ),
    (
        "htex-scene",
        &[
            "htex-base",
            "htex-dsp",
            "htex-host",
            "htex-format",
            "htex-device",
            "htex-recording",
            "htex-play",
        ],
    ),
    ("htex-check", &["htex-dsp", "htex-model", "htex-host", "htex-device"]),
    (
        "htex-lab",
        &["htex-base", "htex-dsp", "htex-format", "htex-device", "htex-author", "htex-scene"],
    ),
    (
        "htex",
        &[
            "htex-base",
            "htex-model",
            "htex-host",
            "htex-format",
            "htex-device",
            "htex-play",
            "htex-author",
            "htex-scene",
        ],
    ),
    ("htex-capi", &["htex-device-builtin", "htex"]),
    (
        "htex-cli",
        &[
            "htex-base",
            "htex-dsp",
            "htex-player",
            "htex-model",
            "htex-host",
            "htex-format",
            "htex-device",
            "htex-device-builtin",
            "htex-play",
            "htex-author",
            "htex-exchange",
            "htex-build",
            "htex-scene",
            "htex-check",
            "htex-lab",
            "htex",
        ],
    ),
    (
        "htex-python",
        &[
            "htex-base",
            "htex-dsp",
            "htex-model",
            "htex-host",
            "htex-format",
            "htex-device",
            "htex-device-builtin",
            "htex-author",
            "htex-exchange",
            "htex-build",
            "htex-scene",
            "htex-lab",
            "htex",
            "htex-cli",
            // Only for the features that they have in tests.
            "htex-recording",
            "htex-play",
            "htex-object-server",
        ],
    ),
    (
        "htex-web-author",
        &[
            "htex-base",
            "htex-dsp",
            "htex-format",
            "htex-device-builtin",
            "htex-play",
            "htex-author",
            "htex-exchange",
            "htex",
            "htex-capi",
        ],
    ),
    (
        "htex-hard-cases",
        &[
            "htex-dsp",
            "plugin",
            "htex-host",
            "htex-format",
            "htex-device",
            "htex-author",
            "htex-scene",
            "htex",
        ],
    ),
    ("htex-bench", &["htex-host", "htex-author", "htex"]),
    (
        "htex-fuzzing",
        &[
            "htex-base",
            "htex-player",
            "htex-model",
            "htex-host",
            "htex-format",
            "htex-device",
            "htex-device-builtin",
            "htex-play",
            "htex-author",
            "htex-exchange",
            "htex-build",
            "htex-scene",
            "htex-lab",
            "htex",
            "htex-capi",
        ],
    ),
];

/// The packages of the workspace, without third-party ones.
fn metadata() -> Metadata {
    let mut command = MetadataCommand::new();
    command.manifest_path(workspace().join("Cargo.toml")).no_deps();
    command.exec().unwrap()
}

#[test]
fn dependencies_follow_the_arrows() {
    let metadata = metadata();
    let ours: BTreeSet<&str> = metadata.packages.iter().map(|p| p.name.as_str()).collect();
    let role = |package: &cargo_metadata::Package| {
        let is_model = package.manifest_path.as_str().contains("/plugins/");
        if is_model { "plugin".to_owned() } else { package.name.to_string() }
    };
    for package in metadata.packages.iter().filter(|p| p.name.as_str() != "htex-tests") {
        let name = role(package);
        let (_, allowed) = ARROWS
            .iter()
            .find(|(from, _)| *from == name)
            .unwrap_or_else(|| panic!("{name} has no place in the arrows; see ARCHITECTURE.md"));
        let used = package.dependencies.iter().filter(|d| d.kind == DependencyKind::Normal);
        for used in used.filter(|d| ours.contains(d.name.as_str())) {
            let target = metadata.packages.iter().find(|p| *p.name == used.name).unwrap();
            let target = role(target);
            assert!(allowed.contains(&target.as_str()), "{name} must not point at {target}");
        }
    }
}

/// The packages that a build with these arguments compiles, with their versions and features.
fn compiled(arguments: &[&str]) -> BTreeSet<String> {
    let mut tree = std::process::Command::new(env!("CARGO"));
    tree.args(["tree", "--locked", "--edges", "normal,build"]);
    tree.args(["--prefix", "none", "--format", "{p} {f}"]);
    tree.args(arguments);
    let printed = tree.current_dir(workspace()).output().unwrap();
    assert!(printed.status.success(), "{printed:?}");
    let printed = String::from_utf8(printed.stdout).unwrap();
    let lines = printed.lines().filter(|line| !line.is_empty());
    lines.map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

/// The TOML parser recurses as deeply as a file nests, and `htex_base::files::toml` bounds that.
#[test]
fn only_one_crate_parses_toml() {
    let metadata = metadata();
    let parses = |package: &&cargo_metadata::Package| {
        let names = package.dependencies.iter().map(|used| used.name.as_str());
        names.into_iter().any(|name| name.starts_with("toml"))
    };
    let names = metadata.packages.iter().filter(parses);
    let names: Vec<&str> = names.map(|package| package.name.as_str()).collect();
    assert_eq!(names, ["htex-base"]);
}

/// The WASM engine, which takes minutes to compile, is compiled once for everything that is
/// installed.
#[test]
fn what_the_command_compiles_is_not_compiled_again() {
    let command = compiled(&["--package=htex-cli"]);
    // As `cargo xtask dist`, the wheel and `cargo xtask bench` build them.
    for others in [
        &["--package=htex-capi", "--package=htex-cli"][..],
        &["--package=htex-python"],
        &["--package=htex-bench", "--package=htex-cli"],
    ] {
        let again: Vec<_> = command.difference(&compiled(others)).cloned().collect();
        assert_eq!(again, [""; 0], "{others:?} have other features");
    }
    // The wheel that `cargo xtask bindings python` tests.
    let wheel = compiled(&["--package=htex-python", "--features=like-tests"]);
    let tests = compiled(&[]);
    let python = ["htex-python", "numpy", "pyo3"];
    let is_other = |line: &&String| !python.iter().any(|name| line.starts_with(name));
    let again: Vec<_> = wheel.difference(&tests).filter(is_other).collect();
    assert_eq!(again, [""; 0], "the feature `like-tests` of htex-python leaves these out");
}

/// Largest number of packages that the README's first command compiles.
const SHORT: usize = 110;

/// The README's first command compiles few packages. `-p` matters: without it, Cargo unites the
/// features of all default members.
#[test]
fn the_first_command_compiles_few_packages() {
    let readme = std::fs::read_to_string(workspace().join("README.md")).unwrap();
    assert!(readme.contains("cargo run -p htex-cli --profile quick --no-default-features"));
    let lines = compiled(&["--package=htex-cli", "--no-default-features"]);
    let names = lines.iter().filter_map(|line| line.split_once(" v"));
    let packages: BTreeSet<&str> = names.map(|(name, _)| name).collect();
    assert!(packages.len() <= SHORT, "{} packages: {packages:?}", packages.len());
    let optional = ["htex-exchange", "htex-check", "indicatif", "openxr-sys", "schemars", "toml"];
    let found = optional.map(|name| packages.contains(name));
    assert_eq!(found, [false; 6], "{optional:?}");
}

/// Without `-p`, Cargo unites the features of all default members for `cargo run`. None of them may
/// turn on what takes minutes to build.
#[test]
fn the_short_build_stays_short() {
    let metadata = metadata();
    let large = ["wasm", "cloud", "lab", "lab-files", "schemas", "check", "build"];
    let mut found = Vec::new();
    for package in metadata.workspace_default_packages() {
        let always = |used: &&cargo_metadata::Dependency| {
            used.kind != DependencyKind::Development && !used.optional
        };
        for used in package.dependencies.iter().filter(always) {
            let turned_on = used.features.iter().any(|f| large.contains(&&f[..]));
            if turned_on || used.name == "htex-cli" {
                found.push(format!(
                    "{} turns on {:?} of {}",
                    package.name, used.features, used.name
                ));
            }
        }
    }
    assert_eq!(found, [""; 0]);
}

/// An application that only opens and plays assets does not link a JSON Schema validator.
#[test]
fn only_the_command_and_tests_hold_documents_to_schemas() {
    let metadata = metadata();
    let mut holders = BTreeSet::new();
    for package in &metadata.packages {
        let linked = |used: &&cargo_metadata::Dependency| used.kind != DependencyKind::Development;
        for used in package.dependencies.iter().filter(linked) {
            let turned_on = used.name == "htex-base" && used.features.iter().any(|f| f == "check");
            let linked = used.name == "jsonschema" && !used.optional;
            if turned_on || linked {
                holders.insert(package.name.as_str());
            }
        }
        if package.features.values().flatten().any(|feature| feature == "htex-base/check") {
            holders.insert(package.name.as_str());
        }
    }
    assert_eq!(holders, BTreeSet::from(["htex-cli"]));
}

/// An application that plays scenes reads their traces, and links no other reader of recordings.
/// (The Python package names the readers only to give them the features that they have in tests.)
#[test]
fn only_authoring_reads_other_files_than_text() {
    let metadata = metadata();
    let mut holders = BTreeSet::new();
    for package in &metadata.packages {
        for used in &package.dependencies {
            let has_readers = used.uses_default_features || !used.features.is_empty();
            if used.name == "htex-recording" && has_readers {
                holders.insert(package.name.as_str());
            }
        }
    }
    assert_eq!(holders, BTreeSet::from(["htex-author", "htex-python"]));
}

/// An application that only opens and plays assets does not link a network library, and neither
/// does a short build of the command.
#[test]
fn only_the_default_command_reaches_the_network() {
    let metadata = metadata();
    let network = ["object_store", "reqwest", "rustls", "tokio", "hyper"];
    let mut always = BTreeSet::new();
    for package in &metadata.packages {
        let linked = |used: &&cargo_metadata::Dependency| used.kind != DependencyKind::Development;
        for used in package.dependencies.iter().filter(linked) {
            let turned_on = used.name == "htex-base" && used.features.iter().any(|f| f == "cloud");
            let linked = network.contains(&&used.name[..]) && !used.optional;
            if turned_on || linked {
                always.insert(package.name.as_str());
            }
        }
        let turns_on = |feature: &str| {
            package
                .features
                .get(feature)
                .is_some_and(|all| all.iter().any(|f| f == "htex-base/cloud"))
        };
        assert!(!turns_on("default"), "{}", package.name);
        let may = ["htex", "htex-cli"].contains(&package.name.as_str());
        assert_eq!(turns_on("cloud"), may);
    }
    // The pages of experiments are served locally. The player has no experiments.
    assert_eq!(always, BTreeSet::from(["htex-lab", "htex-object-server"]));
}
