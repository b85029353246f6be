//! Renders a scene file in the unit of its textures at 20 kHz, and prints the chain and the RMS of
//! each tenth of the first second.
//!
//! `cargo run --release -p htex --features scene --example scene -- two.scene.json`

use htex::Scene;

const RATE_HZ: f64 = 20_000.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("give a scene: scene FILE.scene.json")?;
    let scene = Scene::open(&path)?;
    for stage in &scene.plan(RATE_HZ)?.stages {
        println!("{}: {}", stage.name, stage.reason);
    }
    let mut renderer = scene.renderer(RATE_HZ)?;
    let mut block = vec![0.0f32; (RATE_HZ / 10.0) as usize];
    for tenth in 0..10 {
        let frames = renderer.render(&mut block)?;
        let power: f32 = block[..frames].iter().map(|x| x * x).sum::<f32>() / frames.max(1) as f32;
        println!("{:.1} s  {:7.3} mN RMS", f64::from(tenth) / 10.0, power.sqrt() * 1e3);
    }
    Ok(())
}
