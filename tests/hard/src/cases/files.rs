//! From a recording to a file and back, at all rates and sizes.

use htex_author::recording::Recording;
use htex_author::{
    AssetRequest, AuthorError, Averaging, Exploration, FittedAsset, ModelRequest, SetupResponse,
    SpectrumOptions, Take, TextureSpectrum, fit_asset, segment_spectra,
};
use htex_host::Registry;

use crate::signals::{RATE_HZ, friction, noise, scaled};
use crate::{Bound, Case, Section, refused, within, worse};

pub(crate) const SECTION: Section = Section {
    title: "Recordings to files",
    about: "The whole way: a recording is cut into segments, every model is fitted to it, parameters are rounded \
            and written, the file is opened, and its voices are played. What is opened is what was stored, to the \
            bit.",
    cases: CASES,
};

const PIPELINE: &str = "pipeline";
const STORE: &str = "every model that fits";
const LIVES: &str = "fit, store, open, render";

fn recording(rate_hz: f64, axes: Vec<f64>) -> Recording {
    Recording::new("hard", rate_hz, vec![axes]).unwrap()
}

/// An asset with all models, fitted to a recording.
pub(crate) fn fitted(recordings: Vec<(Recording, f64)>) -> Result<FittedAsset, AuthorError> {
    let take = |(recording, speed_mm_s)| Take {
        recording,
        given: Exploration { speed_mm_s: Some(speed_mm_s), force_n: Some(0.4) },
    };
    let takes: Vec<Take> = recordings.into_iter().map(take).collect();
    let request = AssetRequest::new("hard")
        .with_models(Registry::builtin().models().iter().map(ModelRequest::new));
    fit_asset(&takes, &request)
}

/// The largest sample, relative to the level, over all voices in a recording's file. NaN if the
/// opened asset is not what was stored, or contains fewer than `models` models.
fn opened(recording: Recording, models: usize) -> f64 {
    let fitted = match fitted(vec![(recording, 80.0)]) {
        Ok(fitted) => fitted,
        Err(error) => {
            println!("{error}");
            return f64::NAN;
        }
    };
    let bytes = fitted.asset.to_bytes().unwrap();
    let back = htex_format::Asset::from_bytes(&bytes).unwrap();
    let same = back.parameters == fitted.asset.parameters;
    if !same || back.manifest.representations.len() < models {
        println!("skipped {:?}", fitted.skipped);
        return f64::NAN;
    }
    let asset = htex::Texture::from_bytes(&bytes).unwrap();
    let peaks = back.manifest.representations.iter().map(|r| {
        let level = r.at[0].level_rms;
        played(&asset, &r.model) / if level > 1e-30 { level } else { 1e-30 }
    });
    peaks.fold(0.0, worse)
}

/// The largest sample of a voice.
fn played(asset: &htex::Texture, model: &str) -> f64 {
    let mut out = vec![0.0f32; 4_000];
    let rendered = asset
        .representation(model)
        .and_then(|representation| representation.voice(&htex::VoiceOptions::default()))
        .and_then(|mut voice| voice.render(&mut out));
    match rendered {
        Ok(()) => out.iter().fold(0.0, |peak, x| worse(peak, f64::from(x.abs()))),
        Err(error) => {
            println!("{model}: {error}");
            f64::NAN
        }
    }
}

/// The number of models in the registry.
fn all() -> usize {
    Registry::builtin().models().len()
}

/// The text of an error, or the statement that there was none.
fn words<T>(result: Result<T, impl std::fmt::Display>) -> String {
    result.map_or_else(|error| error.to_string(), |_| "it was done".to_owned())
}

/// The texture spectrum through a setup with some response at 20, 100, 105, 110 and 1000 Hz.
fn through(magnitude: [f64; 5]) -> Result<TextureSpectrum, AuthorError> {
    let options = SpectrumOptions::default().with_response(SetupResponse {
        frequency_hz: vec![20.0, 100.0, 105.0, 110.0, 1_000.0],
        magnitude: magnitude.to_vec(),
        phase_rad: vec![0.0; 5],
    });
    let part = segment_spectra(&recording(RATE_HZ, friction()), &options)?;
    TextureSpectrum::average(&[part], Averaging::Magnitude)
}

const fn lives(input: &'static str, worst: fn() -> f64) -> Case {
    let bound = Bound(12.0, "× RMS", "same bits, and samples");
    within(input, STORE, LIVES, bound, worst)
}

