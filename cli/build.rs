//! Sets the commit that `htex --version` prints: `HTEX_COMMIT` if it is set, otherwise the commit
//! of the clone in which an optimised build is made. Development builds print `unknown`, so that
//! they are not compiled again after each commit.
//!
//! Also tells `htex plugin new` where the sources are. If `HTEX_COMMIT` is set, as for a release,
//! the program contains no path of the build machine.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=HTEX_COMMIT");
    let given = std::env::var("HTEX_COMMIT").ok();
    if given.is_none() {
        let sources = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
        println!("cargo:rustc-env=HTEX_SDK={sources}/../sdk");
    }
    let is_optimised = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let commit = given
        .or_else(|| is_optimised.then(of_clone).flatten())
        .unwrap_or_else(|| "unknown".to_owned());
    println!("cargo:rustc-env=HTEX_COMMIT={commit}");
    let target = std::env::var("TARGET").unwrap_or_default();
    println!("cargo:rustc-env=HTEX_TARGET={target}");
    println!("cargo:rustc-env=HTEX_FEATURES={}", features().join(" "));
}

/// The names of the features of this build, in alphabetical order.
fn features() -> Vec<String> {
    let names = std::env::vars().filter_map(|(name, _)| {
        let name = name.strip_prefix("CARGO_FEATURE_")?.to_lowercase();
        (name != "default").then(|| name.replace('_', "-"))
    });
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// Returns the commit of the clone that contains this crate; `None` outside a clone.
fn of_clone() -> Option<String> {
    let log = Path::new("../.git/logs/HEAD");
    if !log.exists() {
        return None;
    }
    println!("cargo:rerun-if-changed={}", log.display());
    let command = Command::new("git").args(["rev-parse", "--short=12", "HEAD"]).output();
    let output = command.ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
