//! Models as WASM modules stay small enough to travel in assets.

use htex_host::Registry;
use htex_tests::{deflated_bytes, workspace};
use xtask::plugins;

/// The command fits the bindings' fixtures, and their models are listed without it.
#[test]
fn models_of_the_fixtures_are_those_that_are_fitted_by_default() {
    let registry = Registry::builtin();
    let mut fitted: Vec<&str> = registry.by_default().map(|model| model.short_name()).collect();
    fitted.sort_unstable();
    assert_eq!(plugins::fitted_by_default().unwrap(), fitted);
}

#[test]
fn modules_stay_small() {
    let folder = match plugins::wasm() {
        Ok(folder) => folder,
        Err(reason) if std::env::var_os("HTEX_REQUIRE_WASM").is_some_and(|v| v == "1") => {
            panic!("{reason}")
        }
        Err(reason) => return println!("skipped: {reason}"),
    };
    for model in plugins::models().unwrap() {
        let bound = bound(&model);
        let module = std::fs::read(folder.join(format!("htex_{model}.wasm"))).unwrap();
        let bytes = deflated_bytes(&module);
        println!("{model:8} {:7} bytes, deflated {bytes:6}", module.len());
        assert!(bytes <= bound, "{model}: {bytes} deflated bytes; {bound} are allowed");
        // The module must not contain code that formats numbers or JSON, or the text of a panic.
        for foreign in ["serde", "core::fmt", "panicked at", "called `Option"] {
            let foreign = foreign.as_bytes();
            let found = module.windows(foreign.len()).any(|part| part == foreign);
            assert!(!found, "{model} holds {:?}", str::from_utf8(foreign));
        }
    }
}

/// The number of deflated bytes that the crate of a model states for its module.
fn bound(model: &str) -> usize {
    let manifest = workspace().join(format!("plugins/{model}/Cargo.toml"));
    let manifest = std::fs::read_to_string(manifest).unwrap();
    let stated = manifest.lines().find_map(|line| line.strip_prefix("module_bytes = "));
    let stated = stated.unwrap_or_else(|| panic!("{model}: Cargo.toml states no module_bytes"));
    stated.replace('_', "").parse().unwrap()
}
