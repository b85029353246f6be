//! Code that the crates of htex share. This crate contains nothing that is specific to textures or
//! devices.
//!
//! - [`finding`]: results of validation, with rules, reports and hints.
//! - [`files`]: writes files completely or not at all, and gives safe access to files and folders
//!   from untrusted sources.
//! - `storage`: reads and writes files by URI. This module needs the feature `storage`. Access to
//!   web servers and object stores needs the feature `cloud`.
//! - [`schema`]: JSON Schemas made from Rust types, and checks against them.
//! - [`native`]: native libraries, loaded from files or by name.
//! - [`setters!`]: methods that set the fields of options.

pub mod files;
pub mod finding;
pub mod native;
pub mod schema;
#[cfg(feature = "storage")]
pub mod storage;

/// Jaro–Winkler similarity above which an unknown word counts as a misspelt known word.
const SIMILAR: f64 = 0.8;

/// Returns the known words that are most similar to an unknown word, the most similar first.
/// Returns at most `most` words, and only words so similar that the user may have meant them.
///
/// ```
/// assert_eq!(htex_base::similar("licence", ["license", "level"], 1), ["license"]);
/// assert!(htex_base::similar("colour", ["license", "level"], 1).is_empty());
/// ```
pub fn similar<'a>(
    word: &str,
    known: impl IntoIterator<Item = &'a str>,
    most: usize,
) -> Vec<&'a str> {
    let alike = known.into_iter().map(|known| (strsim::jaro_winkler(known, word), known));
    let mut alike: Vec<_> = alike.filter(|(similarity, _)| *similarity > SIMILAR).collect();
    alike.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    alike.into_iter().take(most).map(|(_, known)| known).collect()
}

/// Defines methods inside an `impl` of an options type. Each method sets a field and returns the
/// options.
///
/// ```
/// #[derive(Default)]
/// struct Options {
///     seed: u64,
/// }
///
/// impl Options {
///     htex_base::setters! {
///         /// Sets the seed.
///         with_seed(seed: u64);
///     }
/// }
/// assert_eq!(Options::default().with_seed(7).seed, 7);
/// ```
#[macro_export]
macro_rules! setters {
    ($($(#[$doc:meta])* $name:ident($field:ident: $value:ty);)*) => {
        $($(#[$doc])*
        #[must_use]
        pub fn $name(mut self, $field: $value) -> Self {
            self.$field = $field;
            self
        })*
    };
}
