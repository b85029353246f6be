//! The output of a voice: silence, gain, limiter and envelope.

use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use htex_play::envelope::MOST_BANDS;
use htex_play::{Error, Motion, Texture, Voice, VoiceOptions};

fn asset() -> Texture {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../examples/scenes/vinyl.htex");
    Texture::open(path).unwrap()
}

/// Renders blocks of different lengths and returns all samples. Before some blocks the finger
/// lifts, or its reading fails.
fn played(
    voice: &mut Voice,
    lengths: impl Iterator<Item = usize>,
    mut after: impl FnMut(&mut Voice),
) -> Vec<f32> {
    let (mut all, mut from) = (vec![0.0; 60_000], 0);
    let mut motions = [
        (0, 80.0),
        (7_000, 0.0),
        (21_000, 200.0),
        (29_000, 5_000.0),
        (41_000, 60.0),
        (50_000, 0.0),
    ]
    .into_iter()
    .peekable();
    for length in lengths {
        if let Some((_, speed_mm_s)) = motions.next_if(|(at, _)| *at == from) {
            voice.set_motion(Motion::new(speed_mm_s, 0.4)).unwrap();
        }
        let to = motions.peek().map_or(all.len(), |(at, _)| *at).min(from + length);
        voice.render(&mut all[from..to]).unwrap();
        after(voice);
        from = to;
        if from == all.len() {
            break;
        }
    }
    all
}

/// Block lengths from 1 to 999.
fn random_lengths() -> impl Iterator<Item = usize> {
    std::iter::successors(Some(1u32), |x| {
        Some(x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223))
    })
    .map(|x| 1 + (x >> 16) as usize % 999)
}

fn options() -> VoiceOptions {
    VoiceOptions::default().with_gain(1.5).with_limit(0.02)
}

#[test]
fn samples_do_not_depend_on_the_lengths_of_blocks() {
    let once = played(&mut asset().voice(&options()).unwrap(), [60_000; 10].into_iter(), |_| ());
    let often = played(&mut asset().voice(&options()).unwrap(), random_lengths(), |_| ());
    assert_eq!(once, often);
}

#[test]
fn a_limit_is_kept_and_changes_nothing_below() {
    let free =
        played(&mut asset().voice(&options().with_limit(None)).unwrap(), random_lengths(), |_| ());
    let peak = free.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
    let above = options().with_limit(f64::from(peak));
    assert_eq!(played(&mut asset().voice(&above).unwrap(), random_lengths(), |_| ()), free);
    let below = options().with_limit(f64::from(0.5 * peak));
    let limited = played(&mut asset().voice(&below).unwrap(), random_lengths(), |_| ());
    let most = limited.iter().fold(0.0f32, |most, x| most.max(x.abs()));
    assert_eq!(most, 0.5 * peak);
    // It is a gain, not a clipper: signs and small samples keep their shape.
    assert!(limited.iter().zip(&free).all(|(l, f)| l.abs() <= f.abs() && l * f >= 0.0));
}

/// A voice falls silent 20 ms after the finger stops, and then takes hardly any time.
#[test]
fn a_resting_voice_is_silent_and_takes_hardly_any_time() {
    let mut voice = asset().voice(&VoiceOptions::default()).unwrap();
    let mut block = [0.0f32; 400];
    voice.render(&mut block).unwrap();
    voice.set_motion(Motion::new(0.0, 0.4)).unwrap();
    assert!(!voice.is_silent());
    voice.render(&mut block).unwrap();
    assert!(voice.is_silent() && block[398] != 0.0);
    voice.render(&mut block).unwrap();
    assert_eq!(block, [0.0; 400]);
    let mut block = [1.0f32; 64];
    let mut least = Duration::MAX;
    for _ in 0..20 {
        let start = Instant::now();
        for _ in 0..1_000 {
            voice.render(std::hint::black_box(&mut block)).unwrap();
        }
        least = least.min(start.elapsed());
    }
    let ns = least.as_secs_f64() * 1e9 / 64_000.0;
    println!("{ns:.3} ns a sample at rest, in blocks of 64");
    assert!(ns < if cfg!(debug_assertions) { 1.0 } else { 0.2 }, "{ns} ns");
    voice.set_motion(Motion::new(80.0, 0.4)).unwrap();
    voice.render(&mut block).unwrap();
    assert!(!voice.is_silent() && block[1] != 0.0);
}

