//! Projects of `htex plugin new` build with one command and pass the checker.

use std::path::Path;
use std::process::{Command, Output};

fn htex(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_htex"));
    command.args(arguments).output().unwrap()
}

fn written(lang: &str, dir: &Path) -> String {
    let dir = dir.to_str().unwrap().to_owned();
    let new = htex(&["plugin", "new", "my-model", "--lang", lang, "--dir", &dir]);
    assert!(new.status.success(), "{}", String::from_utf8_lossy(&new.stderr));
    dir
}

fn passes(file: &str) {
    let checked = htex(&["plugin", "check", file]);
    let text = String::from_utf8_lossy(&checked.stdout);
    println!("{text}");
    assert!(checked.status.success(), "{text}");
}

/// A project has a README and its own names, and no path of the machine that htex was built on.
#[test]
fn a_new_model_has_names_of_its_own() {
    for lang in ["c", "rust"] {
        let folder = tempfile::tempdir().unwrap();
        let dir = written(lang, &folder.path().join(lang));
        let readme = std::fs::read_to_string(format!("{dir}/README.md")).unwrap();
        assert!(readme.starts_with("# My model\n"), "{readme}");
        let mut all = String::new();
        for file in ["README.md", "Cargo.toml", "src/lib.rs", "model.c", "build.sh"] {
            all += &std::fs::read_to_string(format!("{dir}/{file}")).unwrap_or_default();
        }
        for names in ["{{", "Resonance", "\"/", "resonance.so"] {
            assert!(!all.contains(names), "{lang}: {names}");
        }
        for own in ["org.example.my-model", "My model"] {
            assert!(all.contains(own), "{lang}: {own}");
        }
    }
}

#[test]
fn a_new_model_in_c() {
    let folder = tempfile::tempdir().unwrap();
    let dir = written("c", &folder.path().join("c"));
    let built = Command::new("sh").arg(format!("{dir}/build.sh")).status();
    assert!(built.unwrap().success());
    passes(&format!("{dir}/my-model{}", std::env::consts::DLL_SUFFIX));
}

#[test]
fn a_new_model_in_rust() {
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (folder, target) = (kept.join("new-model"), kept.join("third-party-target"));
    let target = target.to_str().unwrap();
    let _ = std::fs::remove_dir_all(&folder);
    let dir = written("rust", &folder);
    let build = |more: &[&str]| {
        let built = Command::new(env!("CARGO"))
            .args(["build", "--quiet", "--release"])
            .args(more)
            .current_dir(&dir)
            .env("CARGO_TARGET_DIR", target)
            .status();
        assert!(built.unwrap().success());
    };
    build(&[]);
    passes(&format!("{target}/release/libmy_model{}", std::env::consts::DLL_SUFFIX));
    if !xtask::needs::WASM_TARGET.met(xtask::plugins::wasm_is_installed()) {
        return;
    }
    build(&["--target", "wasm32-unknown-unknown"]);
    passes(&format!("{target}/wasm32-unknown-unknown/release/my_model.wasm"));
}

#[test]
fn a_folder_that_is_there_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().to_str().unwrap();
    for (name, dir) in [("my-model", dir), ("My Model", "/nowhere"), ("1st", "/nowhere")] {
        let new = htex(&["plugin", "new", name, "--lang", "c", "--dir", dir]);
        assert_eq!(new.status.code(), Some(2));
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
