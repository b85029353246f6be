//! Streams of shaped noise.

use super::*;

fn noise(seed: u64) -> ShapedNoise {
    falling(seed, 200.0)
}

fn falling(seed: u64, scale_hz: f64) -> ShapedNoise {
    started(seed, |_, f| libm::exp(-f / scale_hz))
}

fn started(seed: u64, magnitude: impl Fn(usize, f64) -> f64) -> ShapedNoise {
    let mut noise = ShapedNoise::new(2_500.0, Band::TACTILE, seed);
    noise.start(magnitude);
    noise
}

fn rendered(mut noise: ShapedNoise, len: usize) -> Vec<f32> {
    let mut out = alloc::vec![0.0; len];
    noise.render(&mut out);
    out
}

#[test]
fn power_is_one_and_stationary() {
    let mut noise = noise(3);
    let mut out = alloc::vec![0.0f32; 2_500_000];
    noise.render(&mut out);
    let power = |phase: usize| {
        let part = out.iter().skip(phase).step_by(500);
        let n = part.clone().count() as f64;
        part.map(|x| f64::from(*x).powi(2)).sum::<f64>() / n
    };
    // Each position in the hop has 5,000 independent samples, so the standard error is 2 %.
    for phase in [0, 125, 250, 499] {
        assert!((power(phase) - 1.0).abs() < 0.1, "{phase}: {}", power(phase));
    }
    // The power is above 1, because the bins of the band miss some power at its lower edge.
    let total = out.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / out.len() as f64;
    assert!((1.0..1.03).contains(&total), "{total}");
}

/// This holds at any position in a hop, before and after a change of the spectrum.
#[test]
fn a_frame_made_early_is_the_same_frame() {
    let hop = noise(0).frames.hop;
    let played = |prepare_at: usize, retunes: &[usize]| {
        let mut noise = noise(11);
        noise.prepare_at = prepare_at;
        let mut out = alloc::vec![0.0; 4 * hop];
        for (n, block) in out.chunks_mut(64).enumerate() {
            if retunes.contains(&n) {
                noise.retune(|_, f| libm::exp(-f / (50.0 + n as f64)));
            }
            noise.render(block);
        }
        out
    };
    let blocks = hop / 64;
    for retunes in [&[][..], &[1], &[blocks - 2], &[blocks / 2, blocks + 1], &[2, 4, 5, 3 * blocks]]
    {
        let late = played(usize::MAX, retunes);
        for prepare_at in [0, 100, hop / 2, hop - 30] {
            assert_eq!(played(prepare_at, retunes), late, "{prepare_at} {retunes:?}");
        }
    }
}

/// The result does not depend on the block sizes.
#[test]
fn a_retune_fades_to_the_voice_of_the_new_spectrum() {
    let (hop, fade, overlap) = {
        let noise = noise(5);
        let frames = &noise.frames;
        (frames.hop, frames.fade_len, frames.rise.len())
    };
    let len = 3 * hop;
    let [first, second, third] =
        [200.0, 50.0, 400.0].map(|scale_hz| rendered(falling(5, scale_hz), len));
    // The retunes are inside the overlap of two frames, after the overlap, and too close to the
    // next frame.
    for at in [10, overlap - 3, overlap + 50, hop - 5, hop + 7] {
        let begun = if at < hop && at + fade > hop { hop } else { at };
        let mut voice = falling(5, 200.0);
        let mut out = alloc::vec![0.0f32; len];
        out[..at].chunks_mut(7).for_each(|part| voice.render(part));
        voice.retune(|_, f| libm::exp(-f / 50.0));
        voice.render(&mut out[at..begun + 3]);
        // This change has to wait for the end of the other one.
        voice.retune(|_, f| libm::exp(-f / 400.0));
        voice.render(&mut out[begun + 3..]);
        for (n, y) in out.iter().enumerate() {
            let part = |from: usize| ((n + 1).saturating_sub(from) as f32 / fade as f32).min(1.0);
            let mixed = first[n] + part(begun) * (second[n] - first[n]);
            let expected = mixed + part(begun + fade) * (third[n] - mixed);
            assert!((y - expected).abs() < 1e-5, "{at}: {n}: {y} {expected}");
        }
    }
}

#[test]
fn invalid_magnitudes_count_as_zero() {
    let with = |odd: f64| {
        let magnitude = move |i: usize, _| if i.is_multiple_of(3) { odd } else { 1.0 };
        rendered(started(1, magnitude), 1_000)
    };
    let without = with(0.0);
    for odd in [f64::NAN, f64::INFINITY, -1.0] {
        assert_eq!(with(odd), without);
    }
    assert_eq!(rendered(started(1, |_, _| 0.0), 1_000), [0.0; 1_000]);
}
