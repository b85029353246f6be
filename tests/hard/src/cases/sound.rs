//! Voices, oscillators and converters of rates at their limits.

use htex_dsp::biquad::{Biquad, Cascade};
use htex_dsp::noise::{GaussianNoise, Uniform};
use htex_dsp::peaks::{local_maxima, select_peaks};
use htex_dsp::resample::Resampler;
use htex_dsp::shaped_noise::ShapedNoise;
use htex_dsp::sine_bank::{Sine, SineBank};
use htex_dsp::warp::Warp;
use htex_host::{Band, LoadedModel, ModelVoice, Stream};

use crate::big::{Big, big};
use crate::seen::{fit, model, models, spectrum, told};
use crate::signals::{friction, noise, tone};
use crate::{Bound, Case, Section, failures, none, refused, within, worse};

pub(crate) const SECTION: Section = Section {
    title: "Sound",
    about: "Voices at all rates, oscillators, noise, filters and converters of rates.",
    cases: CASES,
};

const BAND: Band = Band::TACTILE;

/// Parameters fitted to friction and to white noise, as like to each other as they are not.
fn two_sets(model: &LoadedModel) -> [Vec<f64>; 2] {
    [friction(), noise()].map(|x| fit(model, &spectrum(&x)).unwrap().parameters)
}

/// The largest sample over the RMS of a second at a rate; NaN if a sample is subnormal.
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

/// The largest sample of a voice whose parameters change before each of so many.
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

/// What a voice says to parameters it cannot change to; it plays on.
fn retune_refused(name: &str, from: &[f64], to: &[f64]) -> String {
    let mut voice = model(name).voice(from, BAND, 2_000.0, 1).unwrap();
    let said = told(voice.retune(to));
    let mut out = [0.0f32; 500];
    match voice.render(&mut out) {
        Ok(()) if out.iter().any(|x| *x != 0.0) => said,
        other => format!("{said}; then {other:?}"),
    }
}

