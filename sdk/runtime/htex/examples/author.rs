//! Makes an asset from a simulated recording.
//!
//! `cargo run --release -p htex --features author --example author -- cloth.htex`

use std::path::PathBuf;

use htex::Registry;
use htex::author::simulate::{SimulationOptions, Surface, simulate};
use htex::author::{AssetRequest, Exploration, ModelRequest, Take, fit_asset};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path: PathBuf =
        std::env::args_os().nth(1).ok_or("give the asset to write: author FILE.htex")?.into();
    let options = SimulationOptions::new(Surface::CoarseFabric);
    let take = Take {
        given: Exploration { speed_mm_s: Some(options.speed_mm_s), force_n: Some(options.force_n) },
        recording: simulate(&options)?.to_recording("simulated")?,
    };
    let registry = Registry::builtin();
    let models = registry.by_default().map(ModelRequest::new);
    let request = AssetRequest::new("Coarse cloth").with_models(models);
    let fitted = fit_asset(&[take], &request)?;
    fitted.asset.write(&path)?;
    let models = fitted.asset.manifest.representations.len();
    println!("{}: {models} models", path.display());
    Ok(())
}