#[test]
fn adding_multiplies_and_adds() {
    let (mut one, mut two) =
        (asset().voice(&options()).unwrap(), asset().voice(&options()).unwrap());
    let (mut alone, mut sum) = (vec![0.0f32; 1_000], vec![0.25f32; 1_000]);
    one.render(&mut alone).unwrap();
    two.render_add(&mut sum, -0.5).unwrap();
    let expected: Vec<f32> = alone.iter().map(|x| 0.25 - 0.5 * x).collect();
    assert_eq!(sum, expected);
    assert!(two.render_add(&mut sum, f32::NAN).is_err());
    assert_eq!(sum, expected);
}

#[test]
fn options_out_of_range_are_errors() {
    let refused = |options: VoiceOptions| asset().voice(&options).unwrap_err();
    let plain = VoiceOptions::default;
    for rate_hz in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1_999.0, 1e8] {
        assert!(matches!(refused(plain().with_rate_hz(rate_hz)), Error::Rate { .. }));
    }
    assert!(asset().voice(&plain().with_rate_hz(2_000.0)).is_ok());
    for options in [
        plain().with_gain(-1.0),
        plain().with_gain(f64::MAX),
        plain().with_limit(0.0),
        plain().with_envelope_bands(MOST_BANDS + 1),
    ] {
        assert!(matches!(refused(options), Error::OutOfRange { .. }));
    }
    let mut voice = asset().voice(&plain().with_envelope_bands(3)).unwrap();
    assert!(matches!(voice.envelope(&mut [0.0; 4]), Err(Error::Bands { given: 4, there: 3 })));
    let mut without = asset().voice(&plain()).unwrap();
    assert!(matches!(without.envelope(&mut []), Err(Error::Bands { .. })));
}

/// The powers of the bins of one window of samples, computed from the definition.
fn powers(samples: &[f64]) -> Vec<f64> {
    let len = samples.len();
    let window: Vec<f64> =
        (0..len).map(|n| 0.5 - 0.5 * (TAU * n as f64 / len as f64).cos()).collect();
    let weight = len as f64 * window.iter().map(|w| w * w).sum::<f64>();
    let turn: Vec<(f64, f64)> = (0..len).map(|n| (TAU * n as f64 / len as f64).sin_cos()).collect();
    let windowed: Vec<f64> = samples.iter().zip(&window).map(|(x, w)| x * w).collect();
    (0..=len / 2)
        .map(|k| {
            let mut sum = (0.0, 0.0);
            for (n, x) in windowed.iter().enumerate() {
                let (sin, cos) = turn[k * n % len];
                sum = (sum.0 + x * cos, sum.1 + x * sin);
            }
            let sides = if k == 0 || k == len / 2 { 1.0 } else { 2.0 };
            sides * (sum.0 * sum.0 + sum.1 * sum.1) / weight
        })
        .collect()
}

