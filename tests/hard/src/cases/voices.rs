//! Voices of the models.

use htex_host::{Band, LoadedModel, ModelVoice, Stream};

use crate::seen::{fit, model, models, outcome_text, spectrum};
use crate::signals::{friction, noise, tone};
use crate::{Bound, Case, Section, failures, none, refused, within, worse};

pub(crate) const SECTION: Section = Section {
    title: "Voices",
    about: "Voices of all models: rates, bands, blocks, and changes while they play.",
    cases: CASES,
};

const BAND: Band = Band::TACTILE;

/// Parameters fitted to friction and to white noise, two very different spectra.
fn two_sets(model: &LoadedModel) -> [Vec<f64>; 2] {
    [friction(), noise()].map(|x| fit(model, &spectrum(&x)).unwrap().parameters)
}

/// The largest sample, relative to the RMS, of a second at a rate; NaN if a sample is subnormal.
fn peak_at(model: &LoadedModel, rate_hz: f64) -> f64 {
    let [set, _] = two_sets(model);
    let mut out = vec![0.0f32; (rate_hz as usize).clamp(100, 20_000)];
    let played = Stream::new(model, &set, BAND, rate_hz, 1).and_then(|mut s| s.render(&mut out));
    if let Err(error) = played {
        println!("{} at {rate_hz} Hz: {error}", model.short_name());
        return f64::NAN;
    }
    let subnormal = out.iter().any(|x| x.is_subnormal());
    let peak = out.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
    if subnormal { f64::NAN } else { peak.into() }
}

/// The largest sample of a voice whose parameters change before every block.
fn restless(model: &LoadedModel) -> f64 {
    let sets = two_sets(model);
    let mut stream = Stream::new(model, &sets[0], BAND, 20_000.0, 1).unwrap();
    let mut peak = 0.0;
    for i in 0..3_000 {
        let mut sample = [0.0f32];
        stream.retune(&sets[i % 2]).unwrap();
        stream.render(&mut sample).unwrap();
        peak = worse(peak, f64::from(sample[0].abs()));
    }
    peak
}

/// How a voice refuses parameters that it cannot change to. It must play on.
fn retune_refused(name: &str, from: &[f64], to: &[f64]) -> String {
    let mut voice = model(name).voice(from, BAND, 2_000.0, 1).unwrap();
    let said = outcome_text(voice.retune(to));
    let mut out = [0.0f32; 500];
    match voice.render(&mut out) {
        Ok(()) if out.iter().any(|x| *x != 0.0) => said,
        other => format!("{said}; then {other:?}"),
    }
}

/// How many decibels the level of a voice is off unit RMS after it was retuned from a tone to white
/// noise, and from there to the tone.
fn level_after_retune_db(model: &LoadedModel) -> f64 {
    let [tone, noise] =
        [tone(300.0), noise()].map(|x| fit(model, &spectrum(&x)).unwrap().parameters);
    let rate_hz = model.voice_rate_hz(&tone, BAND, 2_500.0).unwrap();
    let mut voice = model.voice(&tone, BAND, rate_hz, 1).unwrap();
    let mut off = 0.0;
    for set in [noise, tone] {
        // sPeak glides between sets with the same number of lines, for which a second is plenty.
        let mut out = vec![0.0f32; (41.0 * rate_hz) as usize];
        if let Err(error) = voice.retune(&set) {
            println!("{}: {error}", model.short_name());
            return f64::NAN;
        }
        voice.render(&mut out).unwrap();
        let later = &out[rate_hz as usize..];
        let power: f64 = later.iter().map(|&x| f64::from(x).powi(2)).sum();
        off = worse(off, (10.0 * (power / later.len() as f64).log10()).abs());
    }
    off
}

/// How much the correlation of neighbouring samples, which distinguishes spectra, differs from a
/// new voice's after a voice was retuned from a tone to white noise, and from there to the tone.
fn unlike_a_new_voice(model: &LoadedModel) -> f64 {
    let [tone, noise] =
        [tone(300.0), noise()].map(|x| fit(model, &spectrum(&x)).unwrap().parameters);
    let rate_hz = model.voice_rate_hz(&tone, BAND, 2_500.0).unwrap();
    let neighbours = |voice: &mut ModelVoice| {
        let mut out = vec![0.0f32; (21.0 * rate_hz) as usize];
        voice.render(&mut out).unwrap();
        let later = &out[rate_hz as usize..];
        let product = |by: usize| -> f64 {
            let pairs = later.iter().zip(&later[by..]);
            pairs.map(|(x, y)| f64::from(x * y)).sum()
        };
        product(1) / product(0)
    };
    let mut voice = model.voice(&tone, BAND, rate_hz, 1).unwrap();
    let off = [noise, tone].map(|set| {
        voice.retune(&set).unwrap();
        let mut new = model.voice(&set, BAND, rate_hz, 2).unwrap();
        (neighbours(&mut voice) - neighbours(&mut new)).abs()
    });
    worse(off[0], off[1])
}

