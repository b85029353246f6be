//! Sines, cosines and tangents of angles up to [`LARGEST`], with the same bits as `libm`. `libm`'s
//! code for larger angles is left out, because it would add 2 kB to a WASM module.
//!
//! The series and the reduction of the angle come from FreeBSD's msun, as in `libm`: Copyright (C)
//! 1993 by Sun Microsystems, Inc. All rights reserved. Developed at SunPro, a Sun Microsystems,
//! Inc. business. Permission to use, copy, modify, and distribute this software is freely granted,
//! provided that this notice is preserved.

use crate::wide::{Work, wide};

/// Largest angle, radians, for which the results have the same bits as the results of `libm`. Above
/// this angle the error grows with the angle.
pub const LARGEST: f64 = 1_647_099.0;

/// Sine of an angle in radians; NaN if the angle is not finite.
///
/// ```
/// use htex_dsp::trig::{LARGEST, sin};
/// for x in [-0.0, 1e-9, 0.7, 2.0, -5.5, 1e6, LARGEST] {
///     assert_eq!(sin(x).to_bits(), libm::sin(x).to_bits());
/// }
/// ```
pub fn sin(x: f64) -> f64 {
    sincos(x).0
}

/// Cosine of an angle in radians; NaN if the angle is not finite.
pub fn cos(x: f64) -> f64 {
    sincos(x).1
}

/// Sine and cosine of an angle in radians; NaN if the angle is not finite.
#[inline(never)]
pub(crate) fn sincos(x: f64) -> (f64, f64) {
    let high = high_word(x);
    if high <= QUARTER_PI {
        let sine = if high < TINY { x } else { short_sine(x) };
        return (sine, cosine(x, 0.0));
    }
    let (quarter_turns, y, rest) = reduced(x, high);
    let (s, c) = (sine(y, rest), cosine(y, rest));
    match quarter_turns & 3 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// Tangent of an angle in radians; NaN if the angle is not finite.
pub fn tan(x: f64) -> f64 {
    let high = high_word(x);
    if high < TINY_TANGENT {
        return x;
    }
    if high <= QUARTER_PI {
        return tangent(x, 0.0, false);
    }
    let (quarter_turns, y, rest) = reduced(x, high);
    tangent(y, rest, quarter_turns & 1 == 1)
}

/// Writes the cosines of angles from 0 to π, each within 3e-16, into an array of the same length.
/// The series has no branches, so compilers compute several angles at a time. The bits differ from
/// the results of [`cos`].
///
/// ```
/// use htex_dsp::trig::{cos, half_turn_cosines};
/// let (angles, mut cosines) = ([0.0, 0.3, 1.6, 3.1], [0.0; 4]);
/// half_turn_cosines(&angles, &mut cosines);
/// for (angle, cosine) in angles.iter().zip(cosines) {
///     assert!((cosine - cos(*angle)).abs() < 3e-16);
/// }
/// ```
pub fn half_turn_cosines(angles: &[f64], cosines: &mut [f64]) {
    wide(HalfTurn { angles, cosines });
}

struct HalfTurn<'a> {
    angles: &'a [f64],
    cosines: &'a mut [f64],
}

/// Number of angles that are computed at a time.
const LANES: usize = 8;

impl Work for HalfTurn<'_> {
    #[inline(always)]
    fn run(self) {
        let (angles, last_angles) = self.angles.as_chunks();
        let (cosines, last) = self.cosines.as_chunks_mut();
        for (cosines, angles) in cosines.iter_mut().zip(angles) {
            *cosines = quarter_less(*angles);
        }
        let mut rest = [0.0; LANES];
        rest.iter_mut().zip(last_angles).for_each(|(x, angle)| *x = *angle);
        let rest = quarter_less(rest);
        last.iter_mut().zip(rest).for_each(|(cosine, x)| *cosine = x);
    }
}

/// Sines of a quarter turn minus the angles, by Taylor's series. The omitted terms of the series
/// are below 2e-18.
#[inline(always)]
fn quarter_less(angles: [f64; LANES]) -> [f64; LANES] {
    /// `(-1)^k / (2 k + 1)!` for k from 10 down to 1.
    const C: [f64; 10] = [
        1.957_294_106_339_126_3e-20,
        -8.220_635_246_624_33e-18,
        2.811_457_254_345_520_6e-15,
        -7.647_163_731_819_816e-13,
        1.605_904_383_682_161_3e-10,
        -2.505_210_838_544_172e-8,
        2.755_731_922_398_589_3e-6,
        -1.984_126_984_126_984e-4,
        8.333_333_333_333_333e-3,
        -1.666_666_666_666_666_6e-1,
    ];
    const QUARTER: [f64; 2] = [core::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17];
    let mut cosines = [0.0; LANES];
    for i in 0..LANES {
        // A quarter turn is stored in two parts. For angles near a quarter turn, the difference to
        // the first part is exact, and the second part supplies the remaining digits.
        let x = (QUARTER[0] - angles[i]) + QUARTER[1];
        let z = x * x;
        let mut r = C[0];
        for c in &C[1..] {
            r = r * z + c;
        }
        cosines[i] = x + x * z * r;
    }
    cosines
}

