//! The checker of models: valid models pass, and each faulty one fails the right check; with more
//! seeds and all checks by `cargo xtask prove models`.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use std::time::Duration;

use htex_check::model::{CHECKS, Options, Outcome, Report, Runner, Settings, check, run_one};
use htex_host::Registry;

/// A fault of `tests/bad-plugins/bad.c`, and the check that must fail.
const FAULTS: &[(&str, &str, Outcome)] = &[
    ("MARKER", "marker", Outcome::Failed),
    ("EXPORT_MISSING", "exports", Outcome::Failed),
    ("EXTENSION_MISSING", "exports", Outcome::Failed),
    ("MOTION_MISSING", "exports", Outcome::Failed),
    ("DESCRIPTOR_JSON", "descriptor", Outcome::Failed),
    ("DESCRIPTOR_DEFAULT", "descriptor", Outcome::Failed),
    ("DESCRIPTOR_SWEEP", "descriptor", Outcome::Failed),
    ("DESCRIPTOR_USUAL", "descriptor", Outcome::Failed),
    ("EXTENSIONS", "extensions", Outcome::Failed),
    ("FIT_CRASHES", "fit", Outcome::Crashed),
    ("FIT_RANGE", "fit", Outcome::Failed),
    ("FIT_HARD", "fit-hard", Outcome::Crashed),
    ("FIT_STATUS", "fit-hard", Outcome::Failed),
    ("FIT_SIGNAL", "fit-signal", Outcome::Failed),
    ("STORE", "parameters", Outcome::Failed),
    ("MAGNITUDE_NAN", "magnitude", Outcome::Failed),
    ("MAGNITUDE_NEGATIVE", "magnitude", Outcome::Failed),
    ("MAGNITUDE_OUTSIDE", "magnitude", Outcome::Failed),
    ("MAGNITUDE_GRID", "magnitude-grid", Outcome::Failed),
    ("MAGNITUDE_ANSWERS_ONE", "magnitude", Outcome::Failed),
    ("MAGNITUDE_BEYOND", "magnitude", Outcome::Failed),
    ("RENDER_LOOPS", "render", Outcome::TimedOut),
    ("RENDER_CRASHES", "render", Outcome::Crashed),
    // The host refuses NaN and infinite samples, from the first block on.
    ("NOT_FINITE", "render", Outcome::Failed),
    ("RENDER_ANSWERS_ONE", "render", Outcome::Failed),
    ("RENDER_BEYOND", "render", Outcome::Failed),
    // A block's guard values are not touched, but the page behind them.
    #[cfg(target_os = "linux")]
    ("RENDER_FAR_BEYOND", "render", Outcome::Failed),
    ("CAPACITY", "arrays", Outcome::Failed),
    ("CAPACITY_LENGTH", "arrays", Outcome::Failed),
    ("KEEPS_PARAMETERS", "arrays", Outcome::Failed),
    ("ACCEPTS_NULL", "arrays", Outcome::Failed),
    ("SUBNORMAL", "samples", Outcome::Failed),
    ("LEVEL", "level", Outcome::Failed),
    ("MAGNITUDE_LEVEL", "level", Outcome::Failed),
    ("SPECTRUM", "spectrum", Outcome::Failed),
    ("BOUND_REFUSED", "bounds", Outcome::Failed),
    ("BOUND_NAN", "bounds", Outcome::Failed),
    ("SEEDED_NAN", "seeded", Outcome::Failed),
    ("BAND_IGNORED", "narrow-band", Outcome::Failed),
    ("NOT_REPRODUCIBLE", "reproducible", Outcome::Failed),
    ("BLOCKS", "blocks", Outcome::Failed),
    ("EMPTY_BLOCKS", "blocks", Outcome::Failed),
    ("SEED_IGNORED", "seeds", Outcome::Failed),
    ("SHARED_STATE", "voices-apart", Outcome::Failed),
    ("TOGETHER", "voices-together", Outcome::Failed),
    ("TOGETHER_TWICE", "voices-together", Outcome::Failed),
    ("FREED_HANDLE", "handles", Outcome::Failed),
    ("CLICK", "retune", Outcome::Failed),
    ("RETUNE_DIPS", "retune-often", Outcome::Failed),
    ("RETUNE_IGNORED", "retune-follows", Outcome::Failed),
    ("INTERPOLATE_ENDS", "interpolate", Outcome::Failed),
    ("INTERPOLATE_LAST_BIT", "interpolate", Outcome::Failed),
    ("ACCEPTS_NAN", "bad-parameters", Outcome::Failed),
    ("PARAMETERS_STATUS", "bad-parameters", Outcome::Failed),
    ("NO_REASON", "bad-parameters", Outcome::Failed),
    ("ACCEPTS_BAND", "bad-band", Outcome::Failed),
    ("ACCEPTS_RATE", "bad-rate", Outcome::Failed),
    ("ACCEPTS_SPECTRUM", "bad-input", Outcome::Failed),
    ("ACCEPTS_WEIGHTS", "bad-weights", Outcome::Failed),
    #[cfg(target_os = "linux")]
    ("RENDER_ALLOCATES", "allocation", Outcome::Failed),
    #[cfg(target_os = "linux")]
    ("RETUNE_ALLOCATES", "allocation", Outcome::Failed),
    ("ACCEPTS_MOTION", "motion", Outcome::Failed),
    ("ACCEPTS_PLACE", "motion", Outcome::Failed),
    ("MOTION_BLOCKS", "motion", Outcome::Failed),
    #[cfg(target_os = "linux")]
    ("MOTION_ALLOCATES", "motion", Outcome::Failed),
    #[cfg(target_os = "linux")]
    ("RENDER_WAITS", "waiting", Outcome::Failed),
    #[cfg(target_os = "linux")]
    ("RENDER_WRITES", "waiting", Outcome::Failed),
    ("FUZZ_CRASHES", "fuzz", Outcome::Crashed),
    ("LEAK", "memory", Outcome::Failed),
    ("VOICES_LEAK", "memory", Outcome::Failed),
];

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A copy of a model as a native library, without its module beside it.
fn library(folder: &Path, model: &str) -> PathBuf {
    static BUILT: LazyLock<PathBuf> = LazyLock::new(|| xtask::plugins::native().unwrap());
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let name = format!("{prefix}htex_{model}{suffix}");
    std::fs::copy(BUILT.join(&name), folder.join(&name)).unwrap();
    folder.join(name)
}

