//! Promises of the bands model on recordings: third-octave bands to half a decibel in 24 bytes,
//! through the file; nine energies to half a step; and more bands for more bytes.

use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::{
    AssetRequest, Averaging, Exploration, ModelRequest, SpectrumOptions, Take, fit_asset,
};
use htex_format::{Asset, Measure, Quality};
use htex_host::Registry;

/// The model's block at one condition, written to a file and read back.
struct Kept {
    bytes: usize,
    parameters: Vec<f64>,
    quality: Quality,
}

fn simulated_take(options: &SimulationOptions) -> Take {
    Take {
        recording: simulate(options).unwrap().to_recording("a recording").unwrap(),
        given: Exploration { speed_mm_s: Some(options.speed_mm_s), force_n: Some(options.force_n) },
    }
}

fn keep(take: &Take, options: &[(&str, &str)]) -> Kept {
    let model = Registry::builtin().find("bands").unwrap().clone();
    let options = model.options(options).unwrap();
    let request = AssetRequest::new("A surface")
        .with_models([ModelRequest::new(&model).with_options(options)])
        .with_spectrum(SpectrumOptions::default().with_averaging(Averaging::Rms));
    let asset = fit_asset(std::slice::from_ref(take), &request).unwrap().asset;
    let asset = Asset::from_bytes(&asset.to_bytes().unwrap()).unwrap();
    Kept {
        bytes: asset.payload_bytes(0),
        parameters: asset.parameters[0][0].clone(),
        quality: asset.manifest.representations[0].at[0].quality.clone().unwrap(),
    }
}

/// Recordings that were not used to choose the model's constants: other pieces of the surfaces,
/// other motions.
fn unseen() -> Vec<SimulationOptions> {
    let motions = [(80.0, 0.4, 31), (40.0, 0.8, 32), (160.0, 0.2, 33), (100.0, 1.0, 34)];
    let of = |surface| {
        motions.map(|(speed_mm_s, force_n, seed)| {
            SimulationOptions::new(surface)
                .with_speed_mm_s(speed_mm_s)
                .with_force_n(force_n)
                .with_seed(seed)
        })
    };
    Surface::ALL.into_iter().flat_map(of).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    0.5 * (values[values.len() / 2] + values[(values.len() - 1) / 2])
}

fn nine_band_db(quality: &Quality) -> f64 {
    quality.get(Measure::NineBand).unwrap()
}

fn correlation_of(quality: &Quality) -> f64 {
    quality.get(Measure::SpectralCorrelation).unwrap()
}

#[test]
fn third_octaves_of_unseen_recordings_in_24_and_48_bytes() {
    let takes: Vec<Take> = unseen().iter().map(simulated_take).collect();
    let fine: &[(&str, &str)] = &[("bands", "64")];
    for (options, bytes, most_db) in [(&[][..], 24, 0.6), (fine, 48, 0.4)] {
        let kept: Vec<Kept> = takes.iter().map(|take| keep(take, options)).collect();
        let of =
            |value: fn(&Quality) -> f64| median(kept.iter().map(|k| value(&k.quality)).collect());
        let third_octave_db = of(|q| q.get(Measure::ThirdOctave).unwrap());
        println!(
            "{options:?}: {} bytes at most, {} in the middle; third octaves {third_octave_db:.3} dB, played \
             {:.3} dB; log-spectral {:.2} dB; nine bands {:.3} dB; correlation {:.3}",
            kept.iter().map(|k| k.bytes).max().unwrap(),
            median(kept.iter().map(|k| k.bytes as f64).collect()),
            of(|q| q.samples(Measure::ThirdOctave).unwrap()),
            of(|q| q.get(Measure::LogSpectral).unwrap()),
            of(nine_band_db),
            of(correlation_of),
        );
        assert!(kept.iter().all(|k| k.bytes <= bytes));
        assert!(third_octave_db <= most_db, "{third_octave_db} dB");
        for Kept { quality, .. } in &kept {
            // Twenty seconds of noise scatter by 0.2 dB themselves, and lines play slightly wider.
            let played_db = quality.samples(Measure::NineBand).unwrap();
            assert!(played_db <= 0.8, "{quality:?}");
            // The file keeps the fitted values.
            assert_eq!(quality.rounding_error_db.unwrap_or(0.0), 0.0);
        }
    }
}

#[test]
fn nine_bands_are_kept_to_half_a_step() {
    for surface in Surface::ALL {
        let take = simulated_take(&SimulationOptions::new(surface));
        let kept = keep(&take, &[("bands", "9"), ("step_db", "0.5")]);
        let played_db = kept.quality.samples(Measure::NineBand).unwrap();
        // Half a step, plus what the window blurs next to steep flanks.
        assert!(nine_band_db(&kept.quality) <= 0.3, "{surface}: {:?}", kept.quality);
        assert!(played_db <= 0.5, "{surface}: played within {played_db} dB");
        assert!(kept.bytes <= 12, "{surface}: {} bytes", kept.bytes);
    }
}

#[test]
fn bytes_buy_detail_and_steps_buy_accuracy() {
    let take = simulated_take(&SimulationOptions::new(Surface::ALL[0]));
    let (mut correlation, mut bytes) = (0.0, 0);
    for bands in ["3", "9", "19", "30", "64"] {
        let kept = keep(&take, &[("bands", bands)]);
        assert!(correlation_of(&kept.quality) > correlation, "{bands}");
        assert!(kept.bytes > bytes, "{bands}");
        (correlation, bytes) = (correlation_of(&kept.quality), kept.bytes);
    }
    for (step_db, most_db) in [("0.2", 0.12), ("3", 1.55)] {
        let kept = keep(&take, &[("bands", "9"), ("step_db", step_db)]);
        assert_eq!(kept.parameters[10], step_db.parse::<f64>().unwrap());
        assert!(nine_band_db(&kept.quality) <= most_db, "{step_db}");
    }
}
