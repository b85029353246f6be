//! Generates the JSON Schemas (draft 2020-12) of htex's documents from Rust types, and validates
//! documents with them.
#![forbid(unsafe_code)]

#[cfg(feature = "check")]
mod check;
#[cfg(feature = "schemars")]
mod generate;
mod keys;

pub use crate::white_space;
#[cfg(feature = "check")]
pub use check::{Schema, Violation};
#[cfg(feature = "schemars")]
pub use generate::{check_keys, crossing, document};
pub use keys::{UnknownKey, unknown_keys};

/// The characters with Unicode's property `White_Space`, written for the square brackets of a
/// regular expression. JSON Schema validators differ in the meaning of `\s`, so patterns do not use
/// it.
#[macro_export]
macro_rules! white_space {
    () => {
        r"\u0009-\u000D\u0020\u0085\u00A0\u1680\u2000-\u200A\u2028\u2029\u202F\u205F\u3000"
    };
}

/// Pattern for a text that contains a character other than white space.
pub const NOT_BLANK: &str = concat!("[^", white_space!(), "]");
