//! Invalid options are refused before anything is built.

use std::process::Command;

#[test]
fn an_unknown_toolchain_is_a_usage_error() {
    let cases: [(&[&str], &str); 3] = [
        (&["--wasm-toolchain", "moon"], "[possible values: auto, installed, debian]"),
        (&["--native-only", "--wasm-toolchain", "debian"], "cargo xtask plugins"),
        (&["--wasm-toolchain"], "a value is required"),
    ];
    for (options, words) in cases {
        let mut xtask = Command::new(env!("CARGO_BIN_EXE_xtask"));
        let done = xtask.arg("plugins").args(options).output().unwrap();
        let error = String::from_utf8(done.stderr).unwrap();
        assert_eq!(done.status.code(), Some(2), "{options:?}: {error}");
        assert!(error.contains(words), "{options:?}: {error}");
    }
}
