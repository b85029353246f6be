//! Runs the tests of the feature `cpal` if ALSA is installed. `cargo test` builds without the
//! feature, so that a machine without ALSA passes all other tests.
#![cfg(all(not(feature = "cpal"), target_os = "linux"))]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::path::Path;
use std::process::Command;

#[test]
fn playback_and_recording_through_alsa() {
    let alsa = Command::new("pkg-config").args(["--exists", "alsa"]).status();
    if !xtask::needs::ALSA.met(alsa.is_ok_and(|status| status.success())) {
        return;
    }
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let tests = Command::new(cargo)
        .args([
            "test",
            "--locked",
            "--features",
            "cpal",
            "--test",
            "alsa",
            "--test",
            "alsa_input",
            "--manifest-path",
        ])
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml"))
        .arg("--target-dir")
        .arg(target)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&tests.stdout);
    let errors = String::from_utf8_lossy(&tests.stderr);
    assert!(
        tests.status.success() && said.contains("6 passed") && said.contains("4 passed"),
        "{said}{errors}"
    );
}
