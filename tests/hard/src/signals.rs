//! Hard recordings, as samples.

use htex_dsp::noise::GaussianNoise;

/// Rate of the samples, hertz.
pub const RATE_HZ: f64 = 20_000.0;
/// Samples in a recording: ten segments of a fifth of a second.
pub const SAMPLES: usize = 40_000;

/// Samples of a function of time in seconds.
pub(crate) fn of_time(f: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..SAMPLES).map(|i| f(i as f64 / RATE_HZ)).collect()
}

/// A 1 N tone.
pub fn tone(hz: f64) -> Vec<f64> {
    // The phase is first reduced in whole numbers, so that the tone has the precision of f64.
    of_time(|t| {
        let cycles = hz * t;
        (std::f64::consts::TAU * (cycles - cycles.floor()) + 0.3).sin()
    })
}

/// White noise with 1 N.
pub fn noise() -> Vec<f64> {
    let mut noise = GaussianNoise::new(7);
    let mut samples = vec![0.0; SAMPLES];
    samples.fill_with(|| noise.next_sample().into());
    samples
}

/// Noise with most of its power at low frequencies, like friction, newtons.
pub fn friction() -> Vec<f64> {
    let mut low = 0.0;
    let coloured = |x: f64| {
        low = 0.97 * low + 0.1 * x;
        0.05 * (low + 0.05 * x)
    };
    noise().into_iter().map(coloured).collect()
}

/// The sum of two signals.
pub fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

/// A signal multiplied by a number.
pub fn scaled(a: &[f64], gain: f64) -> Vec<f64> {
    a.iter().map(|x| gain * x).collect()
}

/// A single sample of 1 N in the middle of a segment.
pub fn impulse() -> Vec<f64> {
    let mut x = vec![0.0; SAMPLES];
    x[18_000] = 1.0;
    x
}

/// A signal rounded to multiples of a step.
pub fn quantised(a: &[f64], step: f64) -> Vec<f64> {
    a.iter().map(|x| (x / step).round() * step).collect()
}

/// Two tones, the second 120 dB below the first.
pub(crate) fn far_apart() -> Vec<f64> {
    sum(&tone(50.0), &scaled(&tone(700.0), 1e-6))
}
