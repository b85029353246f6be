//! A voice has the same level at all sample rates.

use htex_play::{Texture, VoiceOptions};

/// Sample rates at which no image from the filter's own rate lies next to its original frequency.
const RATES_HZ: [f64; 8] =
    [2_000.0, 2_050.0, 2_200.0, 2_400.0, 2_500.0, 4_000.0, 8_000.0, 44_100.0];
const SECONDS: f64 = 20.0;

/// Makes an AR texture with a resonance at `hz`, two bins wide.
fn resonance(hz: f64) -> Texture {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../examples/scenes/vinyl.htex");
    let mut data = Texture::open(file).unwrap().data().clone();
    let all = &mut data.manifest.representations;
    let ar = all.iter().position(|r| r.model == "org.htex.ar").unwrap();
    let radius = (-std::f64::consts::PI * 10.0 / 2_000.0).exp();
    let turn = std::f64::consts::TAU * hz / 2_000.0;
    for set in &mut data.parameters[ar] {
        assert_eq!(set[0], 6.0);
        set[1..7].fill(0.0);
        set[1] = 2.0 * radius * turn.cos();
        set[2] = -radius * radius;
    }
    Texture::new(data)
}

fn rms(asset: &Texture, model: &str, rate_hz: f64) -> f64 {
    let options = VoiceOptions::default().with_seed(3).with_rate_hz(rate_hz);
    let mut voice = asset.representation(model).unwrap().voice(&options).unwrap();
    let mut samples = vec![0.0; (SECONDS * rate_hz) as usize];
    voice.render(&mut samples).unwrap();
    let power: f64 = samples.iter().map(|x| f64::from(*x).powi(2)).sum();
    (power / samples.len() as f64).sqrt()
}

#[test]
fn a_filter_has_one_level_at_all_rates() {
    for hz in [20.0, 300.0, 985.0, 999.0] {
        let asset = resonance(hz);
        let high = rms(&asset, "ar", 48_000.0);
        for rate_hz in RATES_HZ {
            let off_db = 20.0 * (rms(&asset, "ar", rate_hz) / high).log10();
            println!("{hz} Hz at {rate_hz} Hz: {off_db:+.3} dB");
            assert!(off_db.abs() < 0.05, "{hz} Hz at {rate_hz}: {off_db} dB");
        }
    }
}

/// Sample rates at which noise has components at other frequencies than at 2 kHz.
const LOW_RATES_HZ: [f64; 7] = [2_000.0, 2_001.0, 2_050.0, 2_100.0, 2_200.0, 2_300.0, 2_399.0];

/// The spectrum has most of its power at the lower edge of the band. The bins of the band read the
/// same level. The total level differs a little, most for MFCC.
#[test]
fn steep_noise_has_one_level_at_low_rates() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../examples/scenes/vinyl.htex");
    let asset = Texture::open(file).unwrap();
    for (model, most_db) in [("sslope", 0.05), ("sbeta", 0.05), ("mfcc", 0.1)] {
        let high = rms(&asset, model, 48_000.0);
        for rate_hz in LOW_RATES_HZ {
            let off_db = 20.0 * (rms(&asset, model, rate_hz) / high).log10();
            println!("{model} at {rate_hz} Hz: {off_db:+.3} dB");
            assert!(off_db.abs() < most_db, "{model} at {rate_hz} Hz: {off_db} dB");
        }
    }
}
