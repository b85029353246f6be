//! Decimal text to `f64`, correctly rounded.

/// Powers of ten that `f64` holds exactly, as many as a plain number has digits.
const POWERS: [f64; 17] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
];

/// The number a cell holds; `None` when it is not one. NaN and infinities come back as such.
pub(crate) fn parse_number(cell: &str) -> Option<f64> {
    match plain_prefix(cell.as_bytes()) {
        Some((value, length)) if length == cell.len() => Some(value),
        _ => cell.parse().ok(),
    }
}

/// Reads a row of plain numbers into `values`, one for each cell.
///
/// False when a cell is anything else or their count is not `values.len()`: then the row needs the
/// slow way, and `values` holds nothing of use.
pub(crate) fn parse_plain_row(row: &[u8], delimiter: u8, values: &mut [f64]) -> bool {
    let last = values.len().saturating_sub(1);
    let mut rest = row;
    for (column, slot) in values.iter_mut().enumerate() {
        let Some((value, length)) = plain_prefix(rest) else {
            return false;
        };
        *slot = value;
        match rest.get(length) {
            Some(byte) if *byte == delimiter && column < last => rest = &rest[length + 1..],
            None if column == last => return true,
            _ => return false,
        }
    }
    false
}

/// The number `[+-]digits[.digits]` at the front, and its length in bytes; `None` when there is none
/// or it has more digits than `f64` surely holds. The quotient of two exact numbers is rounded once,
/// so it equals what `str::parse` gives.
fn plain_prefix(text: &[u8]) -> Option<(f64, usize)> {
    let negative = text.first() == Some(&b'-');
    let sign = usize::from(negative || text.first() == Some(&b'+'));
    let (whole, integer_digits) = digits(&text[sign..], 0);
    let mut length = sign + integer_digits;
    let (mut mantissa, mut decimals) = (whole, 0);
    if text.get(length) == Some(&b'.') {
        (mantissa, decimals) = digits(&text[length + 1..], whole);
        length += 1 + decimals;
    }
    let count = integer_digits + decimals;
    if count == 0 || count > 16 || mantissa > 1 << 53 {
        return None;
    }
    let magnitude = mantissa as f64 / POWERS[decimals];
    Some((if negative { -magnitude } else { magnitude }, length))
}

/// Appends the digits at the front to `value`; wraps beyond 19, which the caller refuses by the count.
fn digits(text: &[u8], mut value: u64) -> (u64, usize) {
    let mut count = 0;
    for byte in text {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        value = value.wrapping_mul(10).wrapping_add(u64::from(digit));
        count += 1;
    }
    (value, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn agrees_with_the_standard_parser(text in "[+-]?[0-9]{0,12}(\\.[0-9]{0,9})?(e-?[0-9])?") {
            prop_assert_eq!(parse_number(&text), text.parse().ok());
        }
    }

    #[test]
    fn a_plain_row_is_all_numbers_or_nothing() {
        let mut values = [0.0; 3];
        assert!(parse_plain_row(b"1,-0.25,+3.", b',', &mut values));
        assert_eq!(values, [1.0, -0.25, 3.0]);
        for row in [
            "1,2", "1,2,3,4", "1,2,", "1,2,3,", "1,2,3 ", "1,,3", "1,2,1e3", "1,2,-", "",
        ] {
            assert!(!parse_plain_row(row.as_bytes(), b',', &mut values), "{row}");
        }
    }
}
