//! Settings that accept one value or a list.

use serde::{Deserialize, Deserializer};

/// One value, or several.
#[derive(Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(untagged)]
#[cfg_attr(feature = "schemars", schemars(rename = "OneOrMore"))]
pub enum OneOrMore<T = String> {
    /// One value.
    One(T),
    /// Several values.
    Several(Vec<T>),
}

/// Reads one value, or a list.
///
/// # Errors
/// When the input is neither.
pub fn one_or_more<'de, T, L, D>(deserializer: D) -> Result<L, D::Error>
where
    T: Deserialize<'de>,
    L: From<Vec<T>>,
    D: Deserializer<'de>,
{
    Ok(L::from(match OneOrMore::deserialize(deserializer)? {
        OneOrMore::One(value) => vec![value],
        OneOrMore::Several(values) => values,
    }))
}
