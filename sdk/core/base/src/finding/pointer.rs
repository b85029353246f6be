//! JSON pointers (RFC 6901).

use std::borrow::Cow;

/// A place in a JSON document. Each place refers to the place of the object or array that contains
/// it, so the places form a chain that ends at the root. [`Self::pointer`] formats the place as a
/// JSON pointer.
///
/// ```
/// use htex_base::finding::Place;
///
/// let fields = Place::Key(&Place::Root, "fields");
/// assert_eq!(Place::Index(&fields, 2).pointer(), "/fields/2");
/// ```
pub enum Place<'p> {
    /// The whole document.
    Root,
    /// A key of an object.
    Key(&'p Place<'p>, &'p str),
    /// An element of an array.
    Index(&'p Place<'p>, usize),
}

impl Place<'_> {
    /// Returns the JSON pointer of the place; empty for the root.
    pub fn pointer(&self) -> String {
        match self {
            Self::Root => String::new(),
            Self::Key(parent, key) => format!("{}/{}", parent.pointer(), escape(key)),
            Self::Index(parent, index) => format!("{}/{index}", parent.pointer()),
        }
    }
}

/// Escapes a key for a JSON pointer (RFC 6901, section 3).
pub fn escape(key: &str) -> Cow<'_, str> {
    if key.contains(['~', '/']) {
        key.replace('~', "~0").replace('/', "~1").into()
    } else {
        key.into()
    }
}
