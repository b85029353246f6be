//! Plays a texture with rodio while a finger strokes it.
//!
//! `cargo run --release -- FILE.htex` plays for ten seconds through the sound card.
//! `cargo run --release -- FILE.htex --wav FILE.wav SECONDS` writes the same samples to a file.

mod source;

use std::error::Error;
use std::thread::sleep;
use std::time::Duration;

use htex::Texture;
use rodio::buffer::SamplesBuffer;
use rodio::cpal::BufferSize;
use rodio::{DeviceSinkBuilder, nz, wav_to_file};

use source::{Finger, TextureSource};

/// Number of times per second that the program moves the finger.
const STEPS_PER_S: u32 = 100;
const FORCE_N: f32 = 0.4;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [texture] => play(texture),
        [texture, "--wav", wav, seconds] => write(texture, wav, seconds.parse()?),
        _ => Err("usage: app-rust-rodio FILE.htex [--wav FILE.wav SECONDS]".into()),
    }
}

/// Plays for ten seconds through the sound card.
fn play(texture: &str) -> Result<(), Box<dyn Error>> {
    let mut speaker = DeviceSinkBuilder::from_default_device()?
        .with_buffer_size(BufferSize::Fixed(512)) // rodio's default lags by 100 ms
        .open_sink_or_fallback()?;
    speaker.log_on_drop(false);
    let texture = Texture::open(texture)?;
    let finger = Finger::default();
    let source = TextureSource::new(&texture, finger.clone(), speaker.config().sample_rate())?;
    speaker.mixer().add(source);
    for step in 0..10 * STEPS_PER_S {
        finger.slide(speed_mm_s(step), FORCE_N);
        sleep(Duration::from_secs(1) / STEPS_PER_S);
    }
    Ok(())
}

/// Writes what a sound card of 48 kHz would play to a WAV file.
fn write(texture: &str, wav: &str, seconds: u32) -> Result<(), Box<dyn Error>> {
    let rate = nz!(48_000);
    let texture = Texture::open(texture)?;
    let finger = Finger::default();
    let mut source = TextureSource::new(&texture, finger.clone(), rate)?;
    let mut samples = Vec::new();
    for step in 0..seconds * STEPS_PER_S {
        finger.slide(speed_mm_s(step), FORCE_N);
        samples.extend(source.by_ref().take((rate.get() / STEPS_PER_S) as usize));
    }
    Ok(wav_to_file(SamplesBuffer::new(nz!(1), rate, samples), wav)?)
}

/// The finger strokes once a second: its speed rises to 120 mm/s and falls to zero.
fn speed_mm_s(step: u32) -> f32 {
    let phase = (step % STEPS_PER_S) as f32 / STEPS_PER_S as f32;
    240.0 * phase.min(1.0 - phase)
}
