//! Projects of `htex plugin new` and `htex device new` pass the steps of their own CI file.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The command and the language of each template.
const TEMPLATES: [[&str; 2]; 5] =
    [["plugin", "c"], ["plugin", "rust"], ["plugin", "zig"], ["device", "c"], ["device", "rust"]];

fn htex(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_htex"));
    command.args(arguments).output().unwrap()
}

fn written([kind, lang]: [&str; 2], dir: &Path) {
    let dir = dir.to_str().unwrap();
    let new = htex(&[kind, "new", "my-own", "--lang", lang, "--dir", dir]);
    assert!(new.status.success(), "{}", String::from_utf8_lossy(&new.stderr));
}

/// A folder that stays between runs, so that the crates of htex are compiled once.
fn kept(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// The text of all files in a folder and the folders in it.
fn all_text(folder: &Path) -> String {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let text = |path: PathBuf| {
        if path.is_dir() { all_text(&path) } else { std::fs::read_to_string(path).unwrap() }
    };
    entries.map(text).collect()
}

/// Writes a project and runs the steps of its CI file, except those that install something. The
/// WASM module is built only if there is a compiler for it.
fn passes_its_own_steps(template: [&str; 2], has_wasm: bool) {
    let dir = kept(&format!("new-{}", template.join("-")));
    let _ = std::fs::remove_dir_all(&dir);
    written(template, &dir);
    let target = kept("third-party-target");
    let ci = std::fs::read_to_string(dir.join(".github/workflows/ci.yml")).unwrap();
    let steps: Vec<&str> =
        ci.lines().filter_map(|line| line.split_once("- run: ")).map(|s| s.1).collect();
    let checks = steps.iter().filter(|step| step.contains(" check ")).count();
    assert_eq!(checks, if template[0] == "plugin" { 2 } else { 1 }, "{ci}");
    let program = Path::new(env!("CARGO_BIN_EXE_htex")).parent().unwrap().to_owned();
    let path = std::env::var_os("PATH").unwrap();
    let path = std::env::join_paths(std::iter::once(program).chain(std::env::split_paths(&path)));
    for step in steps {
        let installs = [" install ", "rustup "].iter().any(|word| step.contains(word));
        if installs || ((step.contains("wasm") || step.contains("module")) && !has_wasm) {
            continue;
        }
        let step = step
            .replace(" target/", &format!(" {}/", target.display()))
            .replace(".so", std::env::consts::DLL_SUFFIX)
            .replace("--fuzz 60", "--fuzz 1");
        let mut command = Command::new("sh");
        command.args(["-c", &step]).current_dir(&dir).env("PATH", path.as_ref().unwrap());
        command
            .env("CARGO_TARGET_DIR", &target)
            .env("ZIG", xtask::needs::zig().unwrap_or_default());
        let run = command.output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        println!("{step}\n{}", text(&run.stdout));
        assert!(run.status.success(), "{step}: {}", text(&run.stderr));
    }
}

/// A project has a README, a licence and its own names, and no path of the machine that htex was
/// built on, except in the section that one deletes.
#[test]
fn a_new_project_has_names_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    for template in TEMPLATES {
        let dir = folder.path().join(template.join("-"));
        written(template, &dir);
        let all = all_text(&dir);
        for names in ["{{", "Resonance", "\"/", "resonance.so", "htex authors"] {
            assert!(!all.contains(names), "{template:?}: {names}");
        }
        for own in ["org.example.my-own", "# My own\n", "SPDX-License-Identifier"] {
            assert!(all.contains(own), "{template:?}: {own}");
        }
        let is_rust = template[1] == "rust";
        assert_eq!(all.contains("[patch.crates-io]\nhtex-"), is_rust, "{template:?}");
        assert_eq!(all.contains("path = \""), is_rust, "{template:?}");
    }
}

#[test]
fn a_new_model_in_c() {
    let runs = |program| Command::new(program).arg("--version").output().is_ok();
    let has_wasm = xtask::needs::WASM_CLANG.met(runs("clang") && runs("wasm-ld"));
    passes_its_own_steps(["plugin", "c"], has_wasm);
}

#[test]
fn a_new_model_in_rust() {
    let has_wasm = xtask::needs::WASM_TARGET.met(xtask::plugins::wasm_is_installed());
    passes_its_own_steps(["plugin", "rust"], has_wasm);
}

#[test]
fn a_new_model_in_zig() {
    if xtask::needs::ZIG.met(xtask::needs::zig().is_some()) {
        passes_its_own_steps(["plugin", "zig"], true);
    }
}

#[test]
fn a_new_device_in_c() {
    passes_its_own_steps(["device", "c"], false);
}

#[test]
fn a_new_device_in_rust() {
    passes_its_own_steps(["device", "rust"], false);
}

/// An existing folder, an invalid name and a folder without the sources are refused, and nothing is
/// written.
#[test]
fn a_refused_new_project_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().to_str().unwrap();
    let new = format!("{place}/new");
    for [kind, _] in TEMPLATES {
        for (name, dir, sdk, reason) in [
            ("my-own", place, None, "exists; name another with --dir"),
            ("My Own", &new, None, "is not a valid name"),
            ("1st", &new, None, "is not a valid name"),
            ("my-own", &new, Some(place), "--sdk names the folder `sdk`"),
        ] {
            let mut arguments = vec![kind, "new", name, "--lang", "rust", "--dir", dir];
            arguments.extend(sdk.into_iter().flat_map(|sdk| ["--sdk", sdk]));
            let refused = htex(&arguments);
            let said = String::from_utf8_lossy(&refused.stderr).into_owned();
            assert_eq!(refused.status.code(), Some(2), "{said}");
            assert!(said.contains(reason), "{said}");
        }
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
