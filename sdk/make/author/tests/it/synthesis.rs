//! Synthesised loops and filters, compared with the magnitudes that they are made from.

use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::{
    SpectrumOptions, TextureSpectrum, agreement, segment_spectra, spectrum_of_samples,
};
use htex_format::Measure;
use htex_host::{FitCondition, FitInput, LoadedModel, Registry, StillSound, Synthesis};

const RATE_HZ: f64 = 20_000.0;

fn spectrum() -> TextureSpectrum {
    let simulation = simulate(&SimulationOptions::new(Surface::CoarseFabric)).unwrap();
    let recording = simulation.to_recording("coarse-fabric").unwrap();
    let options = SpectrumOptions::default();
    let part = segment_spectra(&recording, &options).unwrap();
    TextureSpectrum::average(&[part], options.averaging).unwrap()
}

fn parameters(model: &LoadedModel, spectrum: &TextureSpectrum) -> Vec<f64> {
    let request = FitInput {
        band: spectrum.band,
        frequency_hz: &spectrum.frequency_hz,
        magnitude: &spectrum.magnitude,
        signal: &spectrum.signal,
        signal_rate_hz: spectrum.signal_rate_hz,
        options: &model.descriptor().default_options(),
        condition: FitCondition::default(),
    };
    model.fit(&request).unwrap().parameters
}

/// Renders 40 s and returns the nine-band RMS error against the spectrum, and the RMS.
fn played(model: &LoadedModel, spectrum: &TextureSpectrum, synthesis: &str) -> (f64, f64) {
    let parameters = parameters(model, spectrum);
    let synthesis: Synthesis = synthesis.parse().unwrap();
    let mut still =
        StillSound::new(synthesis, model, &parameters, spectrum.band, RATE_HZ, 1).unwrap().unwrap();
    let mut samples = vec![0.0; 800_000];
    samples.chunks_mut(333).for_each(|block| still.render(block));
    let power: f64 = samples.iter().map(|&x| f64::from(x) * f64::from(x)).sum();
    let shape = model.magnitude(&parameters, spectrum.band, &spectrum.frequency_hz).unwrap();
    let mut stated = spectrum.clone();
    stated.magnitude = shape;
    let found = spectrum_of_samples(&samples, RATE_HZ, 1.0, stated.as_ref()).unwrap();
    let error_db = agreement(stated.as_ref(), &found).get(Measure::NineBand).unwrap();
    (error_db, (power / samples.len() as f64).sqrt())
}

#[test]
fn a_filter_has_the_spectrum_within_three_quarters_of_a_decibel() {
    let (registry, spectrum) = (Registry::builtin(), spectrum());
    // The lowest band is 24 Hz wide, from 20 to 44 Hz, which 511 taps at 2500 Hz just resolve.
    // Other errors are chance.
    for name in ["ar", "mfcc", "sbeta"] {
        let model = registry.find(name).unwrap();
        let (error_db, rms) = played(model, &spectrum, "filter");
        assert!(error_db < 0.75, "{name}: {error_db} dB");
        assert!((rms - 1.0).abs() < 0.05, "{name}: {rms}");
        let (coarse_db, _) = played(model, &spectrum, "filter:63");
        assert!(coarse_db > error_db, "{name}: {coarse_db} dB");
    }
}

#[test]
fn a_loop_has_unit_power_and_the_spectrum_of_its_piece() {
    let (registry, spectrum) = (Registry::builtin(), spectrum());
    for model in registry.models() {
        let (error_db, rms) = played(model, &spectrum, "loop:10");
        assert!((rms - 1.0).abs() < 1e-3, "{}: {rms}", model.id());
        // Ten seconds of noise determine the energy of the lowest band within 0.3 dB. A set of
        // lines has empty bands, whose only energy comes from the seam.
        let is_noise = model.short_name() != "speak";
        assert!(!is_noise || error_db < 0.6, "{}: {error_db} dB", model.id());
    }
}

#[test]
fn what_cannot_be_made_is_refused() {
    let (registry, spectrum) = (Registry::builtin(), spectrum());
    let model = registry.find("sbeta").unwrap();
    let parameters = parameters(model, &spectrum);
    let make = |synthesis, rate_hz| {
        StillSound::new(synthesis, model, &parameters, spectrum.band, rate_hz, 1)
    };
    assert!(make(Synthesis::Streamed, RATE_HZ).unwrap().is_none());
    assert!(make(Synthesis::Loop { seconds: f64::NAN }, RATE_HZ).is_err());
    assert!(make(Synthesis::Loop { seconds: 60.0 }, 5e6).is_err());
    assert!(make(Synthesis::Filter { taps: 1_000_000 }, RATE_HZ).is_err());
    for text in ["streamed", "loop:0.5", "filter:255"] {
        let synthesis: Synthesis = text.parse().unwrap();
        assert_eq!(synthesis.to_string(), text);
    }
}
