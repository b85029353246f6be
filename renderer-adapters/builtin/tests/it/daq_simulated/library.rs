//! Builds the library of `examples/nidaqmx-simulated`.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Builds the library once per run and returns its path.
pub fn built() -> &'static Path {
    static BUILT: OnceLock<PathBuf> = OnceLock::new();
    BUILT.get_or_init(|| {
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("nidaqmx-simulated");
        let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
        let built = Command::new(cargo)
            .args(["build", "--release", "--quiet", "--locked", "--manifest-path"])
            .arg(project().join("Cargo.toml"))
            .arg("--target-dir")
            .arg(&target)
            .status()
            .unwrap();
        assert!(built.success());
        let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
        target.join(format!("release/{prefix}nidaqmx_simulated{suffix}"))
    })
}

/// Returns the project's folder, for the tests of any crate.
fn project() -> PathBuf {
    let mut above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    above
        .find_map(|folder| Some(folder.join("examples/nidaqmx-simulated")).filter(|f| f.is_dir()))
        .unwrap()
}