/// Compiles the faulty model with a fault, or without, around a valid library.
fn bad(folder: &Path, good: &Path, fault: &str) -> PathBuf {
    let out = folder.join(format!("bad-{fault}{}", std::env::consts::DLL_SUFFIX));
    let status = Command::new("cc")
        .args(["-std=gnu11", "-O1", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC"])
        .args(["-Wno-unused-parameter", "-Wno-unused-variable"])
        .arg(format!("-DFAULT_{fault}"))
        .arg(format!("-DGOOD_LIBRARY=\"{}\"", good.display()))
        .arg("-I")
        .arg(workspace().join("spec/include"))
        .arg(workspace().join("tests/bad-plugins/bad.c"))
        .args(["-o".as_ref(), out.as_os_str()])
        .args(["-ldl", "-lm"])
        .status();
    assert!(status.unwrap().success(), "{fault} does not compile");
    out
}

fn checked(file: &Path, timeout_s: u64) -> Report {
    check_some(file, timeout_s, 3, None)
}

/// The checks of sounds with more seeds: a level or spectrum with a small error fails with some.
fn checked_by_seeds(file: &Path) {
    let sounds = ["level", "spectrum", "narrow-band"].map(String::from);
    let seeds: &[u64] = if xtask::prove::whole() { &[0, 1, 2, u64::MAX] } else { &[u64::MAX] };
    for &seed in seeds {
        let report = check_some(file, 120, seed, Some(sounds.to_vec()));
        assert!(report.ok, "seed {seed}: {}", report);
    }
}

fn check_some(file: &Path, timeout_s: u64, seed: u64, only: Option<Vec<String>>) -> Report {
    let options = Options {
        runner: Runner {
            program: env!("CARGO_BIN_EXE_htex").into(),
            arguments: vec!["plugin".into(), "check-one".into()],
            timeout: Duration::from_secs(timeout_s),
        },
        seed,
        only,
        against: None,
        fuzz: None,
    };
    check(file, &options).unwrap()
}

#[test]
fn sound_models_pass() {
    let folder = tempfile::tempdir().unwrap();
    for model in Registry::builtin_names() {
        let file = library(folder.path(), model);
        checked_by_seeds(&file);
        let report = checked(&file, 120);
        println!("{report}");
        assert!(report.ok, "{}", report);
        // Nothing is there to compare the model with: no twin beside it, and no older version.
        assert_eq!(report.count(Outcome::Skipped), 2, "{}", report);
    }
}

#[test]
fn sound_modules_pass_too() {
    let Some(folder) = xtask::plugins::wasm_if_there() else {
        return;
    };
    // Their native twins, which they are compared with, are of the same sources.
    xtask::plugins::native().unwrap();
    // The native libraries, which are of the same sources, are all checked above, with other seeds.
    // A sample of the modules: a filter, and noise shaped by a curve.
    let whole = xtask::prove::whole();
    let sampled = |model: &&str| whole || ["ar", "sslope"].contains(model);
    for model in Registry::builtin_names().into_iter().filter(sampled) {
        let file = folder.join(format!("htex_{model}.wasm"));
        if whole {
            checked_by_seeds(&file);
        }
        let report = checked(&file, 120);
        println!("{report}");
        assert!(report.ok, "{}", report);
    }
}

#[test]
fn each_fault_is_found_by_its_own_check() {
    let folder = tempfile::tempdir().unwrap();
    let good = library(folder.path(), "sbeta");
    let sound = checked(&bad(folder.path(), &good, "NONE"), 120);
    assert!(sound.ok, "without a fault: {}", sound);
    for (fault, name, outcome) in FAULTS {
        let file = bad(folder.path(), &good, fault);
        let timeout_s = if *outcome == Outcome::TimedOut { 5 } else { 120 };
        // The full proof runs all checks. It shows that only this one fails.
        let only = (!xtask::prove::whole()).then(|| vec![(*name).to_owned()]);
        let report = check_some(&file, timeout_s, 3, only);
        assert_eq!(report.bad(), [*name], "{fault}: {}", report);
        let found = report.checks.iter().find(|c| c.check == *name).unwrap();
        println!("{fault:20} {name:15} {}", found.finding.message);
        assert_eq!(found.finding.outcome, *outcome, "{fault}");
    }
    let unbroken = CHECKS
        .iter()
        .filter(|c| cfg!(target_os = "linux") || !["allocation", "waiting"].contains(&c.name))
        .filter(|c| !FAULTS.iter().any(|(_, name, _)| name == &c.name));
    let unbroken: Vec<&str> = unbroken.map(|check| check.name).collect();
    // A twin and an older version need two models; a cost is only ever a warning.
    assert_eq!(unbroken, ["cost", "twin", "successor"]);
}

/// A faulty module from C, `tests/bad-plugins/NAME.c`; `None` where there is no compiler for it.
fn bad_module(folder: &Path, name: &str) -> Option<PathBuf> {
    let runs = |program| Command::new(program).arg("--version").output().is_ok();
    if !(runs("clang") && runs("wasm-ld")) {
        return None;
    }
    let out = folder.join(name).with_extension("wasm");
    let status = Command::new("clang")
        .args(["--target=wasm32", "-std=c11", "-O2", "-Wall", "-Werror"])
        .args(["-ffp-contract=off", "-fno-math-errno", "-fvisibility=hidden"])
        .args(["-ffreestanding", "-nostdlib", "-Wl,--no-entry"])
        .arg("-I")
        .arg(workspace().join("spec/include"))
        .arg("-I")
        .arg(workspace().join("sdk/check/templates/model-c"))
        .arg(workspace().join("tests/bad-plugins").join(name).with_extension("c"))
        .args(["-o".as_ref(), out.as_os_str()])
        .status();
    assert!(status.unwrap().success(), "{name}.c does not compile");
    Some(out)
}

/// Faults that only a module shows: it takes memory while it renders, or voices of one instance
/// share a state.
#[test]
fn faults_of_a_module_are_found() {
    let folder = tempfile::tempdir().unwrap();
    for (name, check) in [("grows", "allocation"), ("counts", "reproducible")] {
        let Some(file) = bad_module(folder.path(), name) else {
            println!("skipped: clang and lld are not installed");
            return;
        };
        // The full proof runs all checks. It shows that only this one fails.
        let only = (!xtask::prove::whole()).then(|| vec![check.to_owned()]);
        let report = check_some(&file, 120, 3, only);
        println!("{report}");
        assert_eq!(report.bad(), [check], "{}", report);
    }
}

/// A file that is not there is no fault of a model, and one that does not load has no marker.
#[test]
fn a_file_that_cannot_be_loaded_has_no_marker() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("text.so");
    let settings = Settings::default();
    let missing = run_one(&file, "marker", settings).unwrap_err();
    assert!(missing.to_string().contains("text.so"), "{missing}");
    std::fs::write(&file, "no library").unwrap();
    let outcome = |name: &str| run_one(&file, name, settings).unwrap().outcome;
    assert_eq!(outcome("marker"), Outcome::Skipped);
    assert_eq!(outcome("exports"), Outcome::Failed);
}

#[test]
fn twins_must_agree() {
    let folder = tempfile::tempdir().unwrap();
    let good = library(folder.path(), "sbeta");
    let seeded = bad(folder.path(), &good, "SEED_IGNORED");
    let twin = |other: &Path| {
        let settings = Settings { seed: 3, against: Some(other), fuzz: None };
        run_one(&good, "twin", settings).unwrap()
    };
    assert_eq!(twin(&bad(folder.path(), &good, "NONE")).outcome, Outcome::Passed);
    assert_eq!(twin(&seeded).outcome, Outcome::Failed);
    assert_eq!(twin(Path::new("no-such-file.so")).outcome, Outcome::Failed);
}
