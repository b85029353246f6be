//! The grammar of model ids.

/// Returns whether `id` is a valid model id: three or more parts, separated by dots, of `a-z`,
/// `0-9`, `-` and `_`.
///
/// ```
/// assert!(htex_model::is_model_id("org.example.my-model_2"));
/// assert!(!htex_model::is_model_id("org.example.MyModel"));
/// assert!(!htex_model::is_model_id("org..model"));
/// ```
pub fn is_model_id(id: &str) -> bool {
    let allowed = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-' || b == b'_';
    let word = |part: &str| !part.is_empty() && part.bytes().all(allowed);
    id.split('.').count() >= 3 && id.split('.').all(word)
}
