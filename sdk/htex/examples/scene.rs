//! Renders a scene file for a device that takes newtons at 20 kHz, and prints the chain and the
//! RMS.
//!
//! `cargo run --release -p htex --features author,scene --example scene -- SCENE.json`

use std::path::PathBuf;
use std::sync::Arc;

use htex::Registry;
use htex::device::Devices;
use htex::scene::{Costs, DeviceOverride, LoadedScene, Renderer, Surroundings, plan};
use htex_device_builtin::file::FileAdapter;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path: PathBuf = std::env::args_os().nth(1).ok_or("give a scene: scene SCENE.json")?.into();
    let devices = Devices::new(vec![Arc::new(FileAdapter)]);
    let around = Surroundings { models: &Registry::builtin(), embedded: true, devices: &devices };
    // The example only renders the samples here; it does not open the device.
    let device = DeviceOverride {
        adapter: Some("org.htex.file".to_owned()),
        rehearsal: true,
        ..DeviceOverride::default()
    };
    let scene = LoadedScene::open(&path, &around, &device)?;
    let adapter = &devices.find_output("org.htex.file")?.adapter;
    let plan = plan(&scene, &adapter.capabilities(&scene.settings)?, &Costs::embedded())?;
    for stage in &plan.stages {
        println!("{}: {}", stage.name, stage.reason);
    }
    let mut renderer = Renderer::new(&scene, &plan)?;
    let mut block = vec![0.0f32; (renderer.rate_hz() / 10.0) as usize];
    for tenth in 0..10 {
        let frames = renderer.render(&mut block);
        let power: f32 = block[..frames].iter().map(|x| x * x).sum::<f32>() / frames.max(1) as f32;
        println!("{:.1} s  {:7.3} mN RMS", f64::from(tenth) / 10.0, power.sqrt() * 1e3);
    }
    Ok(())
}
