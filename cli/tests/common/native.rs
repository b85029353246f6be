//! Libraries in C: the examples, and faulty ones around them.

use std::path::{Path, PathBuf};
use std::process::Command;

use htex_check::device::{Direction, checks_of};

use super::Place;

pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// An example of `examples`, of one source file, built by its `build.sh` in a folder of its own.
pub fn example(place: &Place, folder: &str, source: &str) -> PathBuf {
    for file in [source, "build.sh"] {
        let from = workspace().join("examples").join(folder).join(file);
        let text = std::fs::read_to_string(from).unwrap();
        let include = workspace().join("spec/include").canonicalize().unwrap();
        place.write(file, text.replace("../../spec/include", include.to_str().unwrap()));
    }
    let built = Command::new("sh").arg(place.path("build.sh")).output().unwrap();
    let errors = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success() && errors.is_empty(), "{errors}");
    place.path(String::from_utf8(built.stdout).unwrap().trim())
}

/// Compiles a faulty library of `tests` with a fault, or without, around a valid one.
pub fn bad(place: &Place, source: &str, good: &Path, fault: &str) -> String {
    let out = place.path(&format!("bad-{fault}{}", std::env::consts::DLL_SUFFIX));
    let status = Command::new("cc")
        .args(["-std=gnu11", "-O1", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC"])
        .args([
            "-Wno-unused-parameter",
            "-Wno-unused-variable",
            "-Wno-unused-but-set-variable",
            "-Wno-unused-function",
        ])
        .arg(format!("-DFAULT_{fault}"))
        .arg(format!("-DGOOD_LIBRARY=\"{}\"", good.display()))
        .arg("-I")
        .arg(workspace().join("spec/include"))
        .arg(workspace().join("tests").join(source))
        .args(["-o".as_ref(), out.as_os_str()])
        .args(["-ldl", "-lm"])
        .status();
    assert!(status.unwrap().success(), "{fault} does not compile");
    out.to_str().unwrap().to_owned()
}

/// Names and outcomes of the checks of a report that are neither passed nor skipped.
pub fn complaints(report: &serde_json::Value) -> Vec<(String, String)> {
    let checks = report["checks"].as_array().unwrap().iter();
    let text = |check: &serde_json::Value, key: &str| check[key].as_str().unwrap().to_owned();
    let all = checks.map(|check| (text(check, "check"), text(check, "outcome")));
    all.filter(|(_, outcome)| outcome != "passed" && outcome != "skipped").collect()
}

/// The report of `htex device check`, whose exit status says the same.
pub fn checked(place: &Place, arguments: &[&str]) -> serde_json::Value {
    let all = [&["device", "check", "--json"], arguments].concat();
    let run = place.run(&all);
    let report: serde_json::Value = serde_json::from_str(&run.text()).unwrap_or_else(|_| {
        unreachable!("{}", run.error());
    });
    assert_eq!(run.code() == 0, report["ok"].as_bool().unwrap(), "{report:#}");
    report
}

/// A fault of a library, the check that must fail, and its outcome.
pub type Fault = (&'static str, &'static str, &'static str);

/// Each fault is found by its own check, and each check of a direction finds one. `more` gives the
/// arguments for a fault.
pub fn each_fault_is_found(
    (place, source, good): (&Place, &str, &Path),
    (faults, direction): (&[Fault], Direction),
    more: impl Fn(&Fault) -> Vec<&'static str> + Sync,
) {
    let sound = checked(place, &[&bad(place, source, good, "NONE")]);
    assert_eq!(count(&sound, "passed"), checks_of(Some(direction)).count(), "{sound:#}");
    let is_found = |fault: &Fault| {
        let library = bad(place, source, good, fault.0);
        let report = checked(place, &[&[&library[..]], &more(fault)[..]].concat());
        let expected = [(fault.1.to_owned(), fault.2.to_owned())];
        assert_eq!(complaints(&report), expected, "{}: {report:#}", fault.0);
    };
    // Most of the time is spent waiting for a source that keeps to the clock, or for a library that
    // has stopped.
    for faults in faults.chunks(8) {
        std::thread::scope(|scope| {
            for fault in faults {
                scope.spawn(|| is_found(fault));
            }
        });
    }
    for check in checks_of(Some(direction)) {
        let is_held = faults.iter().any(|(_, name, _)| *name == check.name);
        assert!(is_held, "no fault breaks `{}`", check.name);
    }
}

/// How many checks of a report had this outcome.
pub fn count(report: &serde_json::Value, outcome: &str) -> usize {
    let checks = report["checks"].as_array().unwrap().iter();
    checks.filter(|check| check["outcome"] == outcome).count()
}
