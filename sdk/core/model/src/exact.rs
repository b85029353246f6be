//! Writes numbers as decimal texts at compile time. Parsing such a text gives exactly the same
//! bits.
//!
//! The project has its own code for these texts, because no formatter of the standard library or of
//! a package runs at compile time. The compiler computes the texts. Therefore, a WASM module
//! contains the text of its descriptor, but no code that writes such texts.

use crate::decimal::Decimal;

/// Largest exponent whose power of ten is exact in a 64-bit float.
const EXACT_POWER: i32 = 22;
/// Whole numbers below this one are exact in 64-bit floats.
const EXACT_WHOLE: f64 = (1u64 << 53) as f64;
/// Number of digits that is enough to distinguish all 64-bit floats.
const ENOUGH_DIGITS: usize = 17;
/// Number of limbs that are needed for `m · 5^1074` with m < 2^53. A limb has nine digits.
const LIMBS: usize = 86;
const LIMB: u64 = 1_000_000_000;

/// Returns a decimal that parses to the given finite number. If a single product or quotient of
/// exact floats gives the number (Clinger 1990), the decimal is the shortest possible one.
/// Otherwise it has 17 digits.
pub(crate) const fn exact(number: f64) -> Decimal {
    assert!(number.is_finite(), "a descriptor contains a number that is not finite");
    let negative = number < 0.0;
    let size = number.abs();
    let (digits, exponent) = match short(size) {
        Some(found) => found,
        None => long(size),
    };
    Decimal { negative, digits, exponent }
}

const fn short(size: f64) -> Option<(u64, i32)> {
    if size == 0.0 {
        return Some((0, 0));
    }
    // The search goes down from the largest exponent, so that the first match has the fewest
    // digits.
    let mut exponent = EXACT_POWER;
    while exponent >= -EXACT_POWER {
        let power = power_of_ten(exponent.abs());
        let digits = if exponent >= 0 { size / power } else { size * power };
        // If the whole number and the power of ten are both exact, only their product or quotient
        // is rounded. A reader of the text rounds in the same way.
        if digits < EXACT_WHOLE {
            let whole = (digits + 0.5) as u64;
            let back = if exponent >= 0 { whole as f64 * power } else { whole as f64 / power };
            if back == size && whole as f64 <= EXACT_WHOLE {
                return Some((whole, exponent));
            }
        }
        exponent -= 1;
    }
    None
}

const fn power_of_ten(exponent: i32) -> f64 {
    let (mut power, mut i) = (1.0, 0);
    while i < exponent {
        power *= 10.0;
        i += 1;
    }
    power
}

/// Computes the full decimal expansion of the number, and returns its first 17 digits, rounded half
/// up.
const fn long(size: f64) -> (u64, i32) {
    let bits = size.to_bits();
    let (field, fraction) = ((bits >> 52) as i32, bits & ((1 << 52) - 1));
    let (mantissa, power) = match field {
        0 => (fraction, -1074),
        _ => (fraction | 1 << 52, field - 1075),
    };
    // Note that m · 2^-n = m · 5^n · 10^-n.
    let factor = if power < 0 { 5 } else { 2 };
    let mut limbs = [0; LIMBS];
    // A mantissa is below 10^18, so it fills at most two limbs.
    limbs[0] = mantissa % LIMB;
    limbs[1] = mantissa / LIMB;
    let mut i = 0;
    while i < power.unsigned_abs() {
        multiply(&mut limbs, factor);
        i += 1;
    }
    let (digits, dropped) = leading(&limbs);
    (digits, dropped + if power < 0 { power } else { 0 })
}

const fn multiply(limbs: &mut [u64; LIMBS], factor: u64) {
    let (mut carry, mut i) = (0, 0);
    while i < LIMBS {
        let product = limbs[i] * factor + carry;
        limbs[i] = product % LIMB;
        carry = product / LIMB;
        i += 1;
    }
}

/// Returns the first digits, and the number of digits that follow them.
const fn leading(limbs: &[u64; LIMBS]) -> (u64, i32) {
    let mut place = 9 * LIMBS;
    while place > ENOUGH_DIGITS && digit(limbs, place - 1) == 0 {
        place -= 1;
    }
    let (mut digits, last) = (0, place.saturating_sub(ENOUGH_DIGITS));
    while place > last {
        place -= 1;
        digits = 10 * digits + digit(limbs, place);
    }
    let up = last > 0 && digit(limbs, last - 1) >= 5;
    (digits + up as u64, last as i32)
}

const fn digit(limbs: &[u64; LIMBS], place: usize) -> u64 {
    limbs[place / 9] / 10u64.pow((place % 9) as u32) % 10
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::String;

    /// The texts of numbers of all sizes parse to the same bits. Short decimals stay the same.
    #[test]
    fn decimals_read_as_the_number() {
        let text = |x| String::from_utf8(exact(x).text().bytes().to_vec()).unwrap();
        let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
        for _ in 0..2_000 {
            bits = bits.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
            let number = f64::from_bits(bits);
            if number.is_finite() {
                assert_eq!(text(number).parse(), Ok(number));
            }
        }
        for number in [5e-324, f64::MIN_POSITIVE, f64::MAX, 1.0 / 3.0, 0.1 + 0.2] {
            assert_eq!(text(number).parse(), Ok(number));
        }
        let written = [0.12, 1e-3, -18.0, 0.000_976_562_5, 1e6, 0.3e-3].map(text);
        assert_eq!(written, ["0.12", "0.001", "-18", "0.0009765625", "1000000", "0.0003"]);
    }
}
