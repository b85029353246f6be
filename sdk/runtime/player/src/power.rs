//! Logarithms and powers of two as polynomials in single precision, with the same bits on every
//! processor.

/// Coefficients of `log2((1 + s) / (1 - s)) / s` in powers of `s²`: `2 / ((2 i + 1) ln 2)`.
const LOG2: [f32; 4] = [2.885_39, 0.961_796_7, 0.577_078, 0.412_198_6];
/// Coefficients of `2^x` in powers of `x`: `ln(2)^i / i!`.
const EXP2: [f32; 7] = [
    1.0,
    core::f32::consts::LN_2,
    0.240_226_5,
    0.055_504_11,
    0.009_618_129,
    0.001_333_355_8,
    0.000_154_035_3,
];
/// Bits of the square root of two as `f32`. A larger mantissa is halved, and its exponent is
/// increased by one.
const ROOT_2: u32 = 0x3FB5_04F3;
/// Position of the exponent bits.
const FRACTION_BITS: u32 = 23;
const FRACTION: u32 = (1 << FRACTION_BITS) - 1;
const BIAS: i32 = 127;

/// Returns the binary logarithm of a normal positive number. The absolute or the relative error,
/// whichever is smaller, is at most 2e-7.
pub(crate) fn log2(x: f32) -> f32 {
    let bits = x.to_bits();
    let mut exponent = (bits >> FRACTION_BITS) as i32 - BIAS;
    let mut mantissa = (bits & FRACTION) | 1.0f32.to_bits();
    // Between √½ and √2, `s` is at most 0.172, where four terms of the series suffice.
    if mantissa > ROOT_2 {
        mantissa -= 1 << FRACTION_BITS;
        exponent += 1;
    }
    let m = f32::from_bits(mantissa);
    let s = (m - 1.0) / (m + 1.0);
    let q = s * s;
    let [a, b, c, d] = LOG2;
    exponent as f32 + s * (a + q * (b + q * (c + q * d)))
}

/// Returns `2^x` for x from -120 to 120, with a relative error of at most 3e-7.
pub(crate) fn exp2(x: f32) -> f32 {
    let whole = (x + if x < 0.0 { -0.5 } else { 0.5 }) as i32;
    let part = x - whole as f32;
    let polynomial = EXP2.iter().rev().fold(0.0, |sum, c| sum * part + c);
    let scale = ((whole + BIAS) as u32) << FRACTION_BITS;
    polynomial * f32::from_bits(scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_the_functions() {
        assert_eq!((log2(1.0), exp2(0.0)), (0.0, 1.0));
        for i in 0..200_000u32 {
            let x = f32::from_bits(0x3580_0000 + i * 839);
            let exact = libm::log2(f64::from(x));
            let error = f64::from(log2(x)) - exact;
            assert!(error.abs() < 2e-7 * exact.abs().max(1.0), "{x}: {error}");
        }
        for i in -100_000..100_000 {
            let x = i as f32 * 0.001;
            let exact = libm::exp2(f64::from(x));
            let error = f64::from(exp2(x)) / exact - 1.0;
            assert!(error.abs() < 3e-7, "{x}: {error}");
        }
    }
}
