//! What cannot be asked for is refused before anything is built.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::process::Command;

#[test]
fn a_toolchain_that_there_is_not_is_wrong_usage() {
    let cases: [(&[&str], &str); 3] = [
        (&["--wasm-toolchain", "moon"], "`moon` is no way"),
        (
            &["--native-only", "--wasm-toolchain", "debian"],
            "cargo xtask",
        ),
        (&["--wasm-toolchain"], "cargo xtask"),
    ];
    for (options, words) in cases {
        let mut xtask = Command::new(env!("CARGO_BIN_EXE_xtask"));
        let done = xtask.arg("plugins").args(options).output().unwrap();
        let error = String::from_utf8(done.stderr).unwrap();
        assert_eq!(done.status.code(), Some(2), "{options:?}: {error}");
        assert!(error.contains(words), "{options:?}: {error}");
    }
}
