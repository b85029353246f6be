//! The building blocks of sound.

use htex_dsp::biquad::{Biquad, Cascade};
use htex_dsp::noise::GaussianNoise;
use htex_dsp::peaks::{local_maxima, select_peaks};
use htex_dsp::resample::Resampler;
use htex_dsp::shaped_noise::ShapedNoise;
use htex_dsp::sine_bank::{Sine, SineBank};
use htex_dsp::uniform::Uniform;
use htex_dsp::warp::Warp;
use htex_host::Band;

use crate::big::{Big, big};
use crate::{Bound, Case, Section, failures, none, within, worse};

pub(crate) const SECTION: Section = Section {
    title: "Sound",
    about: "Oscillators, peaks, noise, filters and converters of rates.",
    cases: CASES,
};

const BAND: Band = Band::TACTILE;

/// Largest error of oscillators between 0 Hz and Nyquist after some hours, compared with 256 bits.
fn sine_error(rate_hz: f64, hours: f64) -> f64 {
    let frequencies = [0.0, 1e-9, 20.0, 333.3, 0.499_999 * rate_hz];
    let samples = (hours * 3600.0 * rate_hz) as u64;
    let mut worst = 0.0;
    for frequency_hz in frequencies {
        let sine = Sine { frequency_hz, amplitude: 1.0, phase_cycles: 0.25 };
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

/// RMS of a sine after a rate conversion; for a sine beyond the new Nyquist frequency, what is
/// left.
fn converted(from_hz: f64, to_hz: f64, hz: f64) -> f64 {
    let Ok(Some(mut resampler)) = Resampler::new(from_hz, to_hz, 1_000.0) else {
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
        "0, 1e-9, 20, 333.3 and 9999.98 Hz at 20 kHz, six minutes on",
        "sine bank",
        "render",
        Bound(1e-6, "of the amplitude", "256 bits"),
        || sine_error(20_000.0, 0.1),
    ),
    within("sines at and above Nyquist, infinite", "sine bank", "render", none("silent"), || {
        failures([1_000.0, 1e9, f64::INFINITY, f64::NAN].map(|frequency_hz| {
            let sine = Sine { frequency_hz, amplitude: 1.0, phase_cycles: 0.0 };
            let mut out = [1.0f32; 300];
            SineBank::new(2_000.0, 1, &[sine]).render(&mut out);
            out.iter().all(|x| *x == 0.0)
        }))
    }),
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
            let curves: [fn(f64) -> f64; 5] =
                [|_| f64::NAN, |_| f64::INFINITY, |_| -1.0, |_| 0.0, |_| 1e-320];
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
            let ringing = Biquad { a1: -1.8, a2: 0.9, ..Biquad::IDENTITY };
            let mut cascade = Cascade::new(&[ringing; 3]);
            let mut block = vec![0.0; 60_000];
            block[0] = 1.0;
            cascade.process(&mut block);
            failures([!block.iter().any(|x| x.is_subnormal()), block[59_999] == 0.0])
        },
    ),
    within(
        "2 kHz to 20 kHz, 2 kHz to 1 MHz, 44.1 to 2 kHz, 2000.001 to 2000 Hz; a sine of 300 Hz",
        "resampler",
        "convert",
        Bound(0.01, "dB", "its level"),
        || {
            let pairs =
                [(2e3, 2e4), (2e3, 1e6), (44_100.0, 2e3), (2_000.001, 2e3), (2e3, 48_000.0)];
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
    within("the same rates, to a millihertz", "resampler", "make", none("none needed"), || {
        let same = [(2e3, 2e3), (2e3, 2_000.000_1)];
        failures(same.map(|(from, to)| matches!(Resampler::new(from, to, 1_000.0), Ok(None))))
    }),
    within(
        "rates of 0, negative, NaN, more than 10,000 apart",
        "resampler",
        "make",
        none("refused"),
        || {
            let bad = [
                (0.0, 2e3),
                (2e3, -1.0),
                (f64::NAN, 2e3),
                (2e3, f64::INFINITY),
                (1.0, 1e6),
                (1e6, 1.0),
            ];
            failures(bad.map(|(from, to)| Resampler::new(from, to, 1_000.0).is_err()))
        },
    ),
    within(
        "ratios of 0, 1e-9, 1, 1000, in turns",
        "reading at a changing ratio",
        "render",
        none("finite, no larger than 1.2 times the source"),
        || {
            let mut warp = Warp::new(0.5);
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