/// Decibels by which the level of a voice is off unit RMS after it was retuned from a tone to white
/// noise, and from there to the tone.
fn level_after_retune_db(model: &LoadedModel) -> f64 {
    let [tone, noise] =
        [tone(300.0), noise()].map(|x| fit(model, &spectrum(&x)).unwrap().parameters);
    let rate_hz = model.voice_rate_hz(&tone, BAND, 2_500.0).unwrap();
    let mut voice = model.voice(&tone, BAND, rate_hz, 1).unwrap();
    let mut off = 0.0;
    for set in [noise, tone] {
        // sPeak glides from set to set of as many lines: a second is plenty.
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

/// By how much the correlation of neighbouring samples, which tells spectra apart, is off a new voice's
/// after a voice was retuned from a tone to white noise, and from there to the tone.
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

/// Whether a voice plays the same samples in odd blocks as in one, before and after a change.
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

/// Largest error of oscillators between 0 Hz and Nyquist, some hours on, against 256 bits.
fn sine_error(rate_hz: f64, hours: f64) -> f64 {
    let frequencies = [0.0, 1e-9, 20.0, 333.3, 0.499_999 * rate_hz];
    let samples = (hours * 3600.0 * rate_hz) as u64;
    let mut worst = 0.0;
    for frequency_hz in frequencies {
        let sine = Sine {
            frequency_hz,
            amplitude: 1.0,
            phase_cycles: 0.25,
        };
        let mut bank = SineBank::new(rate_hz, 1, &[sine]);
        let mut block = vec![0.0f32; 65_536];
        let mut left = samples;
        while left > 0 {
            let run = left.min(block.len() as u64) as usize;
            bank.render(&mut block[..run]);
            left -= run as u64;
        }
        bank.render(&mut block[..1]);
        let cycles = big(frequency_hz) / big(rate_hz) * big(samples as f64) + big(0.25);
        let reference = (big(2.0) * Big::pi() * cycles).cos();
        worst = worse(worst, (big(block[0].into()) - reference).to_f64().abs());
    }
    worst
}

/// RMS of a sine after a conversion of rates, and of one that lies beyond what the new rate holds.
fn converted(from_hz: f64, to_hz: f64, hz: f64) -> f64 {
    let Some(mut resampler) = Resampler::new(from_hz, to_hz, 1_000.0) else {
        return f64::NAN;
    };
    let mut n = 0.0;
    let mut source = |block: &mut [f32]| {
        for x in block {
            *x = (std::f64::consts::TAU * hz * n / from_hz).sin() as f32;
            n += 1.0;
        }
    };
    let mut out = vec![0.0f32; 4_000];
    resampler.process(&mut out, &mut source);
    let settled = &out[2_000..];
    let power: f64 = settled.iter().map(|&x| f64::from(x).powi(2)).sum();
    (power / settled.len() as f64).sqrt()
}

const CASES: &[Case] = &[
    within(
        "rates of 100 Hz, 999 Hz, 2 kHz, 44.1 kHz, 1 MHz",
        "every model",
        "render",
        Bound(12.0, "× RMS", "finite, and samples"),
        || {
            let rates = [100.0, 999.0, 2_000.0, 44_100.0, 1e6];
            let peaks = models().into_iter().map(|m| {
                rates
                    .map(|rate| peak_at(&m, rate))
                    .into_iter()
                    .fold(0.0, worse)
            });
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
        "a filter of a higher order; one of another model rate",
        "AR",
        "retune",
        "InvalidArgument: a voice of order 1 at 2000 Hz keeps its model rate, and its order or a smaller one",
        || {
            let higher = retune_refused("ar", &[1.0, 0.5, 2_000.0], &[2.0, 0.5, 0.1, 2_000.0]);
            let faster = retune_refused("ar", &[1.0, 0.5, 2_000.0], &[1.0, 0.5, 4_000.0]);
            if higher == faster {
                higher
            } else {
                format!("{higher}; {faster}")
            }
        },
    ),
    within(
        "a filter of a lower order",
        "AR",
        "retune",
        none("done"),
        || {
            let said = retune_refused("ar", &[2.0, 0.5, 0.1, 2_000.0], &[1.0, 0.3, 2_000.0]);
            failures([said == "it was done"])
        },
    ),
    refused(
        "a cepstrum of other bands; one of another inverse",
        "MFCC",
        "retune",
        "InvalidArgument: a voice keeps its mel bank and inverse",
        || {
            let bands = retune_refused("mfcc", &[1.0, 1.0, 26.0, 0.0], &[1.0, 1.0, 20.0, 0.0]);
            let inverse = retune_refused("mfcc", &[1.0, 1.0, 26.0, 0.0], &[1.0, 1.0, 26.0, 2.0]);
            if bands == inverse {
                bands
            } else {
                format!("{bands}; {inverse}")
            }
        },
    ),
    refused(
        "three bands instead of two",
        "bands",
        "retune",
        "InvalidArgument: a voice keeps its number of bands",
        || retune_refused("bands", &[2.0, 0.0, 9.0, 1.0], &[3.0, 0.0, 9.0, 9.0, 1.0]),
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
            failures([
                first(0.0, 1) == first(0.0, 2),
                first(1.0, 1) != first(1.0, 2),
            ])
        },
    ),
    refused(
        "rates of 0, -1, NaN, 1e8 Hz",
        "every model",
        "voice",
        "InvalidArgument: rate",
        || {
            let said = models().into_iter().flat_map(|model| {
                let [set, _] = two_sets(&model);
                [0.0, -1.0, f64::NAN, 1e8]
                    .map(|rate| told(Stream::new(&model, &set, BAND, rate, 1)))
            });
            let all: Vec<String> = said.collect();
            let other = all
                .iter()
                .find(|text| !text.contains("InvalidArgument: rate"));
            other.unwrap_or(&all[0]).clone()
        },
    ),
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
                    let voice = told(model.voice(&set, band, 2_000.0, 1));
                    let magnitude = told(model.magnitude(&set, band, &[100.0]));
                    if voice == magnitude {
                        voice
                    } else {
                        format!("{voice}; {magnitude}")
                    }
                })
            });
            let all: Vec<String> = said.collect();
            let other = all
                .iter()
                .find(|text| !text.contains("InvalidArgument: band"));
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
                    told(model.voice(&set, band, 2_000.0, 1)),
                    told(model.magnitude(&set, band, &[22.0])),
                ]
            });
            let all: Vec<String> = said.collect();
            let other = all.iter().find(|text| !text.contains("InvalidParameters"));
            other.unwrap_or(&all[0]).clone()
        },
    ),
    within(
        "0, 1e-9, 20, 333.3 and 9999.98 Hz at 20 kHz, six minutes on",
        "sine bank",
        "render",
        Bound(1e-6, "of the amplitude", "256 bits"),
        || sine_error(20_000.0, 0.1),
    ),
    within(
        "sines at and above Nyquist, infinite",
        "sine bank",
        "render",
        none("silent"),
        || {
            failures([1_000.0, 1e9, f64::INFINITY, f64::NAN].map(|frequency_hz| {
                let sine = Sine {
                    frequency_hz,
                    amplitude: 1.0,
                    phase_cycles: 0.0,
                };
                let mut out = [1.0f32; 300];
                SineBank::new(2_000.0, 1, &[sine]).render(&mut out);
                out.iter().all(|x| *x == 0.0)
            }))
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
        "InvalidParameters: all amplitudes are zero",
        || {
            let none = told(model("speak").voice(&[0.0, 0.0, 0.0], BAND, 20_000.0, 1));
            let silent = told(model("speak").voice(&[1.0, 50.0, 1.0, 0.0, 0.0], BAND, 20_000.0, 1));
            if none == silent {
                none
            } else {
                format!("{none}; {silent}")
            }
        },
    ),
    refused(
        "two frequencies, one amplitude",
        "sPeak",
        "voice",
        "InvalidParameters: 2 frequencies and 1 amplitudes",
        || told(model("speak").voice(&[2.0, 50.0, 60.0, 1.0, 1.0, 0.0], BAND, 20_000.0, 1)),
    ),
    within(
        "flat, rising, falling, empty; a plateau on an edge; NaN",
        "peaks",
        "find and select",
        none("none found"),
        || {
            let rising: Vec<f64> = (0..9).map(f64::from).collect();
            let falling: Vec<f64> = rising.iter().rev().copied().collect();
            let edge = [1.0, 1.0, 0.5, 0.2, 0.2];
            let all: [&[f64]; 6] = [&[], &[1.0], &[1.0; 9], &rising, &falling, &edge];
            let found = all.iter().map(|m| local_maxima(m).is_empty());
            let grid: Vec<f64> = (1..=5).map(f64::from).collect();
            let nan = select_peaks(&grid, &[0.0, f64::NAN, 0.0, f64::NAN, 0.0], 5, 0.12).is_empty();
            failures(found.chain([nan]))
        },
    ),
    within(
        "plateaus of two and of three, between slopes",
        "peaks",
        "find",
        none("once each, at the middle, the lower of two"),
        || {
            let found = local_maxima(&[0.0, 1.0, 1.0, 0.5, 2.0, 2.0, 2.0, 1.0]);
            failures([found == [1, 5]])
        },
    ),
    within(
        "two equal peaks within a just-noticeable difference; three apart",
        "peaks",
        "select",
        none("the lower one; the strongest two"),
        || {
            let grid: Vec<f64> = (20..40).map(|i| 5.0 * f64::from(i)).collect();
            let mut m = vec![0.0; 20];
            (m[5], m[7]) = (1.0, 1.0);
            let near = select_peaks(&grid, &m, 10, 0.12);
            m[7] = 0.0;
            (m[11], m[17]) = (0.5, 0.7);
            let strongest = select_peaks(&grid, &m, 2, 0.12);
            failures([
                near.len() == 1 && near[0].frequency_hz == 125.0,
                strongest.len() == 2 && strongest[1].frequency_hz == 185.0,
            ])
        },
    ),
    within(
        "a curve that is NaN, infinite, negative, 0 all over; one that is so here and there",
        "shaped noise",
        "start, retune, render",
        none("silent; finite"),
        || {
            let curves: [fn(f64) -> f64; 5] = [
                |_| f64::NAN,
                |_| f64::INFINITY,
                |_| -1.0,
                |_| 0.0,
                |_| 1e-320,
            ];
            let play = |curve: &dyn Fn(f64) -> f64| {
                let mut noise = ShapedNoise::new(2_500.0, BAND, 1);
                noise.start(|_, f| curve(f));
                let mut out = vec![0.0f32; 2_000];
                noise.render(&mut out[..700]);
                noise.retune(|_, f| curve(f));
                noise.render(&mut out[700..]);
                out
            };
            let silent = curves.map(|curve| play(&curve).iter().all(|x| *x == 0.0));
            let holes = play(&|f| if f < 300.0 { f64::NAN } else { 1.0 });
            let sounds = holes.iter().all(|x| x.abs() < 12.0) && holes.iter().any(|x| *x != 0.0);
            failures(silent.into_iter().chain([sounds]))
        },
    ),
    within(
        "rates of 0, NaN, 1e12 Hz; a band above half the rate",
        "shaped noise",
        "start, render",
        none("finite"),
        || {
            failures([0.0, 20.0, 100.0, 1_999.0].map(|rate_hz| {
                let mut noise = ShapedNoise::new(rate_hz, BAND, 1);
                noise.start(|_, _| 1.0);
                let mut out = vec![0.0f32; 1_000];
                noise.render(&mut out);
                out.iter().all(|x| x.abs() < 12.0)
            }))
        },
    ),
    within(
        "a million numbers",
        "noise",
        "draw",
        none("in [0, 1); on the circle to 6e-7; Gaussian within 7"),
        || {
            let (mut uniform, mut gaussian) = (Uniform::new(u64::MAX), GaussianNoise::new(0));
            let (mut cos, mut sin) = (vec![0.0; 1_000_000], vec![0.0; 1_000_000]);
            let mut normal = vec![0.0; 1_000_000];
            uniform.fill_directions(&mut cos, &mut sin);
            gaussian.fill(&mut normal);
            let directions = cos.into_iter().zip(sin);
            failures(directions.zip(normal).map(|((cos, sin), x): (_, f32)| {
                let (cos, sin) = (f64::from(cos), f64::from(sin));
                (0.0..1.0).contains(&uniform.next_unit())
                    && (cos * cos + sin * sin - 1.0).abs() < 6e-7
                    && x.abs() < 7.0
            }))
        },
    ),
    within(
        "silence after an impulse",
        "filter sections",
        "ring out",
        none("never subnormal, exactly 0 in the end"),
        || {
            let ringing = Biquad {
                a1: -1.8,
                a2: 0.9,
                ..Biquad::IDENTITY
            };
            let mut cascade = Cascade::new(&[ringing; 3]);
            let mut block = vec![0.0; 60_000];
            block[0] = 1.0;
            cascade.process(&mut block);
            failures([
                !block.iter().any(|x| x.is_subnormal()),
                block[59_999] == 0.0,
            ])
        },
    ),
    within(
        "2 kHz to 20 kHz, 2 kHz to 1 MHz, 44.1 to 2 kHz, 2000.001 to 2000 Hz; a sine of 300 Hz",
        "resampler",
        "convert",
        Bound(0.01, "dB", "its level"),
        || {
            let pairs = [
                (2e3, 2e4),
                (2e3, 1e6),
                (44_100.0, 2e3),
                (2_000.001, 2e3),
                (2e3, 48_000.0),
            ];
            let off = pairs.map(|(from, to)| {
                // Whole periods of the sine in 2000 samples, or nearly.
                let hz = if to == 1e6 { 500.0 } else { 300.0 };
                20.0 * (converted(from, to, hz) * 2f64.sqrt()).log10().abs()
            });
            off.into_iter().fold(0.0, worse)
        },
    ),
    within(
        "20 kHz to 1 kHz; a sine of 900 Hz",
        "resampler",
        "convert",
        Bound(1e-3, "of the amplitude", "silence"),
        || converted(2e4, 1e3, 900.0),
    ),
    within(
        "the same rates, 0, negative, NaN, more than 10,000 apart",
        "resampler",
        "make",
        none("none made"),
        || {
            let bad = [
                (2e3, 2e3),
                (2e3, 2_000.000_1),
                (0.0, 2e3),
                (2e3, -1.0),
                (f64::NAN, 2e3),
                (2e3, f64::INFINITY),
                (1.0, 1e6),
                (1e6, 1.0),
            ];
            failures(bad.map(|(from, to)| Resampler::new(from, to, 1_000.0).is_none()))
        },
    ),
    within(
        "ratios of 0, 1e-9, 1, 1000, in turns",
        "reading at a changing ratio",
        "render",
        none("finite, no larger than 1.2 times the source"),
        || {
            let mut warp = Warp::new();
            let mut n = 0.0;
            let mut source = |block: &mut [f32]| {
                for x in block {
                    *x = (0.05 * std::f64::consts::TAU * n).sin() as f32;
                    n += 1.0;
                }
            };
            failures((0..2_000).map(|i| {
                let ratio = [0.0, 1e-9, 1.0, 1_000.0, 0.3][i % 5];
                let mut out = [0.0f32; 3];
                warp.process(ratio, &mut out, &mut source);
                out.iter().all(|x| x.abs() < 1.2)
            }))
        },
    ),
];
