//! An asset with all models, and files for tests.

use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::{AssetRequest, Exploration, ModelRequest, Take, fit_asset};
use htex_format::Asset;
use htex_play::{Registry, Texture};

/// An asset with every built-in model, recorded at two speeds and two forces.
pub fn asset() -> Texture {
    Texture::new(data())
}

pub fn data() -> Asset {
    static DATA: OnceLock<Asset> = OnceLock::new();
    DATA.get_or_init(|| data_of(Surface::CoarseFabric)).clone()
}

/// An asset of a surface with every built-in model, recorded at two speeds and two forces.
pub fn asset_of(surface: Surface) -> Texture {
    Texture::new(data_of(surface))
}

fn data_of(surface: Surface) -> Asset {
    let motions = [(60.0, 0.3), (120.0, 0.3), (60.0, 0.6), (120.0, 0.6)];
    let takes = motions.map(|motion| take(surface, motion));
    let models = Registry::builtin();
    let models = models.models().iter().map(ModelRequest::new);
    let request = AssetRequest::new("simulated").with_models(models);
    fit_asset(&takes, &request).unwrap().asset
}

fn take(surface: Surface, (speed_mm_s, force_n): (f64, f64)) -> Take {
    let options = SimulationOptions::new(surface)
        .with_speed_mm_s(speed_mm_s)
        .with_force_n(force_n)
        .with_duration_s(4.0);
    Take {
        recording: simulate(&options).unwrap().to_recording("simulated").unwrap(),
        given: Exploration { speed_mm_s: Some(speed_mm_s), force_n: Some(force_n) },
    }
}

/// The folder of the player's crate.
pub fn player() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../player")
}

/// The folder in which programs for boards are built.
pub fn built() -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("board")
}

/// Runs a command and returns its standard output.
pub fn run(command: &mut Command) -> String {
    let done = command.output().unwrap();
    let error = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{command:?}: {error}");
    String::from_utf8(done.stdout).unwrap()
}

/// Whether a program is installed.
pub fn has(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}