/// High words of π/4, and of 2⁻²⁷ √2. Below 2⁻²⁷ √2, the sine equals the angle.
const QUARTER_PI: u32 = 0x3fe9_21fb;
const TINY: u32 = 0x3e46_a09e;
/// High word of 2⁻²⁷. Below it, the tangent equals the angle.
const TINY_TANGENT: u32 = 0x3e40_0000;
/// High words of 3π/4, 5π/4, 7π/4 and 9π/4. An angle up to the first, second, third or fourth of
/// these is reduced by one, two, three or four quarter turns.
const TURNS: [u32; 4] = [0x4002_d97c, 0x400f_6a7a, 0x4015_fdbc, 0x401c_463b];
/// High words of π/2, π, 3π/2 and 2π. Near these, the reduction needs more digits of π/2.
const WHOLE: [u32; 4] = [0x3ff9_21fb, 0x4009_21fb, 0x4012_d97c, 0x4019_21fb];

/// The upper 32 bits of a number without its sign: the exponent and the first digits.
fn high_word(x: f64) -> u32 {
    (x.to_bits() >> 32) as u32 & 0x7fff_ffff
}

/// Splits an angle above π/4 into quarter turns and a remainder. Returns the remainder as the sum
/// of two numbers.
fn reduced(x: f64, high: u32) -> (i32, f64, f64) {
    // Adding this to a number and subtracting it again rounds the number to an integer.
    const ROUND: f64 = 1.5 / f64::EPSILON;
    /// π/2 in parts of 33 bits. Each part is followed by the rest of π/2 after this part.
    const PARTS: [[f64; 2]; 3] = [
        [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11],
        [6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21],
        [2.022_266_248_711_166_5e-21, 8.478_427_660_368_9e-32],
    ];
    let near = TURNS.iter().position(|most| high <= *most);
    let turns = match near {
        Some(i) => f64::copysign((i + 1) as f64, x),
        None => (x * core::f64::consts::FRAC_2_PI + ROUND) - ROUND,
    };
    let mut r = x - turns * PARTS[0][0];
    let mut w = turns * PARTS[0][1];
    let mut y = r - w;
    if near.is_none() || WHOLE.contains(&high) {
        // Digits that have cancelled are replaced by further digits of π/2. The previous parts
        // suffice if at most 16 or 49 bits are lost (msun).
        for ([part, rest], lost) in PARTS[1..].iter().zip([16, 49]) {
            let exponent = |x: f64| (high_word(x) >> 20) as i32;
            if exponent(x) - exponent(y) <= lost {
                break;
            }
            let before = r;
            w = turns * part;
            r = before - w;
            w = turns * rest - ((before - r) - w);
            y = r - w;
        }
    }
    (turns as i32, y, (r - y) - w)
}

const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

/// Sine of an angle up to π/4.
fn short_sine(x: f64) -> f64 {
    let (z, r) = sine_series(x);
    x + z * x * (SINE[0] + z * r)
}

/// Sine of `x + rest`, up to π/4.
fn sine(x: f64, rest: f64) -> f64 {
    let (z, r) = sine_series(x);
    let v = z * x;
    x - ((z * (0.5 * rest - v * r) - rest) - v * SINE[0])
}

fn sine_series(x: f64) -> (f64, f64) {
    let z = x * x;
    let r = SINE[1] + z * (SINE[2] + z * SINE[3]) + z * (z * z) * (SINE[4] + z * SINE[5]);
    (z, r)
}

/// Cosine of `x + rest`, up to π/4.
fn cosine(x: f64, rest: f64) -> f64 {
    const C: [f64; 6] = [
        4.166_666_666_666_66e-2,
        -1.388_888_888_887_411e-3,
        2.480_158_728_947_673e-5,
        -2.755_731_435_139_066_3e-7,
        2.087_572_321_298_175e-9,
        -1.135_964_755_778_819_5e-11,
    ];
    let z = x * x;
    let w = z * z;
    let r = z * (C[0] + z * (C[1] + z * C[2])) + w * w * (C[3] + z * (C[4] + z * C[5]));
    let half = 0.5 * z;
    let w = 1.0 - half;
    w + (((1.0 - w) - half) + (z * r - x * rest))
}

