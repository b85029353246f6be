//! Prints the time to render one sample, in nanoseconds: the shortest time of five runs. The last
//! argument is the number of samples in a block. `cargo xtask prove costs` compares the bindings
//! for other languages with this example.
//!
//! `cargo run --release -p htex --example block -- cloth.htex ar 64`

use std::time::Instant;

use htex::{Texture, VoiceOptions};

/// Samples in one run.
const SAMPLES: usize = 1_920_000;
const RUNS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, model, block] = &arguments[..] else {
        return Err("give an asset, a model and a length: block FILE.htex MODEL SAMPLES".into());
    };
    let mut samples = vec![0.0f32; block.parse()?];
    let blocks = SAMPLES / samples.len().max(1);
    let asset = Texture::open(path)?;
    let options = VoiceOptions::default().with_seed(7);
    let mut voice = asset.representation(&model[..])?.voice(&options)?;
    let mut least = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        for _ in 0..blocks {
            voice.render(&mut samples)?;
            std::hint::black_box(&samples);
        }
        least = least.min(start.elapsed().as_secs_f64() * 1e9 / (samples.len() * blocks) as f64);
    }
    println!("{least:.4}");
    Ok(())
}
