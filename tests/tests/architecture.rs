//! Allowed dependencies between crates: the table of ARCHITECTURE.md.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::collections::BTreeSet;

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand};
use htex_tests::workspace;

/// A crate, and the workspace crates that it may depend on. `plugin` stands for the models,
/// `adapter` for the device families.
const ARROWS: &[(&str, &[&str])] = &[
    ("htex-dsp", &[]),
    ("htex-model", &["htex-dsp", "htex-schema"]),
    ("htex-schema", &[]),
    ("htex-files", &[]),
    ("htex-finding", &[]),
    ("htex-native", &[]),
    ("htex-storage", &["htex-files"]),
    ("htex-object-server", &[]),
    ("htex-format", &["htex-files", "htex-finding", "htex-model", "htex-schema"]),
    ("htex-library", &["htex-files", "htex-finding", "htex-format", "htex-storage"]),
    (
        "htex-build",
        &[
            "htex-author",
            "htex-exchange",
            "htex-files",
            "htex-finding",
            "htex-format",
            "htex-host",
            "htex-library",
            "htex-native",
            "htex-play",
            "htex-schema",
            "htex-storage",
        ],
    ),
    ("htex-report", &[]),
    (
        "htex-lab",
        &[
            "htex-author",
            "htex-device",
            "htex-dsp",
            "htex-files",
            "htex-finding",
            "htex-format",
            "htex-play",
            "htex-report",
            "htex-scene",
            "htex-schema",
        ],
    ),
    ("htex-device", &["htex-native", "htex-schema"]),
    ("adapter", &["htex-device", "htex-files", "htex-native"]),
    ("htex-device-motor", &["htex-device", "htex-dsp"]),
    ("htex-device-channels", &["adapter", "htex-device", "htex-device-motor"]),
    ("htex-device-parametric", &["htex-device", "htex-device-motor", "htex-dsp", "htex-native"]),
    ("htex-device-sdl", &["htex-device", "htex-device-motor", "htex-dsp", "htex-native"]),
    (
        "htex-device-builtin",
        &[
            "adapter",
            "htex-device",
            "htex-device-channels",
            "htex-device-parametric",
            "htex-device-sdl",
        ],
    ),
    ("htex-device-guardian", &["htex-device"]),
    ("htex-check-runner", &[]),
    ("htex-device-check", &["htex-check-runner", "htex-device"]),
    ("htex-shaped", &["htex-dsp", "htex-model"]),
    ("plugin", &["htex-dsp", "htex-model", "htex-shaped"]),
    ("htex-host", &["htex-dsp", "htex-files", "htex-native", "htex-model", "plugin"]),
    (
        "htex-author",
        &["htex-dsp", "htex-finding", "htex-format", "htex-host", "htex-play", "htex-recording"],
    ),
    ("htex-recording", &["htex-dsp", "htex-finding", "htex-format"]),
    ("htex-simulate", &["htex-dsp", "htex-format", "htex-recording"]),
    ("htex-check", &["htex-check-runner", "htex-dsp", "htex-host", "htex-model"]),
    ("htex-play", &["htex-dsp", "htex-finding", "htex-format", "htex-host", "htex-library"]),
    ("htex-player", &[]),
    ("htex-bake", &["htex-dsp", "htex-host", "htex-play", "htex-player"]),
    (
        "htex",
        &[
            "htex-author",
            "htex-device",
            "htex-format",
            "htex-host",
            "htex-library",
            "htex-play",
            "htex-scene",
            "htex-simulate",
            "htex-storage",
        ],
    ),
    (
        "htex-scene",
        &[
            "htex-device",
            "htex-dsp",
            "htex-finding",
            "htex-format",
            "htex-host",
            "htex-play",
            "htex-recording",
            "htex-schema",
        ],
    ),
    (
        "htex-tradeoff",
        &[
            "htex-author",
            "htex-dsp",
            "htex-files",
            "htex-finding",
            "htex-format",
            "htex-host",
            "htex-report",
        ],
    ),
    (
        "htex-exchange",
        &[
            "plugin",
            "htex-author",
            "htex-dsp",
            "htex-files",
            "htex-finding",
            "htex-format",
            "htex-host",
            "htex-play",
            "htex-schema",
        ],
    ),
    (
        "htex-cli",
        &[
            "htex",
            "htex-author",
            "htex-bake",
            "htex-build",
            "htex-check",
            "htex-check-runner",
            "htex-device",
            "htex-device-builtin",
            "htex-device-check",
            "htex-device-guardian",
            "htex-exchange",
            "htex-lab",
            "htex-library",
            "htex-scene",
            "htex-simulate",
            "htex-tradeoff",
            "htex-dsp",
            "htex-files",
            "htex-finding",
            "htex-format",
            "htex-host",
            "htex-model",
            "htex-native",
            "htex-report",
            "htex-schema",
            "htex-storage",
        ],
    ),
    (
        "htex-hard-cases",
        &[
            "plugin",
            "htex",
            "htex-author",
            "htex-device",
            "htex-dsp",
            "htex-format",
            "htex-host",
            "htex-scene",
        ],
    ),
    ("htex-bench", &["htex", "htex-author", "htex-host", "htex-simulate"]),
    (
        "htex-fuzzing",
        &[
            "htex",
            "htex-author",
            "htex-bake",
            "htex-build",
            "htex-capi",
            "adapter",
            "htex-device",
            "htex-exchange",
            "htex-files",
            "htex-finding",
            "htex-format",
            "htex-host",
            "htex-lab",
            "htex-library",
            "htex-model",
            "htex-player",
            "htex-scene",
        ],
    ),
    ("htex-capi", &["htex", "htex-device-builtin"]),
    (
        "htex-web-author",
        &[
            "htex",
            "htex-author",
            "htex-bake",
            "htex-capi",
            "htex-device-builtin",
            "htex-dsp",
            "htex-exchange",
            "htex-finding",
            "htex-format",
            "htex-library",
        ],
    ),
    (
        "htex-python",
        &[
            "htex",
            "htex-author",
            "htex-build",
            "htex-cli",
            "htex-device",
            "htex-device-builtin",
            "htex-dsp",
            "htex-exchange",
            "htex-files",
            "htex-finding",
            "htex-format",
            "htex-host",
            "htex-lab",
            "htex-model",
            "htex-scene",
            "htex-simulate",
            "htex-tradeoff",
        ],
    ),
    ("xtask", &[]),
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
        let path = package.manifest_path.as_str();
        match package.name.as_str() {
            "htex-device"
            | "htex-device-builtin"
            | "htex-device-channels"
            | "htex-device-check"
            | "htex-device-guardian"
            | "htex-device-motor"
            | "htex-device-parametric"
            | "htex-device-sdl" => package.name.to_string(),
            _ if path.contains("/plugins/") => "plugin".to_owned(),
            _ if path.contains("/renderer-adapters/") => "adapter".to_owned(),
            name => name.to_owned(),
        }
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

/// The packages that building these compiles, with their versions and features.
fn compiled(packages: &[&str]) -> BTreeSet<String> {
    let mut tree = std::process::Command::new(env!("CARGO"));
    tree.args(["tree", "--locked", "--edges", "normal,build"]);
    tree.args(["--prefix", "none", "--format", "{p} {f}"]);
    tree.args(packages.iter().flat_map(|name| ["--package", name]));
    let printed = tree.current_dir(workspace()).output().unwrap();
    assert!(printed.status.success(), "{printed:?}");
    let printed = String::from_utf8(printed.stdout).unwrap();
    let lines = printed.lines().filter(|line| !line.is_empty());
    lines.map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

/// The TOML parser recurses as deeply as a file nests, and `htex_files::toml` bounds that.
#[test]
fn only_one_crate_parses_toml() {
    let metadata = metadata();
    let parses = |package: &&cargo_metadata::Package| {
        let names = package.dependencies.iter().map(|used| used.name.as_str());
        names.into_iter().any(|name| name.starts_with("toml"))
    };
    let names = metadata.packages.iter().filter(parses);
    let names: Vec<&str> = names.map(|package| package.name.as_str()).collect();
    assert_eq!(names, ["htex-files"]);
}

/// The WASM engine, which takes minutes to compile, is compiled once for everything that is
/// installed.
#[test]
fn what_the_command_compiles_is_not_compiled_again() {
    let command = compiled(&["htex-cli"]);
    // As `cargo xtask dist`, the wheel and `cargo xtask bench` build them.
    for others in [&["htex-capi", "htex-cli"][..], &["htex-python"], &["htex-bench", "htex-cli"]] {
        let again: Vec<_> = command.difference(&compiled(others)).cloned().collect();
        assert_eq!(again, [""; 0], "{others:?} have other features");
    }
}

/// The README's first command uses no default features, but Cargo unites the features of all
/// default members for it. None of them may turn on what takes minutes to build.
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
            let held = used.name == "htex-schema" && used.features.iter().any(|f| f == "check");
            let own = used.name == "jsonschema" && !used.optional;
            if held || own {
                holders.insert(package.name.as_str());
            }
        }
    }
    assert_eq!(holders, BTreeSet::from(["htex-cli"]));
}

/// An application that plays scenes reads their traces, and links no other reader of recordings.
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
    assert_eq!(holders, BTreeSet::from(["htex-author"]));
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
            let turned_on =
                used.name == "htex-storage" && used.features.iter().any(|f| f == "cloud");
            let linked = network.contains(&&used.name[..]) && !used.optional;
            if turned_on || linked {
                always.insert(package.name.as_str());
            }
        }
        let turns_on = |feature: &str| {
            package
                .features
                .get(feature)
                .is_some_and(|all| all.iter().any(|f| f == "htex-storage/cloud"))
        };
        assert!(!turns_on("default"), "{}", package.name);
        let may = ["htex", "htex-cli"].contains(&package.name.as_str());
        assert_eq!(turns_on("cloud"), may);
    }
    // The pages of experiments are served locally. The player has no experiments.
    assert_eq!(always, BTreeSet::from(["htex-lab", "htex-object-server"]));
}
