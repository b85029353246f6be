//! Reads decimal numbers from text.
//!
//! It uses the JSON reader, which is in every program that opens an asset anyway. The standard
//! library's reader has its own table, which takes 13 kB of the compressed library of the npm
//! package.

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
