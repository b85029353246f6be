//! Measures how long a voice takes per sample, for an imported texture that follows a finger: cargo
//! run --release -p htex-exchange --example voice_cost FILE.xml

use std::hint::black_box;
use std::time::Instant;

use htex_exchange::Naming;
use htex_exchange::hatt::{asset, read};
use htex_play::{Motion, Texture, VoiceOptions};

const RATE_HZ: f64 = 20_000.0;
/// Number of samples in a run.
const SAMPLES: usize = 400_000;
const RUNS: usize = 15;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("give a model file")?;
    let made = asset(&read(&std::fs::read(file)?)?, &Naming::default())?;
    let asset = Texture::from_bytes(&made.to_bytes()?)?;
    for (what, samples, moves) in [
        ("at one motion, blocks of 64", 64, false),
        ("a new motion in each block of 64", 64, true),
        ("a new motion each ms", 20, true),
    ] {
        let mut least = f64::INFINITY;
        for _ in 0..RUNS {
            least = least.min(run_s(&asset, samples, moves)?);
        }
        println!("{what}: {:.1} ns a sample at 20 kHz", 1e9 * least / SAMPLES as f64);
    }
    Ok(())
}

/// Returns the time of a run, seconds. The run renders `samples` samples at a time.
fn run_s(asset: &Texture, samples: usize, moves: bool) -> Result<f64, Box<dyn std::error::Error>> {
    let options =
        VoiceOptions::default().with_rate_hz(RATE_HZ).with_motion(Motion::new(100.0, 1.0));
    let mut voice = asset.voice(&options)?;
    let mut block = vec![0.0f32; samples];
    let begun = Instant::now();
    for i in 0..SAMPLES / samples {
        if moves {
            let turn = 0.001 * (i * samples) as f64 / 20.0;
            voice.set_motion(Motion::new(120.0 + 90.0 * turn.sin(), 1.5 + turn.cos()))?;
        }
        voice.render(black_box(&mut block))?;
    }
    Ok(begun.elapsed().as_secs_f64())
}