/// Whether a voice plays the same samples in odd blocks as in one block, before and after a change.
fn same_in_blocks(model: &LoadedModel) -> bool {
    let [set, other] = two_sets(model);
    let rate_hz = model.voice_rate_hz(&set, BAND, 2_500.0).unwrap();
    let play = |lengths: &[usize]| {
        let mut voice = model.voice(&set, BAND, rate_hz, 1).unwrap();
        let mut out = [f32::NAN; 3_000];
        for mut rest in out.chunks_mut(1_001) {
            for &length in lengths.iter().cycle() {
                let (block, later) = rest.split_at_mut(length.min(rest.len()));
                voice.render(block).unwrap();
                rest = later;
                if rest.is_empty() {
                    break;
                }
            }
            voice.retune(&other).unwrap();
        }
        out
    };
    play(&[3_000]) == play(&[1, 2, 3, 5, 7, 11])
}

const CASES: &[Case] = &[
    within(
        "rates of 100 Hz, 999 Hz, 2 kHz, 44.1 kHz, 1 MHz",
        "every model",
        "render",
        Bound(12.0, "× RMS", "finite, and samples"),
        || {
            let rates = [100.0, 999.0, 2_000.0, 44_100.0, 1e6];
            let peaks = models()
                .into_iter()
                .map(|m| rates.map(|rate| peak_at(&m, rate)).into_iter().fold(0.0, worse));
            peaks.fold(0.0, worse)
        },
    ),
    within(
        "friction and white noise in turns, before every sample",
        "every model",
        "retune",
        Bound(12.0, "× RMS", "finite, and samples"),
        || models().iter().map(restless).fold(0.0, worse),
    ),
    within(
        "from a tone to white noise, and back",
        "every model",
        "retune, and 40 s later",
        Bound(1.5, "dB", "the level"),
        || models().iter().map(level_after_retune_db).fold(0.0, worse),
    ),
    within(
        "blocks of 1, 2, 3, 5, 7, 11 samples",
        "every model",
        "render, retune, render",
        none("the samples of one block"),
        || failures(models().iter().map(same_in_blocks)),
    ),
    within(
        "from a tone to white noise, and back",
        "every model",
        "retune, and 20 s later",
        Bound(0.05, "correlation of neighbours", "a new voice's"),
        || models().iter().map(unlike_a_new_voice).fold(0.0, worse),
    ),
    refused(
        "a filter of another model rate",
        "AR",
        "retune",
        "InvalidArgument: a voice at 2000 Hz accepts filters of this rate only",
        || retune_refused("ar", &[1.0, 0.5, 2_000.0], &[1.0, 0.5, 4_000.0]),
    ),
    within(
        "filters of a lower order, of a higher one, and of order 64",
        "AR",
        "retune",
        none("done"),
        || {
            let two: &[f64] = &[2.0, 0.5, 0.1, 2_000.0];
            let most: Vec<f64> = [64.0].into_iter().chain([0.01; 64]).chain([2_000.0]).collect();
            let orders = [[two, &[1.0, 0.3, 2_000.0]], [&[1.0, 0.3, 2_000.0], two], [two, &most]];
            failures(orders.map(|[from, to]| retune_refused("ar", from, to) == "it was done"))
        },
    ),
    refused(
        "a cepstrum of other bands; one of another inverse",
        "MFCC",
        "retune",
        "InvalidArgument: a voice cannot change its mel bank or its inverse",
        || {
            let bands = retune_refused("mfcc", &[1.0, 1.0, 26.0, 0.0], &[1.0, 1.0, 20.0, 0.0]);
            let inverse = retune_refused("mfcc", &[1.0, 1.0, 26.0, 0.0], &[1.0, 1.0, 26.0, 2.0]);
            if bands == inverse { bands } else { format!("{bands}; {inverse}") }
        },
    ),
    refused(
        "three bands instead of two",
        "bands",
        "retune",
        "InvalidArgument: a voice cannot change its bands",
        || retune_refused("bands", &[2.0, 0.0, 9.0, 1.0, 0.0], &[3.0, 0.0, 9.0, 9.0, 1.0, 0.0]),
    ),
    within(
        "phases at their crests, and by seed",
        "sPeak",
        "render with two seeds",
        none("the same from crests, not the same by seed"),
        || {
            let first = |random: f64, seed: u64| {
                let set = [2.0, 50.0, 75.0, 2.0, 1.0, 1.0, random];
                let mut out = [0.0f32; 64];
                let voice = model("speak").voice(&set, BAND, 20_000.0, seed);
                voice.unwrap().render(&mut out).unwrap();
                out
            };
            failures([first(0.0, 1) == first(0.0, 2), first(1.0, 1) != first(1.0, 2)])
        },
    ),
    refused("rates of 0, -1, NaN, 1e8 Hz", "every model", "voice", "InvalidArgument: rate", || {
        let said = models().into_iter().flat_map(|model| {
            let [set, _] = two_sets(&model);
            [0.0, -1.0, f64::NAN, 1e8]
                .map(|rate| outcome_text(Stream::new(&model, &set, BAND, rate, 1)))
        });
        let all: Vec<String> = said.collect();
        let other = all.iter().find(|text| !text.contains("InvalidArgument: rate"));
        other.unwrap_or(&all[0]).clone()
    }),
    refused(
        "a band that ends before it begins, is NaN, begins at 0",
        "every model",
        "voice, magnitude",
        "InvalidArgument: band",
        || {
            let bands = [
                (1_000.0, 20.0),
                (f64::NAN, 1_000.0),
                (20.0, f64::NAN),
                (0.0, 1_000.0),
                (20.0, 1e9),
            ];
            let said = models().into_iter().flat_map(|model| {
                let [set, _] = two_sets(&model);
                bands.map(|edges| {
                    let band = Band::from(edges);
                    let voice = outcome_text(model.voice(&set, band, 2_000.0, 1));
                    let magnitude = outcome_text(model.magnitude(&set, band, &[100.0]));
                    if voice == magnitude { voice } else { format!("{voice}; {magnitude}") }
                })
            });
            let all: Vec<String> = said.collect();
            let other = all.iter().find(|text| !text.contains("InvalidArgument: band"));
            other.unwrap_or(&all[0]).clone()
        },
    ),
    refused(
        "a band of 21 to 24 Hz, between two bins",
        "every model but sPeak",
        "voice, magnitude",
        "InvalidParameters",
        || {
            let band = Band::from((21.0, 24.0));
            let of_bins = models().into_iter().filter(|m| m.short_name() != "speak");
            let said = of_bins.flat_map(|model| {
                let [set, _] = two_sets(&model);
                [
                    outcome_text(model.voice(&set, band, 2_000.0, 1)),
                    outcome_text(model.magnitude(&set, band, &[22.0])),
                ]
            });
            let all: Vec<String> = said.collect();
            let other = all.iter().find(|text| !text.contains("InvalidParameters"));
            other.unwrap_or(&all[0]).clone()
        },
    ),
    within(
        "64 sinusoids of one frequency, at their crests",
        "sPeak",
        "render",
        Bound(1e-5, "of 64 crests", "the sum"),
        || {
            let count = [64.0];
            let set = [&count[..], &[100.0; 64], &count[..], &[0.125; 64], &[0.0]].concat();
            let mut voice = model("speak").voice(&set, BAND, 20_000.0, 1).unwrap();
            let mut out = [0.0f32; 1];
            voice.render(&mut out).unwrap();
            // 64 · a / sqrt(64 a² / 2).
            (f64::from(out[0]) / 128f64.sqrt() - 1.0).abs()
        },
    ),
    refused(
        "sinusoids without amplitude; none",
        "sPeak",
        "voice",
        "InvalidParameters: no line in the band 20 to 1000 Hz has an amplitude above zero",
        || {
            let none = outcome_text(model("speak").voice(&[0.0, 0.0, 0.0], BAND, 20_000.0, 1));
            let silent =
                outcome_text(model("speak").voice(&[1.0, 50.0, 1.0, 0.0, 0.0], BAND, 20_000.0, 1));
            if none == silent { none } else { format!("{none}; {silent}") }
        },
    ),
    refused(
        "two frequencies, one amplitude",
        "sPeak",
        "voice",
        "InvalidParameters: 2 frequencies and 1 amplitudes",
        || outcome_text(model("speak").voice(&[2.0, 50.0, 60.0, 1.0, 1.0, 0.0], BAND, 20_000.0, 1)),
    ),
];