const CASES: &[Case] = &[
    lives("rates of 100 Hz, 999 Hz", || {
        [100.0, 999.0]
            .map(|rate_hz| opened(recording(rate_hz, friction()), all() - 1))
            .into_iter()
            .fold(0.0, worse)
    }),
    lives("a rate of 1 MHz: one segment of 200,000 samples", || {
        let held: Vec<f64> = friction()[..5_000].iter().flat_map(|&x| [x; 50]).collect();
        opened(recording(1e6, held), all())
    }),
    lives("one segment and a sample", || {
        opened(recording(RATE_HZ, friction()[..4_001].to_vec()), all())
    }),
    lives("friction noise of 1e6 N", || {
        opened(recording(RATE_HZ, scaled(&friction(), 1e6)), all() - 1)
    }),
    refused("friction noise of 1e10 N", PIPELINE, "store", "LEVEL_INVALID", || {
        let loud = recording(RATE_HZ, scaled(&friction(), 1e10));
        let stored = fitted(vec![(loud, 80.0)]).unwrap().asset.to_bytes();
        stored.map_or_else(|error| format!("{error:?}"), |_| "it was done".to_owned())
    }),
    refused(
        "noise of 1e30 N",
        PIPELINE,
        "read",
        "no recording goes beyond 1000000000000; correct its unit",
        || words(Recording::new("hard", RATE_HZ, vec![scaled(&noise(), 1e30)])),
    ),
    lives("friction noise of 1e-30 N", || {
        opened(recording(RATE_HZ, scaled(&friction(), 1e-30)), all() - 1)
    }),
    refused("silence", PIPELINE, "fit", "no model could be fitted", || {
        words(fitted(vec![(recording(RATE_HZ, vec![0.0; 40_000]), 80.0)]))
    }),
    refused(
        "a sample that is NaN or infinite",
        PIPELINE,
        "read",
        "at sample 7 (counted from 0); repair or cut the recording there",
        || {
            let broken = |value| {
                let mut x = noise();
                x[7] = value;
                words(Recording::new("hard", RATE_HZ, vec![x]))
            };
            let all = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(broken);
            let other = all.iter().find(|text| !text.contains("at sample 7"));
            other.unwrap_or(&all[0]).clone()
        },
    ),
    refused(
        "a rate of 0, -1, NaN, 1e300, infinite Hz",
        PIPELINE,
        "read",
        "must be above 0 and at most 1000000000 Hz",
        || {
            let all = [0.0, -1.0, f64::NAN, 1e300, f64::INFINITY]
                .map(|rate_hz| words(Recording::new("hard", rate_hz, vec![vec![0.0; 9]])));
            let other = all.iter().find(|text| !text.contains("above 0 and at most"));
            other.unwrap_or(&all[0]).clone()
        },
    ),
    refused(
        "3,999 samples at 20 kHz",
        PIPELINE,
        "fit",
        "are less than one segment of 0.2 s (4000 samples)",
        || words(fitted(vec![(recording(RATE_HZ, friction()[..3_999].to_vec()), 80.0)])),
    ),
    refused(
        "a rate of 50 Hz: nothing above 25 Hz",
        PIPELINE,
        "fit",
        "it holds nothing above 25 Hz",
        || words(fitted(vec![(recording(50.0, friction()), 80.0)])),
    ),
    within(
        "a setup response of 0, or of 1e-9, at a bin of the band",
        PIPELINE,
        "compensate",
        Bound(40.1, "dB", "raised by what the maximum allows,"),
        || {
            let raised = |response: f64| {
                let faint = through([1.0, 1.0, response, 1.0, 1.0]);
                let (Ok(plain), Ok(faint)) = (through([1.0; 5]), faint) else {
                    return f64::NAN;
                };
                let pairs = plain.magnitude.iter().zip(&faint.magnitude);
                let raised = pairs.map(|(a, b)| 20.0 * (b / a).log10());
                raised.fold(0.0, worse)
            };
            worse(raised(0.0), raised(1e-9))
        },
    ),
    refused("a setup response of 0 all over", PIPELINE, "compensate", "setup response", || {
        words(through([0.0; 5]))
    }),
    refused(
        "a setup response of 1e-320 in a recording of 1 N",
        PIPELINE,
        "compensate",
        "setup response",
        || words(through([1e-320; 5])),
    ),
    refused("a setup response that is NaN", PIPELINE, "compensate", "setup response", || {
        words(through([1.0, 1.0, f64::NAN, 1.0, 1.0]))
    }),
];