/// The envelope of a voice whose finger lifts and whose readings fail equals the envelope computed
/// directly from its samples.
#[test]
fn the_envelope_is_that_of_the_samples() {
    const LEN: usize = 1_024;
    const BANDS: usize = 5;
    let mut voice = asset().voice(&options().with_envelope_bands(BANDS)).unwrap();
    let edges_hz = voice.envelope_edges_hz().to_vec();
    assert_eq!(edges_hz.len(), BANDS + 1);
    assert!((edges_hz[0] - 20.0).abs() < 1e-9 && (edges_hz[BANDS] - 1_000.0).abs() < 1e-9);
    let mut measured = Vec::new();
    let mut read = |voice: &mut Voice| {
        let mut bands = [0.0; BANDS];
        let envelope = voice.envelope(&mut bands).unwrap();
        measured.push((envelope, bands));
    };
    let samples = played(&mut voice, random_lengths(), &mut read);

    let padded: Vec<f64> =
        std::iter::repeat_n(0.0, LEN).chain(samples.iter().map(|x| f64::from(*x))).collect();
    let windows: Vec<Vec<f64>> = (1..=samples.len() / (LEN / 4))
        .map(|end| powers(&padded[end * LEN / 4..][..LEN]))
        .collect();
    let hz = |k: usize| k as f64 * 20_000.0 / LEN as f64;
    let near = |a: f64, b: f64, what: &str| {
        assert!((a - b).abs() <= 1e-9 + 1e-6 * b.abs(), "{what}: {a} and {b}")
    };
    let (mut from, mut expected_bands, mut expected_hz) = (0, [0.0; BANDS], 0.0);
    for (envelope, bands) in &measured {
        let to = from + envelope.frames as usize;
        let squares: f64 = samples[from..to].iter().map(|x| f64::from(*x).powi(2)).sum();
        let level_rms = match to - from {
            0 => 0.0,
            count => (squares / count as f64).sqrt(),
        };
        near(envelope.level_rms, level_rms, "level");
        let ended = &windows[from / (LEN / 4)..to / (LEN / 4)];
        if !ended.is_empty() {
            let mean =
                |k: usize| ended.iter().map(|powers| powers[k]).sum::<f64>() / ended.len() as f64;
            let mean: Vec<f64> = (0..=LEN / 2).map(mean).collect();
            expected_bands = [0.0; BANDS];
            for (k, power) in mean.iter().enumerate() {
                let band = edges_hz[1..BANDS].iter().filter(|edge| **edge <= hz(k)).count();
                expected_bands[band] += power;
            }
            let total: f64 = mean.iter().sum();
            let moment: f64 = mean.iter().enumerate().map(|(k, power)| hz(k) * power).sum();
            expected_hz = if total > 0.0 { moment / total } else { 0.0 };
        }
        for (band, expected) in bands.iter().zip(expected_bands) {
            near(*band, expected, "band");
        }
        near(envelope.centroid_hz, expected_hz, "centroid");
        from = to;
    }
    assert_eq!(from, samples.len());
    assert!(measured.iter().any(|(envelope, _)| envelope.level_rms == 0.0 && envelope.frames > 0));
    assert!(measured.len() > 50);
}

/// Over a long block the powers of the bands are what the asset states: the squared magnitudes,
/// which sum to the squared level.
#[test]
fn the_bands_of_a_long_block_are_those_of_the_asset() {
    let asset = asset();
    for model in ["ar", "mfcc", "sbeta"] {
        let options = VoiceOptions::default().with_envelope_bands(3);
        let representation = asset.representation(model).unwrap();
        let mut voice = representation.voice(&options).unwrap();
        voice.render(&mut vec![0.0; 600_000]).unwrap(); // 30 s
        let mut bands = [0.0; 3];
        let envelope = voice.envelope(&mut bands).unwrap();
        let level_rms = representation.level_rms(None).unwrap();
        let db = 10.0 * (bands.iter().sum::<f64>() / level_rms.powi(2)).log10();
        println!("{model}: {db:.3} dB, {:.1} Hz, {bands:?}", envelope.centroid_hz);
        assert!(db.abs() < 0.2, "{model}: {db} dB");
        let grid: Vec<f64> = (4..=200).map(|k| 5.0 * f64::from(k)).collect();
        let magnitude = representation.magnitude(None, &grid).unwrap();
        let total: f64 = magnitude.iter().map(|m| m * m).sum();
        let moment: f64 = magnitude.iter().zip(&grid).map(|(m, hz)| m * m * hz).sum();
        let centroid_hz = moment / total;
        let off = envelope.centroid_hz / centroid_hz - 1.0;
        assert!(off.abs() < 0.03, "{model}: {} and {centroid_hz} Hz", envelope.centroid_hz);
    }
}
