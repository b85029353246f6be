//! Pseudo-random points on the unit circle.

/// Radians per step of a signed 32-bit number whose full range is half a turn.
const QUARTER: f32 = core::f32::consts::FRAC_PI_2 / (1u32 << 31) as f32;
const TERMS: usize = 7;
/// Taylor coefficients of the cosine, and of the sine divided by the angle, in the square of the
/// angle. Up to a quarter turn the truncation error is below 1e-8.
const TAYLOR: [[f32; 2]; TERMS] = taylor();

const fn taylor() -> [[f32; 2]; TERMS] {
    let mut exact = [[1.0f64; 2]; TERMS];
    let mut terms = [[1.0; 2]; TERMS];
    let mut i = 1;
    while i < TERMS {
        let n = 2.0 * i as f64;
        // The recursion is in double precision, and each coefficient is rounded only once.
        exact[i][0] = -exact[i - 1][0] / (n * (n - 1.0));
        exact[i][1] = -exact[i - 1][1] / (n * (n + 1.0));
        terms[i] = [exact[i][0] as f32, exact[i][1] as f32];
        i += 1;
    }
    terms
}

/// Cosines and sines of random angles, uniform on the circle, made from random bits. The error is
/// below 3e-7.
///
/// The signed bits give an angle in the right half plane, and the lowest bit flips both signs. So
/// two short series suffice, and there are no branches.
#[inline(always)]
pub(crate) fn directions<const N: usize>(bits: [u32; N]) -> ([f32; N], [f32; N]) {
    let mut angle = [0.0; N];
    for i in 0..N {
        angle[i] = bits[i] as i32 as f32 * QUARTER;
    }
    let [last_cos, last_sin] = TAYLOR[TERMS - 1];
    let (mut cos, mut sin) = ([last_cos; N], [last_sin; N]);
    for [next_cos, next_sin] in TAYLOR[..TERMS - 1].iter().rev() {
        for i in 0..N {
            let square = angle[i] * angle[i];
            cos[i] = cos[i] * square + next_cos;
            sin[i] = sin[i] * square + next_sin;
        }
    }
    // The angle has only the upper 24 of the bits, apart from very small angles, so the lowest bit
    // is independent of it.
    let turned = |x: f32, bits: u32| f32::from_bits(x.to_bits() ^ (bits << 31));
    for i in 0..N {
        cos[i] = turned(cos[i], bits[i]);
        sin[i] = turned(sin[i] * angle[i], bits[i]);
    }
    (cos, sin)
}
