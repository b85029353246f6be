//! Models as WASM modules stay small enough to travel in assets.

use htex_host::Registry;
use htex_tests::deflated_bytes;
use xtask::plugins;

/// Largest deflated size of each model's module, bytes: the measured size plus about 2 % for other
/// compilers. A change that raises one must state the reason in `docs/modules.md`.
const BOUNDS: &[(&str, usize)] = &[
    ("ar", 41_700),
    ("arma", 45_000),
    ("bands", 28_600),
    ("map", 40_000),
    ("mfcc", 31_500),
    ("sbeta", 31_200),
    ("speak", 19_800),
    ("sslope", 24_600),
];

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
    let bounded = BOUNDS.iter().map(|(model, _)| *model);
    assert!(bounded.eq(plugins::models().unwrap()));
    for (model, bound) in BOUNDS {
        let module = std::fs::read(folder.join(format!("htex_{model}.wasm"))).unwrap();
        let bytes = deflated_bytes(&module);
        println!("{model:8} {:7} bytes, deflated {bytes:6}", module.len());
        assert!(bytes <= *bound, "{model}: {bytes} deflated bytes; {bound} are allowed");
        // The module must not contain code that formats numbers or JSON, or the text of a panic.
        for foreign in ["serde", "core::fmt", "panicked at", "called `Option"] {
            let foreign = foreign.as_bytes();
            let found = module.windows(foreign.len()).any(|part| part == foreign);
            assert!(!found, "{model} holds {:?}", str::from_utf8(foreign));
        }
    }
}
