//! A player has the same spectrum as the host's voice, at the conditions of a baked block and
//! between them.

use crate::bake_common as common;

use std::sync::Mutex;

use common::asset;
use htex_author::{
    Averaging, Recording, SegmentChoice, SpectrumOptions, TextureSpectrum, segment_spectra,
};
use htex_dsp::bands::{BAND_COUNT, BandBank, band_error_db};
use htex_host::Band;
use htex_play::bake::{Grid, bake};
use htex_play::{Motion, Registry, Texture, VoiceOptions};
use htex_player::{Block, Player};

const RATE_HZ: f64 = 8_000.0;
const SECONDS: f64 = 400.0;
/// Largest error of a band, dB. Measured over 400 s, the lowest bands of a voice scatter by 0.1 dB.
const WITHIN_DB: f64 = 0.3;
/// Bands with less than this part of the strongest band's energy (40 dB below it) are not compared.
const FAINT: f64 = 1e-4;

fn energies(samples: Vec<f32>) -> Vec<f64> {
    let samples = samples.into_iter().map(f64::from).collect();
    let recording = Recording::new("samples", RATE_HZ, vec![samples]).unwrap();
    let options = SpectrumOptions::default()
        .with_segments(SegmentChoice::Windows)
        .with_averaging(Averaging::Rms);
    let part = segment_spectra(&recording, &options).unwrap();
    let spectrum = TextureSpectrum::average(&[part], Averaging::Rms).unwrap();
    let bank = BandBank::new(BAND_COUNT, Band::TACTILE, &Band::TACTILE.grid_hz());
    bank.energies(&spectrum.magnitude)
}

fn of_host(asset: &Texture, model: &str, motion: Motion) -> Vec<f64> {
    let options =
        VoiceOptions::default().with_rate_hz(RATE_HZ).with_motion(Some(motion)).with_seed(3);
    let mut samples = vec![0.0; (SECONDS * RATE_HZ) as usize];
    asset.representation(model).unwrap().voice(&options).unwrap().render(&mut samples).unwrap();
    energies(samples)
}

fn of_player(block: &[u8], motion: Motion) -> Vec<f64> {
    let mut player = Player::new(Block::open(block).unwrap(), 5);
    assert!(player.set_motion(motion.speed_mm_s as f32, motion.force_n as f32));
    let mut samples = vec![0.0; (SECONDS * RATE_HZ) as usize];
    player.render(&mut samples);
    energies(samples)
}

/// Returns the largest error among the bands within 40 dB of the strongest band, dB.
fn largest_db(host: &[f64], player: &[f64]) -> f64 {
    let strongest = host.iter().copied().fold(0.0, f64::max);
    let errors = band_error_db(host, player).into_iter().zip(host);
    let compared = errors.filter(|(_, energy)| **energy > FAINT * strongest);
    compared.map(|(error, _)| error.abs()).fold(0.0, f64::max)
}

#[test]
fn a_player_has_the_spectrum_of_the_host() {
    let asset = asset();
    let grid = Grid::new(vec![60.0, 120.0], vec![0.3, 0.6]).unwrap();
    let failed = Mutex::new(Vec::new());
    let model_by_model = |model: &str| {
        let baked = bake(asset.representation(model).unwrap(), &grid, RATE_HZ, 0.2).unwrap();
        // A motion between all recorded conditions, and one of them.
        let motions = [(87.0, 0.43), (120.0, 0.3)];
        let tried = if xtask::prove::whole() { 2 } else { 1 };
        for (speed, force) in &motions[..tried] {
            let (speed, force) = (*speed, *force);
            let motion = Motion::new(speed, force);
            let error =
                largest_db(&of_host(&asset, model, motion), &of_player(&baked.bytes, motion));
            println!("{model} at {speed} mm/s, {force} N: {error:.3} dB");
            if error > WITHIN_DB {
                let line = format!("{model} at {speed} mm/s, {force} N: {error:.3} dB");
                failed.lock().unwrap().push(line);
            }
        }
    };
    std::thread::scope(|scope| {
        for model in Registry::placeless_names() {
            scope.spawn(move || model_by_model(model));
        }
    });
    let failed = failed.into_inner().unwrap();
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
fn one_recorded_speed_scales_frequencies_and_level() {
    let mut data = common::data();
    for representation in &mut data.manifest.representations {
        representation.at.truncate(1);
    }
    for parameters in &mut data.parameters {
        parameters.truncate(1);
    }
    let asset = Texture::new(data);
    let grid = Grid::new(vec![45.0, 60.0], vec![0.2, 0.3]).unwrap();
    let baked = bake(asset.representation("sslope").unwrap(), &grid, RATE_HZ, 0.2).unwrap();
    let motion = Motion::new(45.0, 0.2);
    let (host, player) = (of_host(&asset, "sslope", motion), of_player(&baked.bytes, motion));
    let error = largest_db(&host, &player);
    assert!(error < WITHIN_DB, "{error}");
    // It differs from the texture as recorded.
    let recorded = of_host(&asset, "sslope", Motion::new(60.0, 0.3));
    assert!(largest_db(&recorded, &player) > 2.0);
}
