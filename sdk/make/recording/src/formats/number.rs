//! Parses decimal numbers, and rounds them correctly.

/// Powers of ten that `f64` represents exactly, one for each possible number of decimals in a plain
/// number.
const POWERS: [f64; 17] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16];
/// Number of digits that are read in an unrolled loop, which saves a fifth of the time; few numbers
/// have more.
const USUAL: usize = 9;

/// Parses a cell; `None` if it is not a number. NaN and infinities are returned as they are.
pub(crate) fn parse_number(cell: &str) -> Option<f64> {
    match plain_number(cell.as_bytes()) {
        Some((value, [])) => Some(value),
        _ => cell.parse().ok(),
    }
}

/// Parses a row of plain numbers at the start of `text` into `values`, one for each cell. Returns
/// the text after the row, from the line feed on.
///
/// Returns `None` if a cell has another form or the number of cells is not `values.len()`. The row
/// must then be read by the slower parser, and the contents of `values` are undefined.
pub(crate) fn parse_plain_row<'a>(
    text: &'a [u8],
    delimiter: u8,
    values: &mut [f64],
) -> Option<&'a [u8]> {
    let (last, before) = values.split_last_mut()?;
    let mut rest = text;
    for slot in before {
        (*slot, rest) = plain_number(rest)?;
        match rest {
            [byte, behind @ ..] if *byte == delimiter => rest = behind,
            _ => return None,
        }
    }
    (*last, rest) = plain_number(rest)?;
    match rest {
        [] | [b'\n', ..] => Some(rest),
        [b'\r', behind @ ..] if matches!(behind, [] | [b'\n', ..]) => Some(behind),
        _ => None,
    }
}

/// Parses `[+-]digits[.digits]` at the start and returns the rest. `None` if there is no number, or
/// it has more digits than `f64` holds exactly. The quotient of two exact numbers is rounded only
/// once, so the result equals `str::parse`.
// Called for every cell: inlining saves a quarter of the time for a row.
#[inline(always)]
fn plain_number(text: &[u8]) -> Option<(f64, &[u8])> {
    let (negative, text) = match text {
        [b'-', behind @ ..] => (true, behind),
        [b'+', behind @ ..] => (false, behind),
        _ => (false, text),
    };
    let (mut mantissa, mut rest) = digits(text, 0);
    let integer_digits = text.len() - rest.len();
    let mut decimals = 0;
    if let [b'.', behind @ ..] = rest {
        (mantissa, rest) = digits(behind, mantissa);
        decimals = behind.len() - rest.len();
    }
    let count = integer_digits + decimals;
    // Integers up to 2^53 and powers of ten up to 10^22 are exact.
    if count == 0 || count > 16 || mantissa > 1 << 53 {
        return None;
    }
    let magnitude = mantissa as f64 / POWERS[decimals];
    Some((if negative { -magnitude } else { magnitude }, rest))
}

/// Appends the digits at the start to `value` and returns the rest. The value wraps around after 19
/// digits; the caller counts the digits and refuses that many.
#[inline(always)]
fn digits(text: &[u8], value: u64) -> (u64, &[u8]) {
    if let Some(front) = text.first_chunk::<USUAL>() {
        let (value, count) = append(front, value);
        if count < USUAL {
            return (value, &text[count..]);
        }
    }
    let (value, count) = append(text, value);
    (value, &text[count..])
}

#[inline]
fn append(text: &[u8], mut value: u64) -> (u64, usize) {
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
        fn agrees_with_the_standard_parser(
            text in "[+-]?[0-9]{0,19}(\\.[0-9]{0,19})?(e-?[0-9])?[ -~]?"
        ) {
            prop_assert_eq!(parse_number(&text), text.parse().ok());
        }
    }

    #[test]
    fn a_plain_row_is_all_numbers_or_nothing() {
        let mut values = [0.0; 3];
        for (row, rest) in [
            ("1,-0.25,+3.", ""),
            ("1,-0.25,+3.\r", ""),
            ("1,-0.25,+3.\n\n", "\n\n"),
            ("1,-0.25,+3.\r\n4", "\n4"),
        ] {
            let found = parse_plain_row(row.as_bytes(), b',', &mut values);
            assert_eq!(found, Some(rest.as_bytes()), "{row:?}");
            assert_eq!(values, [1.0, -0.25, 3.0]);
        }
        for row in [
            "1,2",
            "1,2,3,4",
            "1,2,",
            "1,2,3,",
            "1,2,3 ",
            "1,,3",
            "1,2,1e3",
            "1,2,-",
            "",
            "\n",
            "1,2\n3",
            "1,2,3\r\r\n",
            "1,2,3\r4",
        ] {
            let found = parse_plain_row(row.as_bytes(), b',', &mut values);
            assert_eq!(found, None, "{row:?}");
        }
    }
}
