//! Prints the time of a sample, ns: the least of several runs over blocks of 64. Other languages are compared with it
//! (`cargo xtask bindings costs`).
//!
//! `cargo run --release -p htex --example block -- cloth.htex ar`

use std::time::Instant;

use htex::{Asset, VoiceOptions};

const BLOCK: usize = 64;
const BLOCKS: usize = 30_000;
const RUNS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, model] = &arguments[..] else {
        return Err("give an asset and a model: block FILE.htex MODEL".into());
    };
    let asset = Asset::open(path)?;
    let options = VoiceOptions::default().with_model(model).with_seed(7);
    let mut voice = asset.voice(&options)?;
    let mut least = f64::INFINITY;
    for _ in 0..RUNS {
        let mut samples = [0.0f32; BLOCK];
        let start = Instant::now();
        for _ in 0..BLOCKS {
            voice.render(&mut samples)?;
            std::hint::black_box(&samples);
        }
        least = least.min(start.elapsed().as_secs_f64() * 1e9 / (BLOCK * BLOCKS) as f64);
    }
    println!("{least:.4}");
    Ok(())
}
