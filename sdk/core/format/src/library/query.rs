//! Searches a library's index for textures with given properties.

use crate::{Condition, Quantity};

use crate::library::entry::{Entry, Interval};

/// A search query: the properties that a texture must have. A field that is `None` or empty is not
/// checked.
///
/// ```no_run
/// use htex_format::library::{Library, Query};
/// let library = Library::open("cloth.htexlib".as_ref())?;
/// let query = Query { tags: vec!["rough".to_owned()], speed_mm_s: Some(80.0), ..Query::default() };
/// for entry in library.entries() {
///     let entry = entry?;
///     if query.matches(&entry) {
///         println!("{}", entry.name);
///     }
/// }
/// # Ok::<(), htex_format::library::LibraryError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Query {
    /// Words. Each word must occur in the texture's name or in one of its tags, ignoring case.
    pub words: Vec<String>,
    /// Tags that the texture must have, ignoring case.
    pub tags: Vec<String>,
    /// Speed, mm/s. It must lie in the texture's recorded range of speeds, after the range is
    /// widened by 5 % ([`crate::SAME_CONDITION`]).
    pub speed_mm_s: Option<f64>,
    /// Force, newtons. It must lie in the texture's recorded range of forces, after the range is
    /// widened by 5 %.
    pub force_n: Option<f64>,
    /// Id of a model that describes the texture, or the last part of the id.
    pub model: Option<String>,
    /// Licence that the texture must have, ignoring case. `*` stands for any text, as in `CC*`.
    pub license: Option<String>,
    /// Author that the texture must have, compared in the same way as the licence.
    pub author: Option<String>,
    /// Quantity that the texture must have.
    pub quantity: Option<Quantity>,
    /// Largest felt difference that a texture may have from its recordings, decibels. A texture
    /// whose felt difference is not known does not match.
    pub felt_error_rms_db: Option<f64>,
    /// Largest held-out error that a texture may have, decibels. A texture whose held-out error is
    /// not known does not match.
    pub held_out_error_db: Option<f64>,
}

impl Query {
    /// Returns whether the texture has all properties of the query.
    pub fn matches(&self, entry: &Entry) -> bool {
        let (name, tags) = (caseless(&entry.name), entry.tags.iter().map(|tag| caseless(tag)));
        let tags: Vec<String> = tags.collect();
        let is_in = |word: &String| {
            let word = caseless(word);
            name.contains(&word) || tags.iter().any(|tag| tag.contains(&word))
        };
        let conditions = entry.conditions;
        self.words.iter().all(is_in)
            && self.tags.iter().all(|tag| tags.contains(&caseless(tag)))
            && is_among(self.speed_mm_s, conditions.speed_mm_s)
            && is_among(self.force_n, conditions.force_n)
            && self.model.as_ref().is_none_or(|model| has_model(entry, model))
            && is_like(self.license.as_ref(), entry.license.as_ref())
            && is_like(self.author.as_ref(), entry.author.as_ref())
            && self.quantity.is_none_or(|quantity| entry.quantity == Some(quantity))
            && is_at_most(entry.held_out_error_db, self.held_out_error_db)
            && is_at_most(entry.felt_error_rms_db, self.felt_error_rms_db)
    }

    /// Returns whether the query asks for a property that an index of version 1.0 does not store.
    pub fn needs_version_1_1(&self) -> bool {
        self.license.is_some()
            || self.author.is_some()
            || self.quantity.is_some()
            || self.felt_error_rms_db.is_some()
            || self.held_out_error_db.is_some()
    }
}

/// Returns a text in a form that ignores case, for searches.
fn caseless(text: &str) -> String {
    // The text is converted to upper case, because in lower case `ß` and `ss` would still differ,
    // and so would the two small forms of sigma.
    text.to_uppercase()
}

/// Returns whether a text matches a pattern. A missing text matches only `*`.
fn is_like(pattern: Option<&String>, text: Option<&String>) -> bool {
    let Some(pattern) = pattern else { return true };
    let text = caseless(text.map_or("", String::as_str));
    let pattern = caseless(pattern);
    let Some((start, rest)) = pattern.split_once('*') else { return pattern == text };
    let Some(mut text) = text.strip_prefix(start) else { return false };
    // For a part between two `*`, the first occurrence is taken, because it leaves the most text
    // for the parts that follow.
    let mut parts: Vec<&str> = rest.split('*').collect();
    let end = parts.pop().unwrap_or_default();
    for part in parts {
        let Some((_, after)) = text.split_once(part) else { return false };
        text = after;
    }
    text.ends_with(end)
}

fn is_at_most(error: Option<f64>, most: Option<f64>) -> bool {
    most.is_none_or(|most| error.is_some_and(|error| error <= most))
}

fn is_among(asked: Option<f64>, known: Option<Interval>) -> bool {
    let Some(asked) = asked else { return true };
    let is_near = |x| Condition::is_same(asked, x);
    known.is_some_and(|i| (i.min..=i.max).contains(&asked) || is_near(i.min) || is_near(i.max))
}

fn has_model(entry: &Entry, model: &str) -> bool {
    let is = |id: &String| id == model || id.rsplit('.').next() == Some(model);
    entry.models.iter().any(is)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_any_text_at_their_stars() {
        let is = |pattern: &str, text: &str| is_like(Some(&pattern.into()), Some(&text.into()));
        assert!(is("cc*", "CC-BY-4.0") && is("*", "") && is("*by*4.0", "CC-BY-4.0"));
        assert!(is("*a*a", "aXa") && is("CC0-1.0", "cc0-1.0") && is("a**b", "ab"));
        assert!(!is("cc*", "MIT") && !is("*a*a", "a") && !is("a*a", "a") && !is("CC0", "CC0-1.0"));
        assert!(is_like(None, None) && !is_like(Some(&"CC*".into()), None));
    }
}
