//! Reads decimal numbers from text.
//!
//! This module uses the JSON parser, because every program that opens assets already contains it.
//! The number parser of the standard library contains a large table, which would add 13 kB to the
//! compressed npm package.

/// Reads a number such as `1.5`, `.5` or `2e-3`.
///
/// ```
/// use htex_host::decimal;
/// assert_eq!([decimal("+.5"), decimal("2."), decimal("1.235e2")], [Some(0.5), Some(2.0), Some(123.5)]);
/// assert_eq!([decimal("inf"), decimal(" 1"), decimal("1e999"), decimal("")], [None; 4]);
/// ```
pub fn decimal(text: &str) -> Option<f64> {
    let text = text.strip_prefix('+').unwrap_or(text);
    let text = text.strip_suffix('.').unwrap_or(text);
    let first = text.chars().next()?;
    match first {
        '.' => serde_json::from_str(&format!("0{text}")).ok(),
        '-' | '0'..='9' => serde_json::from_str(text).ok(),
        _ => None,
    }
}
