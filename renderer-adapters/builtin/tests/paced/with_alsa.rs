//! Runs the tests of the feature `audio` if ALSA is installed. `cargo test` builds without the
//! feature, so that a machine without ALSA passes all other tests.

use std::path::Path;
use std::process::Command;

#[test]
fn playback_recording_and_four_channels_through_alsa() {
    let alsa = Command::new("pkg-config").args(["--exists", "alsa"]).status();
    if !xtask::needs::ALSA.met(alsa.is_ok_and(|status| status.success())) {
        return;
    }
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let mut cargo = Command::new(cargo);
    // In the workspace, as `cargo test` runs, so that the dependencies have the same features and
    // are not built again.
    cargo
        .args(["test", "--locked", "--features", "htex-device-builtin/audio"])
        .args(["--test", "audio_alsa", "--test", "audio_alsa_input", "--test", "channels_alsa"])
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .arg("--target-dir")
        .arg(target);
    let tests = xtask::programs::forget_package(&mut cargo).output().unwrap();
    let said = String::from_utf8_lossy(&tests.stdout);
    let errors = String::from_utf8_lossy(&tests.stderr);
    let all = ["6 passed", "4 passed", "1 passed"].iter().all(|passed| said.contains(passed));
    assert!(tests.status.success() && all, "{said}{errors}");
}
