//! Searches a library's index for textures with given properties.

use crate::Condition;

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
    /// Words that must all occur in the name or in a tag, ignoring case.
    pub words: Vec<String>,
    /// Tags that the texture must have, ignoring case.
    pub tags: Vec<String>,
    /// Speed, mm/s, that must lie in the texture's recorded range of speeds, widened by 5 %
    /// ([`crate::SAME_CONDITION`]).
    pub speed_mm_s: Option<f64>,
    /// Force, newtons, that must lie in the texture's recorded range of forces, widened by 5 %.
    pub force_n: Option<f64>,
    /// Id of a model that describes the texture, or the last part of the id.
    pub model: Option<String>,
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
    }
}

/// Returns a text in a form that ignores case, for searches.
fn caseless(text: &str) -> String {
    // Not lower case, which keeps `ß` and `ss` apart, and the two small forms of sigma.
    text.to_uppercase()
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
