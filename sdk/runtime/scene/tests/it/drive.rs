//! The drive signal of an electrovibration display reproduces the texture.

use crate::common;

use common::{constant, display, planned, rendered, scene, single, trace, traced};
use htex_author::{
    Averaging, Recording, SegmentChoice, SpectrumOptions, TextureSpectrum, segment_spectra,
};
use htex_device::Capabilities;
use htex_dsp::bands::{energy_matching_gain, rms};
use htex_dsp::grid::level_rms;
use htex_play::Registry;
use htex_scene::file::Levels;
use htex_scene::{Renderer, Response, Scene};

const RATE_HZ: f64 = 50_000.0;
const DRIVE_V: f64 = 100.0;
/// Number of samples over which the drive is averaged. At 50 kHz, they are seven periods of twice
/// the carrier frequency.
const PERIODS: usize = 25;

/// The paper's rig at 50 kHz, without quantisation.
fn rig() -> Capabilities {
    Capabilities { default_rate_hz: RATE_HZ, step: None, ..display() }
}

fn driven(scene: &mut Scene) -> (Vec<f32>, Renderer) {
    scene.file.device.drive_v = Some(DRIVE_V);
    let mut renderer = Renderer::new(scene, &planned(scene, &rig())).unwrap();
    (rendered(&mut renderer), renderer)
}

/// Returns twice the square of the drive, averaged over whole periods, V². It is proportional to
/// the friction.
fn demodulated(drive: &[f32]) -> Vec<f64> {
    let squares: Vec<f64> = drive.iter().map(|v| 2.0 * f64::from(*v).powi(2)).collect();
    let mean = |w: &[f64]| w.iter().sum::<f64>() / PERIODS as f64;
    squares.windows(PERIODS).map(mean).collect()
}

/// RMS-averaged magnitudes on the 5 Hz grid.
fn magnitudes(signal: Vec<f64>) -> Vec<f64> {
    let options = SpectrumOptions::default()
        .with_segments(SegmentChoice::Windows)
        .with_averaging(Averaging::Rms);
    let recording = Recording::new("drive", RATE_HZ, vec![signal]).unwrap();
    let part = segment_spectra(&recording, &options).unwrap();
    TextureSpectrum::average(&[part], options.averaging).unwrap().magnitude
}

#[test]
fn the_demodulated_square_has_the_compensated_spectrum() {
    let response = Response {
        frequency_hz: vec![0.0, 100.0, 300.0, 600.0, 1_000.0],
        magnitude: vec![1.0, 1.2, 0.9, 0.4, 0.25],
        phase_rad: vec![0.0; 5],
    };
    for model in ["ar", "mfcc", "sbeta", "sslope", "bands"] {
        for response in [None, Some(response.clone())] {
            let mut scene = scene(single(), constant(80.0, 0.4), 60.0);
            scene.file.surfaces[0].representation = model.to_owned();
            scene.response = response.clone();
            let (drive, renderer) = driven(&mut scene);
            // Leaves out the ramps at both ends.
            let steady = demodulated(&drive[RATE_HZ as usize..drive.len() - RATE_HZ as usize]);
            let grid = single().band().grid_hz();
            let droop = |f: f64| {
                let x = std::f64::consts::PI * f * PERIODS as f64 / RATE_HZ;
                x.sin() / x
            };
            let found: Vec<f64> =
                magnitudes(steady.clone()).iter().zip(&grid).map(|(m, f)| m / droop(*f)).collect();
            let texture = single().representation(model).unwrap().magnitude(None, &grid).unwrap();
            let inverse = |f: f64| response.as_ref().map_or(1.0, |r| 1.0 / r.value_at(f).0);
            let wanted: Vec<f64> =
                texture.iter().zip(&grid).map(|(m, f)| m * inverse(*f)).collect();
            let gain = energy_matching_gain(&wanted, &found);
            // Bins where the model has no magnitude have no ratio.
            let most = wanted.iter().copied().fold(0.0, f64::max);
            let errors: Vec<f64> = found
                .iter()
                .zip(&wanted)
                .filter(|(_, wanted)| **wanted > 1e-3 * most)
                .map(|(a, b)| 20.0 * (gain * a / b).log10())
                .collect();
            assert!(errors.len() > 150);
            let error_db = rms(&errors);
            println!(
                "{model}, {}compensated: {error_db:.2} dB RMS, peak {:.1} V, {} radicands held",
                if response.is_some() { "" } else { "not " },
                renderer.peak(),
                renderer.rooted_samples()
            );
            assert!(error_db < 1.0, "{model}: {error_db} dB");

            // 4.5 times the texture's RMS corresponds to half the square of the largest voltage.
            let reach = 4.5 * level_rms(&found) / (DRIVE_V * DRIVE_V / 2.0);
            let reach_db = 20.0 * reach.log10();
            assert!(reach_db.abs() < 0.3, "{model}: {reach_db} dB");
        }
    }
}

