//! Writes numbers as decimal texts. The text formatting of the standard library would add 20 kB to
//! a WASM module. Packages such as `ryu` cannot run at compile time, but `exact.rs` needs such
//! code.

/// Significant digits of the result of [`rounded`].
const DIGITS: i32 = 9;
/// A number is written without an exponent if the position of its decimal point is in this range.
/// The position is counted from the first digit.
const PLAIN: (i32, i32) = (-6, 17);

/// `digits · 10^exponent`.
#[derive(Clone, Copy)]
pub(crate) struct Decimal {
    pub(crate) negative: bool,
    pub(crate) digits: u64,
    pub(crate) exponent: i32,
}

/// A short ASCII text.
pub(crate) struct Short {
    // The size is enough for a sign, `0.`, six zeros and 20 digits.
    bytes: [u8; 40],
    len: usize,
}

impl Short {
    const EMPTY: Self = Self { bytes: [0; 40], len: 0 };

    pub(crate) const fn bytes(&self) -> &[u8] {
        self.bytes.split_at(self.len).0
    }

    const fn push(&mut self, byte: u8) {
        self.bytes[self.len] = byte;
        self.len += 1;
    }

    const fn zeros(&mut self, count: i32) {
        let mut i = 0;
        while i < count {
            self.push(b'0');
            i += 1;
        }
    }

    /// Writes the digits of a number. If there are more than `whole` digits, a decimal point
    /// follows the first `whole` digits.
    const fn digits(&mut self, number: u64, whole: i32) {
        let mut unit = 1;
        while number / unit >= 10 {
            unit *= 10;
        }
        let mut written = 0;
        while unit > 0 {
            if written == whole {
                self.push(b'.');
            }
            self.push(b'0' + (number / unit % 10) as u8);
            unit /= 10;
            written += 1;
        }
    }
}

/// Returns the text of a whole number.
pub(crate) const fn whole(number: u64) -> Short {
    let mut text = Short::EMPTY;
    text.digits(number, i32::MAX);
    text
}

impl Decimal {
    /// Returns the number as JSON text.
    pub(crate) const fn text(self) -> Short {
        let Self { negative, digits, .. } = self;
        let mut text = Short::EMPTY;
        if negative {
            text.push(b'-');
        }
        let point = count_digits(digits) + self.exponent;
        if point > PLAIN.1 || point < PLAIN.0 {
            text.digits(digits, 1);
            text.push(b'e');
            if point < 1 {
                text.push(b'-');
            }
            text.digits((point - 1).unsigned_abs() as u64, i32::MAX);
        } else if point > 0 {
            text.digits(digits, point);
            text.zeros(self.exponent);
        } else {
            text.push(b'0');
            text.push(b'.');
            text.zeros(-point);
            text.digits(digits, i32::MAX);
        }
        text
    }
}

const fn count_digits(mut number: u64) -> i32 {
    let mut count = 1;
    while number >= 10 {
        number /= 10;
        count += 1;
    }
    count
}

/// Rounds a finite number to nine significant digits, for messages.
pub(crate) fn rounded(number: f64) -> Decimal {
    const LEAST: f64 = 10u64.pow(DIGITS as u32 - 1) as f64;
    let (mut size, mut exponent) = (number.abs(), 0);
    while size >= 10.0 * LEAST {
        size /= 10.0;
        exponent += 1;
    }
    while size < LEAST && size > 0.0 {
        size *= 10.0;
        exponent -= 1;
    }
    let mut digits = (size + 0.5) as u64;
    while digits != 0 && digits.is_multiple_of(10) {
        digits /= 10;
        exponent += 1;
    }
    Decimal { negative: number < 0.0, digits, exponent: if digits == 0 { 0 } else { exponent } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::String;

    fn text(number: f64) -> String {
        String::from_utf8(rounded(number).text().bytes().to_vec()).unwrap()
    }

    #[test]
    fn numbers_are_written_as_people_write_them() {
        for (number, expected) in [
            (0.0, "0"),
            (-0.25, "-0.25"),
            (1e-3, "0.001"),
            (20_000.0, "20000"),
            (999.999_999_99, "1000"),
            (1.0 / 3.0, "0.333333333"),
            (1e300, "1e300"),
            (-2.5e-8, "-2.5e-8"),
            (f64::MAX, "1.79769313e308"),
            (5e-324, "4.94065646e-324"),
        ] {
            assert_eq!(text(number), expected);
        }
        assert_eq!(whole(u64::MAX).bytes(), b"18446744073709551615");
    }
}
