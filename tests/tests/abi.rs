//! The model ABI stays what it is: Rust side, C header and the frozen listing say the same.
#![allow(clippy::unwrap_used, clippy::panic)] // Test code: a failure is a failed test.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use htex_model::abi::{
    ABI_MAJOR, ABI_MARKER, ABI_MINOR, ALLOC_ALIGN, GRID_HZ, MAX_BAND_HZ, MAX_FIELDS, MAX_LIST_LEN,
    MAX_PARAMETERS, MAX_RATE_HZ, MAX_TEXT_BYTES, MIN_BINS, MIN_RATE_HZ,
};
use htex_tests::surface::{
    Constants, header_constants, header_prototypes, rust_constant_names, rust_prototypes,
    rust_statuses,
};
use htex_tests::workspace;

/// FNV-1a of the listing of each minor version of this major, oldest first. Lines are only added.
const FROZEN: &[(&str, u64)] = &[("1.0", 0x0ec5_8ff7_62de_0303)];

const THAW: &str = "The surface of the model ABI is frozen: plugins that exist were built against it. \
    Take the change back; or, if it only adds an optional export or a constant, raise ABI_MINOR \
    (HTEX_ABI_MINOR, the marker), add the listing as spec/abi/model-MAJOR.MINOR.txt and its hash \
    to FROZEN. Anything else is a new ABI_MAJOR.";

/// Constants as the compiler sees them.
fn rust_constants() -> Constants {
    let numbers = [
        ("ABI_MAJOR", ABI_MAJOR.to_string()),
        ("ABI_MINOR", ABI_MINOR.to_string()),
        ("ABI_MARKER", format!("{ABI_MARKER:#x}")),
        ("MAX_PARAMETERS", MAX_PARAMETERS.to_string()),
        ("MAX_FIELDS", MAX_FIELDS.to_string()),
        ("MAX_LIST_LEN", MAX_LIST_LEN.to_string()),
        ("MAX_TEXT_BYTES", MAX_TEXT_BYTES.to_string()),
        ("MIN_BINS", MIN_BINS.to_string()),
        ("MAX_BAND_HZ", format!("{MAX_BAND_HZ:?}")),
        ("MIN_RATE_HZ", format!("{MIN_RATE_HZ:?}")),
        ("MAX_RATE_HZ", format!("{MAX_RATE_HZ:?}")),
        ("GRID_HZ", format!("{GRID_HZ:?}")),
        ("ALLOC_ALIGN", ALLOC_ALIGN.to_string()),
    ];
    let named = numbers.map(|(name, value)| (format!("HTEX_{name}"), value));
    named.into_iter().chain(rust_statuses()).collect()
}

/// One line for each constant and function, in order of name.
fn listing() -> String {
    let constants = rust_constants();
    let constants = constants
        .iter()
        .map(|(name, value)| format!("{name} {value}\n"));
    let functions = rust_prototypes();
    let functions = functions.values().map(|text| format!("{text};\n"));
    constants.chain(functions).collect()
}

#[test]
fn the_surface_is_frozen() {
    let now = listing();
    let version = format!("{ABI_MAJOR}.{ABI_MINOR}");
    let (newest, hash) = FROZEN.last().unwrap();
    assert_eq!(version, *newest, "{THAW}");
    assert_eq!(
        fnv1a(&now),
        *hash,
        "{THAW}\nHash: {:#018x}. The surface is now:\n{now}",
        fnv1a(&now)
    );
    for (version, hash) in FROZEN {
        let path = workspace().join(format!("spec/abi/model-{version}.txt"));
        let then = fs::read_to_string(path).unwrap();
        assert_eq!(
            fnv1a(&then),
            *hash,
            "spec/abi/model-{version}.txt was edited. {THAW}"
        );
        for line in then.lines().filter(|l| !l.starts_with("HTEX_ABI_M")) {
            assert!(
                now.lines().any(|l| l == line),
                "gone since {version}: {line}\n{THAW}"
            );
        }
    }
}

fn fnv1a(text: &str) -> u64 {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    text.bytes().fold(0xcbf2_9ce4_8422_2325, step)
}

#[test]
fn header_and_rust_say_the_same() {
    assert_eq!(header_prototypes(), rust_prototypes());
    assert_eq!(header_constants(), rust_constants());
    let listed: BTreeMap<String, ()> = rust_constants().into_keys().map(|n| (n, ())).collect();
    for name in rust_constant_names() {
        assert!(
            listed.contains_key(&name),
            "{name} is not in the listing of this test"
        );
    }
}

#[test]
fn the_grid_of_the_abi_is_the_grid_of_the_spectra() {
    assert_eq!(GRID_HZ, htex_dsp::GRID_HZ);
}

/// The compilers hold the header to the Rust side: constants, all whole, by assertion, functions by being
/// declared again, which is an error for another type.
#[test]
fn the_header_compiles_as_c11_and_cxx17() {
    let folder = tempfile::tempdir().unwrap();
    for (compiler, standard, file, assertion) in [
        ("cc", "-std=c11", "surface.c", "_Static_assert"),
        ("c++", "-std=c++17", "surface.cpp", "static_assert"),
    ] {
        let source = folder.path().join(file);
        fs::write(&source, translation_unit(assertion)).unwrap();
        compile(compiler, standard, &source);
    }
}

fn translation_unit(assertion: &str) -> String {
    let mut unit = "#include \"htex_model.h\"\n".to_owned();
    for (name, value) in rust_constants() {
        unit +=
            &format!("{assertion}((long){name} == (long)({value}), \"{name} is not {value}\");\n");
    }
    unit += "#ifdef __cplusplus\nextern \"C\" {\n#endif\n";
    for prototype in rust_prototypes().values() {
        unit += &format!("{prototype};\n");
    }
    unit + "#ifdef __cplusplus\n}\n#endif\nint main(void) { return 0; }\n"
}

fn compile(compiler: &str, standard: &str, source: &Path) {
    let output = Command::new(compiler)
        .args([
            standard,
            "-Wall",
            "-Wextra",
            "-Werror",
            "-pedantic",
            "-fsyntax-only",
        ])
        .arg("-I")
        .arg(workspace().join("spec/include"))
        .arg(source)
        .output()
        .unwrap_or_else(|e| panic!("{compiler} is wanted (apt install build-essential): {e}"));
    assert!(
        output.status.success(),
        "{compiler} {standard}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn the_descriptor_schema_is_fresh() {
    let path = workspace().join("spec/schemas/descriptor-1.json");
    let committed: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap();
    assert_eq!(
        committed,
        htex_model::descriptor_schema(),
        "run `cargo xtask generate`"
    );
}
