//! What the bands model promises of recordings: nine energies to half a decibel in 24 bytes, through
//! the file, and more bands for more bytes.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::{AssetRequest, Exploration, ModelRequest, Take, fit_asset};
use htex_format::{Asset, Quality};
use htex_host::Registry;

/// The model's block at one condition, after a journey through a file.
struct Kept {
    bytes: usize,
    parameters: Vec<f64>,
    quality: Quality,
}

fn take(surface: Surface) -> Take {
    let simulation = simulate(&SimulationOptions::new(surface)).unwrap();
    Take {
        recording: simulation.to_recording("a recording").unwrap(),
        given: Exploration {
            speed_mm_s: Some(80.0),
            force_n: Some(0.4),
        },
    }
}

fn keep(take: &Take, options: &[(&str, &str)]) -> Kept {
    let model = Registry::builtin().find("bands").unwrap().clone();
    let options = model.options(options).unwrap();
    let request = AssetRequest {
        name: "A surface".to_owned(),
        models: vec![ModelRequest { model, options }],
        ..AssetRequest::default()
    };
    let asset = fit_asset(std::slice::from_ref(take), &request)
        .unwrap()
        .asset;
    let asset = Asset::from_bytes(&asset.to_bytes().unwrap()).unwrap();
    Kept {
        bytes: asset.payload_bytes(0),
        parameters: asset.parameters[0][0].clone(),
        quality: asset.manifest.representations[0].at[0]
            .quality
            .clone()
            .unwrap(),
    }
}

#[test]
fn nine_bands_of_every_surface_in_24_bytes_to_half_a_decibel() {
    for surface in Surface::ALL {
        let kept = keep(&take(surface), &[]);
        let quality = &kept.quality;
        let played = quality.samples_band_error_rms_db.unwrap();
        println!(
            "{:16} {} bytes; bands within {:.3} dB, played within {played:.3} dB; correlation {:.3}",
            surface.to_string(),
            kept.bytes,
            quality.band_error_rms_db,
            quality.spectral_correlation,
        );
        assert!(kept.bytes <= 24, "{surface}: {} bytes", kept.bytes);
        // Rounding to 0.5 dB is at most 0.25 dB away; 20 s of noise scatter by 0.2 dB themselves.
        assert!(quality.band_error_rms_db <= 0.25, "{surface}: {quality:?}");
        assert!(played <= 0.5, "{surface}: played within {played} dB");
        // What the file keeps is what was fitted.
        assert_eq!(quality.rounding_error_db.unwrap_or(0.0), 0.0);
    }
}

#[test]
fn many_bands_play_as_they_say() {
    let take = take(Surface::ALL[2]);
    for bands in ["12", "25", "29", "33", "37", "40"] {
        let quality = keep(&take, &[("bands", bands)]).quality;
        let played = quality.samples_band_error_rms_db.unwrap();
        assert!(quality.band_error_rms_db <= 0.75, "{bands}: {quality:?}");
        assert!(played <= 1.0, "{bands} bands: played within {played} dB");
    }
}

#[test]
fn bytes_buy_detail_and_steps_buy_accuracy() {
    let take = take(Surface::ALL[0]);
    let mut correlation = 0.0;
    for bands in [3, 9, 19, 39] {
        let kept = keep(&take, &[("bands", &bands.to_string())]);
        assert_eq!(kept.bytes, bands + 2);
        assert!(kept.quality.spectral_correlation > correlation, "{bands}");
        correlation = kept.quality.spectral_correlation;
        // These divide the nine bands evenly.
        assert!(
            bands < 9 || kept.quality.band_error_rms_db < 0.25,
            "{bands}"
        );
    }
    for (step_db, most_db) in [("0.05", 0.025), ("3", 1.5)] {
        let kept = keep(&take, &[("step_db", step_db)]);
        assert_eq!(kept.parameters[10], step_db.parse::<f64>().unwrap());
        assert!(kept.quality.band_error_rms_db <= most_db, "{step_db}");
    }
}