/// The demodulated level of each model's drive, dB RMS, equals the level of its representation.
#[test]
fn levels_under_one_gain_are_normalised_or_the_representations_own() {
    let model = |name: &str, levels: Levels, reference_rms: Option<f64>| {
        let mut scene = scene(single(), constant(80.0, 0.4), 20.0);
        scene.file.surfaces[0].representation = name.to_owned();
        scene.file.device.levels = levels;
        scene.file.device.reference_rms = reference_rms;
        let (drive, _) = driven(&mut scene);
        let steady = demodulated(&drive[RATE_HZ as usize..drive.len() - RATE_HZ as usize]);
        let mean = steady.iter().sum::<f64>() / steady.len() as f64;
        let moved: Vec<f64> = steady.iter().map(|v2| v2 - mean).collect();
        20.0 * rms(&moved).log10()
    };
    let level_rms = |name: &str| single().representation(name).unwrap().parameters(None).unwrap().1;
    let all = single().manifest().representations.iter();
    let strongest_rms = all.map(|r| level_rms(&r.model)).fold(0.0, f64::max);
    let alike = model("ar", Levels::Normalised, None);
    // Over 20 s, the RMS of noise with most of its power in about 30 Hz has an uncertainty of 0.2
    // dB.
    const SPREAD_DB: f64 = 0.5;
    for name in Registry::builtin_names() {
        let normalised = model(name, Levels::Normalised, None) - alike;
        assert!(normalised.abs() < SPREAD_DB, "{name}: {normalised} dB");
        for reference_rms in [None, Some(1.5 * strongest_rms)] {
            let against_rms = reference_rms.unwrap_or(strongest_rms);
            let wanted = 20.0 * (level_rms(name) / against_rms).log10();
            let found = model(name, Levels::Own, reference_rms) - alike;
            println!("{name}: {found:.2} dB, by its level {wanted:.2} dB");
            assert!((found - wanted).abs() < SPREAD_DB, "{name}: {found} dB, not {wanted} dB");
        }
    }
}

#[test]
fn it_never_exceeds_the_limit_and_starts_and_ends_at_zero() {
    let lifted = |t: f64| if (0.5..0.7).contains(&t) { 0.0 } else { 0.4 };
    let motion = trace(2.0, |t| 10.0 * (12.0 * t).sin(), lifted);
    let mut scene = traced(single(), motion, 2.0);
    // The largest drive voltage.
    scene.file.device.drive_v = Some(150.0);
    let rig = Capabilities { default_rate_hz: RATE_HZ, ..display() };
    let mut renderer = Renderer::new(&scene, &planned(&scene, &rig)).unwrap();
    let drive = rendered(&mut renderer);
    assert_eq!(drive.len(), 100_000);
    assert!(drive.iter().all(|v| v.is_finite() && v.abs() <= 150.0));
    assert!(renderer.peak() > 100.0);
    assert_eq!([drive[0], drive[drive.len() - 1]], [0.0; 2]);
    let lifted = &drive[(0.53 * RATE_HZ) as usize..(0.69 * RATE_HZ) as usize];
    assert!(lifted.iter().all(|v| *v == 0.0), "silent without contact");
}
