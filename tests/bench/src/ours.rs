//! The tasks, performed by htex.

use std::hint::black_box;
use std::time::Instant;

use htex::{Texture, VoiceOptions};
use htex_author::recording::{ReadOptions, read_recording};
use htex_author::{SpectrumOptions, TextureSpectrum, segment_spectra};
use htex_host::{LoadedModel, ModelVoice, Stream, render_together};

use crate::case::{Case, request};

const DEVICE_HZ: f64 = 20_000.0;
const BLOCK: usize = 256;
/// Number of samples, the same as in the C loops.
const SAMPLES: usize = 1 << 20;
const VOICES: u64 = 1_000;
/// Number of voices rendered in one call.
const TOGETHER: usize = 16;
/// Number of blocks of each voice, the same as in the C loops.
const ROUNDS: usize = 16;
/// How often an asset is opened before the time is measured.
const OPENINGS: usize = 20;

type Failure = Box<dyn std::error::Error>;
type Task<'a> = Box<dyn FnMut() -> Result<f64, Failure> + 'a>;

/// Returns a task by its name. Each run returns seconds per unit.
pub(crate) fn task<'a>(case: &'a Case, name: &str) -> Result<Task<'a>, Failure> {
    Ok(match name {
        "ar" => voice(case, "ar")?,
        "ar_many" => many_voices(case)?,
        "fit" => Box::new(|| fit(case)),
        "fit_burg" => Box::new(|| fit_burg(case)),
        "process" => Box::new(|| process(case)),
        "open" => Box::new(|| {
            for _ in 0..OPENINGS {
                open(case)?;
            }
            open(case)
        }),
        "open_once" => Box::new(|| open(case)),
        device => stream(case, device.trim_end_matches("_device"))?,
    })
}

/// A voice at its own rate.
fn voice<'a>(case: &'a Case, model: &str) -> Result<Task<'a>, Failure> {
    let mut voice = new_voice(case, case.registry.find(model)?, 1)?;
    Ok(Box::new(move || {
        let mut block = [0.0f32; BLOCK];
        let begun = Instant::now();
        for _ in 0..SAMPLES / BLOCK {
            voice.render(black_box(&mut block))?;
        }
        Ok(begun.elapsed().as_secs_f64() / SAMPLES as f64)
    }))
}

fn new_voice(case: &Case, model: &LoadedModel, seed: u64) -> Result<ModelVoice, Failure> {
    let (parameters, band) = (case.parameters(model.short_name()), case.spectrum.band);
    let rate_hz = model.voice_rate_hz(parameters, band, DEVICE_HZ)?;
    Ok(model.voice(parameters, band, rate_hz, seed)?)
}

/// A voice at the device's rate.
fn stream<'a>(case: &'a Case, model: &str) -> Result<Task<'a>, Failure> {
    let (parameters, band) = (case.parameters(model), case.spectrum.band);
    let model = case.registry.find(model)?;
    let mut stream = Stream::new(model, parameters, band, DEVICE_HZ, 1)?;
    Ok(Box::new(move || {
        let mut block = [0.0f32; BLOCK];
        let begun = Instant::now();
        for _ in 0..SAMPLES / BLOCK {
            stream.render(black_box(&mut block))?;
        }
        Ok(begun.elapsed().as_secs_f64() / SAMPLES as f64)
    }))
}

/// A thousand AR voices, each with its own noise, at their own rate.
fn many_voices<'a>(case: &'a Case) -> Result<Task<'a>, Failure> {
    let model = case.registry.find("ar")?;
    let voices: Result<Vec<_>, _> = (0..VOICES).map(|seed| new_voice(case, model, seed)).collect();
    let mut voices = voices?;
    Ok(Box::new(move || {
        let mut blocks = [0.0f32; TOGETHER * BLOCK];
        let begun = Instant::now();
        for _ in 0..ROUNDS {
            for voices in voices.chunks_mut(TOGETHER) {
                render_together(voices, BLOCK, black_box(&mut blocks))?;
            }
        }
        let samples = ROUNDS * VOICES as usize * BLOCK;
        Ok(begun.elapsed().as_secs_f64() / samples as f64)
    }))
}

/// Fits the paper's five models to a spectrum.
fn fit(case: &Case) -> Result<f64, Failure> {
    let begun = Instant::now();
    for name in ["ar", "mfcc", "speak", "sbeta", "sslope"] {
        let model = case.registry.find(name)?;
        let options = model.options(&[])?;
        black_box(model.fit(&request(&case.spectrum, &options))?);
    }
    Ok(begun.elapsed().as_secs_f64())
}

/// Fits AR to the segments by Burg's method.
fn fit_burg(case: &Case) -> Result<f64, Failure> {
    let begun = Instant::now();
    let model = case.registry.find("ar")?;
    let options = model.options(&[("method", "burg")])?;
    black_box(model.fit(&request(&case.spectrum, &options))?);
    Ok(begun.elapsed().as_secs_f64())
}

/// Measures from a CSV file to the texture spectrum.
fn process(case: &Case) -> Result<f64, Failure> {
    let begun = Instant::now();
    let recording = read_recording(&case.folder.join("recording.csv"), &ReadOptions::default())?;
    let spectra = segment_spectra(&recording, &SpectrumOptions::default())?;
    black_box(TextureSpectrum::average(&[spectra], Default::default())?);
    Ok(begun.elapsed().as_secs_f64())
}

/// Measures from an asset's bytes to the first sample.
fn open(case: &Case) -> Result<f64, Failure> {
    let begun = Instant::now();
    let asset = Texture::from_bytes(&case.asset)?;
    let mut voice = asset.voice(&VoiceOptions::default())?;
    voice.render(black_box(&mut [0.0f32]))?;
    Ok(begun.elapsed().as_secs_f64())
}
