//! Formatting of numbers, independent of the locale.

/// Text for a value that is missing or not finite.
pub(crate) const MISSING: &str = "\u{2013}";

/// Formats `value` with exactly `decimals` decimals and a proper minus sign (U+2212). A value that
/// is not finite becomes an en dash.
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return MISSING.to_owned();
    }
    let text = format!("{value:.decimals$}");
    let negative = text.starts_with('-') && text.chars().any(|c| ('1'..='9').contains(&c));
    let digits = text.trim_start_matches('-');
    if negative { format!("\u{2212}{digits}") } else { digits.to_owned() }
}

/// Formats `value` with about three significant digits, without trailing zeros.
pub(crate) fn brief(value: f64) -> String {
    if !value.is_finite() {
        return MISSING.to_owned();
    }
    let size = value.abs();
    if size != 0.0 && !(1e-4..1e6).contains(&size) {
        return format!("{value:.2e}").replace('-', "\u{2212}");
    }
    let decimals = match size {
        0.0 => 0,
        _ => (2.0 - size.log10().floor()).clamp(0.0, 6.0) as usize,
    };
    trim_zeros(&fixed(value, decimals))
}

/// Formats a coordinate in pixels, rounded to a hundredth.
pub(crate) fn px(value: f64) -> String {
    let text = trim_zeros(&format!("{value:.2}"));
    if text == "-0" { "0".to_owned() } else { text }
}

/// Formats a size in bytes with decimal units: `16 B`, `2.1 kB`, `1.20 MB`.
pub(crate) fn bytes(count: u64) -> String {
    let value = count as f64;
    match count {
        0..1_000 => format!("{count} B"),
        1_000..100_000 => format!("{} kB", fixed(value / 1e3, 1)),
        100_000..1_000_000 => format!("{} kB", fixed(value / 1e3, 0)),
        1_000_000..1_000_000_000 => format!("{} MB", fixed(value / 1e6, 2)),
        _ => format!("{} GB", fixed(value / 1e9, 2)),
    }
}

/// Formats the ratio of `whole` to `part` with three digits, such as `570 : 1`; an en dash if
/// `part` is zero.
pub(crate) fn ratio(whole: u64, part: u64) -> String {
    if part == 0 {
        return MISSING.to_owned();
    }
    let value = whole as f64 / part as f64;
    let decimals = if value < 10.0 { 1 } else { 0 };
    format!("{} : 1", thousands(&fixed(three_digits(value), decimals)))
}

/// Rounds `value` to three significant digits if it has more digits before the decimal point.
fn three_digits(value: f64) -> f64 {
    let unit = 10f64.powi(value.max(100.0).log10().floor() as i32 - 2);
    if value < 100.0 { value } else { (value / unit).round() * unit }
}

/// Groups digits in threes with narrow no-break spaces if there are more than four.
fn thousands(digits: &str) -> String {
    if digits.len() <= 4 || digits.contains('.') {
        return digits.to_owned();
    }
    let mut out = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

fn trim_zeros(text: &str) -> String {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_has_no_sign_and_missing_is_a_dash() {
        assert_eq!(fixed(-0.001, 2), "0.00");
        assert_eq!(fixed(-1.25, 1), "\u{2212}1.2");
        assert_eq!(fixed(f64::NAN, 1), MISSING);
        assert_eq!(brief(0.012345), "0.0123");
        assert_eq!(brief(1234.5), "1234");
        assert_eq!(px(-0.001), "0");
    }

    #[test]
    fn sizes_and_ratios() {
        assert_eq!(bytes(16), "16 B");
        assert_eq!(bytes(2_120), "2.1 kB");
        assert_eq!(bytes(1_200_000), "1.20 MB");
        assert_eq!(ratio(1_200_000, 16), "75\u{202f}000 : 1");
        assert_eq!(ratio(1_600_044, 56), "28\u{202f}600 : 1");
        assert_eq!(ratio(1, 0), MISSING);
    }
}
