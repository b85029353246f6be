//! The time of a sample of an imported texture that follows a finger: cargo run --release -p htex-exchange --example live FILE.xml

use std::hint::black_box;
use std::time::Instant;

use htex_exchange::hatt::{Imported, asset, read};
use htex_play::{Asset, Motion, VoiceOptions};

const RATE_HZ: f64 = 20_000.0;
/// Samples between two motions.
const BLOCK: usize = 64;
const BLOCKS: usize = 20_000;
const RUNS: usize = 7;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("give a model file")?;
    let made = asset(&read(&std::fs::read(file)?)?, &Imported::default())?;
    let asset = Asset::from_bytes(&made.to_bytes()?)?;
    for (what, moves) in [
        ("at one motion", false),
        ("a new motion in each block of 64", true),
    ] {
        let mut least = f64::INFINITY;
        for _ in 0..RUNS {
            let mut options = VoiceOptions::default();
            options.rate_hz = RATE_HZ;
            options.motion = Some(Motion::new(100.0, 1.0));
            let mut voice = asset.voice(&options)?;
            let mut block = [0.0f32; BLOCK];
            let begun = Instant::now();
            for i in 0..BLOCKS {
                if moves {
                    let turn = 0.002 * i as f64;
                    voice.set_motion(Motion::new(120.0 + 90.0 * turn.sin(), 1.5 + turn.cos()))?;
                }
                voice.render(black_box(&mut block))?;
            }
            least = least.min(begun.elapsed().as_secs_f64());
        }
        let samples = (BLOCKS * BLOCK) as f64;
        println!("{what}: {:.1} ns a sample at 20 kHz", 1e9 * least / samples);
    }
    Ok(())
}
