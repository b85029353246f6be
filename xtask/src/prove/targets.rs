//! Checks that libhtex compiles for systems whose linkers are not available here. Does not link it.

use std::process::Command;

use anyhow::Result;

use crate::places::{cargo, workspace};
use crate::programs::run;

const TARGETS: [&str; 4] = [
    "aarch64-linux-android",
    "armv7-linux-androideabi",
    "aarch64-apple-ios",
    "aarch64-apple-darwin",
];

/// Features of the small library, and of a library with scenes and libraries of textures.
const FEATURES: [&str; 2] = ["", "library,scene"];

/// Compiles libhtex for each system with each set of features.
pub(super) fn prove() -> Result<()> {
    for target in TARGETS {
        for features in FEATURES {
            eprintln!("targets: {target}, features: [{features}]");
            let mut check = Command::new(cargo());
            check.args(["check", "--locked", "--quiet", "--target", target]);
            check.args(["--package", "htex-capi", "--no-default-features"]);
            run(check.args(["--features", features]).current_dir(workspace()))?;
        }
    }
    Ok(())
}
