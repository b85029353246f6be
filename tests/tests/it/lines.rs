//! sPeak's lines: their frequency, height and sound.

use crate::common::fit;
use htex_author::{Level, SpectrumRef, stored_fields, stored_level};
use htex_dsp::spectrum::SegmentAnalyzer;
use htex_format::round_parameters;
use htex_host::{Band, LoadedModel, Registry, Stream};

const BAND: Band = Band::TACTILE;
const RATE_HZ: f64 = 4_000.0;
/// 0.2 s.
const SEGMENT: usize = 800;
const PAPER: [(&str, &str); 2] = [("frequency", "bin"), ("phase", "zero")];

fn speak() -> LoadedModel {
    Registry::builtin().find("speak").unwrap().clone()
}

/// The spectrum of a 1 N sinusoid, averaged in power over three segments.
fn tone(hz: f64) -> Vec<f64> {
    let mut analyzer = SegmentAnalyzer::new(SEGMENT);
    let mut bins = analyzer.make_bins();
    let mut power = vec![0.0; BAND.bins()];
    let scale = analyzer.amplitude_scale();
    for segment in 0..3 {
        let time_s = |i: usize| (segment * SEGMENT + i) as f64 / RATE_HZ;
        let sample = |i: usize| (std::f64::consts::TAU * hz * time_s(i) + 0.7).sin();
        let samples: Vec<f64> = (0..SEGMENT).map(sample).collect();
        analyzer.analyze(&samples, &mut bins).unwrap();
        let in_band = &bins[BAND.first_bin()..];
        let add = |(power, x): (&mut f64, &htex_dsp::spectrum::Complex<f64>)| {
            *power += scale * scale * x.norm_sqr() / 3.0
        };
        power.iter_mut().zip(in_band).for_each(add);
    }
    power.iter().map(|p| p.sqrt()).collect()
}

/// The parameters as files store them, and the amplitudes in newtons.
struct Stored {
    parameters: Vec<f64>,
    frequency_hz: Vec<f64>,
    amplitude_n: Vec<f64>,
}

fn stored(magnitude: &[f64], options: &[(&str, &str)]) -> Stored {
    let (model, grid) = (speak(), BAND.grid_hz());
    let fit = fit(&model, BAND, magnitude, (RATE_HZ, options));
    let parameters = round_parameters(&stored_fields(model.descriptor()), &fit.parameters).unwrap();
    let reference = SpectrumRef { band: BAND, frequency_hz: &grid, magnitude };
    let level_n = stored_level(&model, &fit, &parameters, reference, Level::Recording).unwrap();
    let count = parameters[0] as usize;
    let amplitudes = &parameters[count + 2..2 * count + 2];
    Stored {
        frequency_hz: parameters[1..=count].to_vec(),
        amplitude_n: amplitudes.iter().map(|a| a * level_n).collect(),
        parameters,
    }
}

/// Largest differences between a sinusoid and its line: in hertz and in decibels.
fn worst(frequencies_hz: impl Iterator<Item = f64>, options: &[(&str, &str)]) -> (f64, f64) {
    frequencies_hz.fold((0.0, 0.0), |(hz, db), f| {
        let one = [&[("count", "1")], options].concat();
        let Stored { frequency_hz, amplitude_n, .. } = stored(&tone(f), &one);
        let off_db = 20.0 * amplitude_n[0].log10();
        (f64::max(hz, (frequency_hz[0] - f).abs()), f64::max(db, off_db.abs()))
    })
}

#[test]
fn a_tone_between_bins_is_stored_where_it_is() {
    let tones = || (120..=1_800).map(|i| 0.5 * f64::from(i));
    let (hz, db) = worst(tones(), &[]);
    println!("from 60 to 900 Hz: {hz:.3} Hz, {db:.4} dB");
    assert!(hz < 0.1 && db < 0.1);
    let (hz, _) = worst(tones(), &PAPER);
    assert_eq!(hz, 2.5);
    let edges = [20.0, 20.5, 21.0, 22.5, 997.5, 999.0, 1000.0];
    let (hz, _) = worst(edges.into_iter(), &[]);
    println!("at the edges of the band: {hz:.3} Hz");
    assert!(hz < 0.1);
}

#[test]
fn a_line_beyond_the_band_is_stored_at_its_edge() {
    for (tone_hz, edge_hz) in [(18.0, 20.0), (1_002.0, 1_000.0)] {
        assert_eq!(stored(&tone(tone_hz), &[]).frequency_hz, [edge_hz]);
    }
}

fn samples(parameters: &[f64], seed: u64) -> Vec<f32> {
    let mut stream = Stream::new(&speak(), parameters, BAND, RATE_HZ, seed).unwrap();
    let mut out = vec![0.0; 4 * SEGMENT];
    stream.render(&mut out).unwrap();
    out
}

/// Largest difference between two stretches, relative to their RMS.
fn difference(a: &[f32], b: &[f32]) -> f32 {
    let rms = (a.iter().map(|x| x * x).sum::<f32>() / a.len() as f32).sqrt();
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) / rms
}

/// A voice with the paper's options repeats after 0.2 s, with any seed.
#[test]
fn lines_sound_by_seed_and_do_not_repeat_after_a_segment() {
    let spectrum: Vec<f64> = [63.0, 141.5, 322.2, 704.9]
        .map(tone)
        .into_iter()
        .reduce(|sum, one| sum.iter().zip(&one).map(|(a, b)| a + b).collect())
        .unwrap();
    let usual = stored(&spectrum, &[("count", "4")]).parameters;
    let (one, other) = (samples(&usual, 1), samples(&usual, 2));
    assert!(difference(&one, &other) > 1.0);
    assert!(difference(&one[..SEGMENT], &one[SEGMENT..2 * SEGMENT]) > 0.5);
    let paper = stored(&spectrum, &[&[("count", "4")][..], &PAPER].concat()).parameters;
    let (one, other) = (samples(&paper, 1), samples(&paper, 2));
    assert_eq!(one, other);
    assert!(difference(&one[..SEGMENT], &one[SEGMENT..2 * SEGMENT]) < 1e-3);
}
