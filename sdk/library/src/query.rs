//! Search among entries.

use htex_format::Condition;

use crate::entry::{Entry, Interval};

/// What a texture must have to be found; what is `None` or empty is not asked for.
///
/// ```no_run
/// use htex_library::{Library, Query};
/// let library = Library::open("cloth.htexlib".as_ref())?;
/// let query = Query { tags: vec!["rough".to_owned()], speed_mm_s: Some(80.0), ..Query::default() };
/// for entry in library.entries() {
///     let entry = entry?;
///     if query.matches(&entry) {
///         println!("{}", entry.name);
///     }
/// }
/// # Ok::<(), htex_library::LibraryError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Query {
    /// Words that are parts of the name or of a tag, without case; all of them must be found.
    pub words: Vec<String>,
    /// Tags that the texture has, without case.
    pub tags: Vec<String>,
    /// A speed among the recorded ones, mm/s; within 5 % of one of them where it is beyond
    /// ([`htex_format::SAME_CONDITION`]).
    pub speed_mm_s: Option<f64>,
    /// A force among the recorded ones, newtons; as for the speed.
    pub force_n: Option<f64>,
    /// Id of a model that describes the texture, or its last part.
    pub model: Option<String>,
}

impl Query {
    /// Whether the texture has all that is asked for.
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

/// A text without its case, for searches.
fn caseless(text: &str) -> String {
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
