//! Settings that would fix a problem, attached to its message.

use std::fmt;
use std::ops::Deref;

use serde::{Serialize, Serializer};

/// The settings that would fix a problem. A hint contains the names that flags, recipes and keyword
/// arguments share, e.g. `map` or `most_numbers`. A name may be followed by a value, e.g. `segments
/// windows`. The text of the message describes the setting only in words. So each program can add
/// the setting's name in its own notation, such as a flag.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Hint(&'static [&'static str]);

impl Hint {
    /// No setting would help.
    pub const NONE: Self = Self(&[]);

    pub const fn new(settings: &'static [&'static str]) -> Self {
        Self(settings)
    }

    /// Returns the settings, the most helpful first.
    pub fn settings(self) -> &'static [&'static str] {
        self.0
    }

    /// Returns this hint, or `other` if this hint has no settings.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        if self.0.is_empty() { other } else { self }
    }
}

/// A warning or a note: a sentence, and a hint with the settings that would help. Serialization
/// writes only the sentence.
///
/// ```
/// use htex_base::finding::{Hint, Notice};
///
/// let notice = Notice::new("The unit is assumed; give the scale.", Hint::new(&["scale"]));
/// assert_eq!(serde_json::to_string(&notice)?, r#""The unit is assumed; give the scale.""#);
/// assert_eq!(Notice::from("All is well.").hint, Hint::NONE);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Notice {
    /// The sentence.
    pub text: String,
    pub hint: Hint,
}

impl Notice {
    /// Creates a notice from a sentence and a hint.
    pub fn new(text: impl Into<String>, hint: Hint) -> Self {
        let text = text.into();
        Self { text, hint }
    }
}

impl From<String> for Notice {
    fn from(text: String) -> Self {
        Self::new(text, Hint::NONE)
    }
}

impl From<&str> for Notice {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl Deref for Notice {
    type Target = str;

    fn deref(&self) -> &str {
        &self.text
    }
}

impl PartialEq<&str> for Notice {
    fn eq(&self, text: &&str) -> bool {
        self.text == *text
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Serialize for Notice {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.text.serialize(serializer)
    }
}
