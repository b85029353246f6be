//! The phase of a sinusoid after a day.

use htex_dsp::sine_bank::{Sine, SineBank};
use num_rational::BigRational;
use num_traits::ToPrimitive;

use crate::exact::exact;

/// Phase error of an oscillator after a number of samples, compared with exact arithmetic, cycles.
/// The phase is read at two samples a quarter of a cycle of the oscillator's own frequency apart:
/// from the amplitudes of sine and cosine that best fit a stretch of samples.
///
/// `frequency_hz` must be well between 0 and half of `rate_hz`.
pub fn phase_error_cycles(frequency_hz: f64, rate_hz: f64, samples: u64) -> f64 {
    let sine = Sine { frequency_hz, amplitude: 1.0, phase_cycles: 0.0 };
    let mut bank = SineBank::new(rate_hz, 1, &[sine]);
    let mut block = vec![0.0f32; super::BLOCK];
    let mut left = samples;
    while left > 0 {
        let run = left.min(block.len() as u64) as usize;
        bank.render(&mut block[..run]);
        left -= run as u64;
    }
    bank.render(&mut block);
    let expected = cycles(frequency_hz, rate_hz, samples);
    let off = phase_of(&block, frequency_hz / rate_hz) - expected;
    (off - off.round()).abs()
}

/// The fraction of a cycle after a number of samples, rounded only at the end.
fn cycles(frequency_hz: f64, rate_hz: f64, samples: u64) -> f64 {
    let turned = exact(frequency_hz) / exact(rate_hz) * BigRational::from_integer(samples.into());
    turned.fract().to_f64().unwrap_or(f64::NAN)
}

/// The phase, in cycles, of the cosine that fits samples best (least squares).
fn phase_of(samples: &[f32], turn: f64) -> f64 {
    let (mut cc, mut cs, mut ss, mut xc, mut xs) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (n, &x) in samples.iter().enumerate() {
        let (s, c) = (std::f64::consts::TAU * (turn * n as f64).fract()).sin_cos();
        cc += c * c;
        cs += c * s;
        ss += s * s;
        xc += f64::from(x) * c;
        xs += f64::from(x) * s;
    }
    // x = a cos + b sin; cos(w n + p) = cos p cos - sin p sin.
    let determinant = cc * ss - cs * cs;
    let a = (xc * ss - xs * cs) / determinant;
    let b = (xs * cc - xc * cs) / determinant;
    (-b).atan2(a) / std::f64::consts::TAU
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_phase_is_read_to_a_ten_millionth_of_a_cycle() {
        let turn = 0.012_345;
        let samples: Vec<f32> = (0..4_096)
            .map(|n| (std::f64::consts::TAU * (turn * f64::from(n) + 0.3)).cos() as f32)
            .collect();
        assert!((phase_of(&samples, turn) - 0.3).abs() < 1e-8);
        assert!((cycles(0.1, 2_000.0, 172_800_000) - 0.1f64 * 86_400.0 % 1.0).abs() < 1e-6);
    }
}
