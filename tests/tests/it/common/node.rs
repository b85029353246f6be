//! Scripts that Node runs with the installed packages.

use std::path::PathBuf;
use std::process::Command;

use htex_tests::workspace;
use serde_json::Value;

/// The folder of Node packages. This test is target/debug/deps/NAME.
pub fn packages() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    test.ancestors().nth(3).unwrap().join("node/node_modules")
}

/// What a script of `tests` prints.
pub fn ran(script: &str, files: &[PathBuf]) -> Value {
    let ran = Command::new("node")
        .arg(workspace().join("tests").join(script))
        .args(files)
        .env("NODE_PATH", packages())
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "{error}");
    serde_json::from_slice(&ran.stdout).unwrap()
}