/// Tangent of `x + rest`, up to π/4, or -1 divided by it if `inverse` is set.
fn tangent(mut x: f64, mut rest: f64, inverse: bool) -> f64 {
    const T: [f64; 13] = [
        3.333_333_333_333_341e-1,
        1.333_333_333_332_012_5e-1,
        5.396_825_397_622_605e-2,
        2.186_948_829_485_954_2e-2,
        8.863_239_823_599_3e-3,
        3.592_079_107_591_312_4e-3,
        1.456_209_454_325_290_3e-3,
        5.880_412_408_202_641e-4,
        2.464_631_348_184_699e-4,
        7.817_944_429_395_571e-5,
        7.140_724_913_826_082e-5,
        -1.855_863_748_552_754_6e-5,
        2.590_730_518_636_337e-5,
    ];
    const PI_4: [f64; 2] = [core::f64::consts::FRAC_PI_4, 3.061_616_997_868_383e-17];
    /// High word of 0.6744. For angles above it, the series is evaluated at π/4 minus the angle.
    const LARGE: u32 = 0x3fe5_9428;
    let sign = f64::copysign(1.0, x);
    let is_large = high_word(x) >= LARGE;
    if is_large {
        x = (PI_4[0] - sign * x) + (PI_4[1] - sign * rest);
        rest = 0.0;
    }
    let z = x * x;
    let w = z * z;
    let odd = T[1] + w * (T[3] + w * (T[5] + w * (T[7] + w * (T[9] + w * T[11]))));
    let even = z * (T[2] + w * (T[4] + w * (T[6] + w * (T[8] + w * (T[10] + w * T[12])))));
    let cube = z * x;
    let r = rest + z * (cube * (odd + even) + rest) + cube * T[0];
    let w = x + r;
    if is_large {
        let s = if inverse { -1.0 } else { 1.0 };
        return sign * (s - 2.0 * (x + (r - w * w / (w + s))));
    }
    if !inverse {
        return w;
    }
    // The quotient of two rounded numbers would be wrong by two units in the last digit.
    let short = |x: f64| f64::from_bits(x.to_bits() & 0xffff_ffff_0000_0000);
    let w0 = short(w);
    let v = r - (w0 - x);
    let a = -1.0 / w;
    let a0 = short(a);
    a0 + a * (1.0 + a0 * w0 + a0 * v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uniform::Uniform;
    use core::f64::consts::FRAC_PI_2;

    fn assert_same(x: f64) {
        for x in [x, -x] {
            let (sine, cosine) = libm::sincos(x);
            let found = sincos(x);
            let bits = |(s, c): (f64, f64)| [s.to_bits(), c.to_bits()];
            assert_eq!(bits(found), bits((sine, cosine)), "{x:e}");
            assert_eq!(tan(x).to_bits(), libm::tan(x).to_bits(), "{x:e}");
            assert_eq!(bits((sin(x), cos(x))), bits((libm::sin(x), libm::cos(x))), "{x:e}");
        }
    }

    /// At whole and half quarter turns, the method of reduction changes and digits cancel.
    #[test]
    fn the_bits_are_those_of_libm_around_all_quarter_turns() {
        let mut uniform = Uniform::new(1);
        for half_quarters in (0..200).chain((0..20_000).map(|i| 100 + 104 * i)) {
            let at = f64::from(half_quarters) * 0.5 * FRAC_PI_2;
            for step in -40i64..=40 {
                for bits in [0, 28, 30, 32, 34, 36] {
                    let x = f64::from_bits(at.to_bits().wrapping_add_signed(step << bits));
                    if x.abs() <= LARGEST {
                        assert_same(x);
                    }
                }
            }
            assert_same((at + uniform.next_unit()).min(LARGEST));
        }
    }

    #[test]
    fn cosines_of_half_a_turn_are_those_of_single_angles() {
        let mut uniform = Uniform::new(3);
        for count in [0usize, 1, 7, 8, 38, 1_000] {
            let turn = core::f64::consts::PI / count.max(2) as f64;
            let of = |i: usize| turn * (i as f64 + uniform.next_unit());
            let angles: alloc::vec::Vec<f64> = (0..count).map(of).collect();
            let mut cosines = alloc::vec![f64::NAN; count];
            half_turn_cosines(&angles, &mut cosines);
            for (angle, cosine) in angles.iter().zip(cosines) {
                assert!((cosine - libm::cos(*angle)).abs() < 3e-16, "{angle}");
            }
        }
    }

    #[test]
    fn the_bits_are_those_of_libm_at_all_scales() {
        let mut uniform = Uniform::new(2);
        for i in 0..300_000 {
            let scale = libm::exp2(f64::from(i % 60) - 40.0);
            assert_same((scale * (1.0 + uniform.next_unit())).min(LARGEST));
        }
        for x in [0.0, f64::MIN_POSITIVE, 5e-324, LARGEST] {
            assert_same(x);
        }
        for x in [f64::NAN, f64::INFINITY] {
            let (sine, cosine) = sincos(x);
            assert!(sine.is_nan() && cosine.is_nan());
        }
    }
}
