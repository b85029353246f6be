//! Patterns of names.

use std::fmt::{Display, Formatter};
use std::str::FromStr;

use glob::{MatchOptions, Pattern};

/// A name, or a pattern of names: `*` matches any text inside a part of a name, `?` matches one
/// character, `[ab]` matches one of these characters, and `**` matches any text, also across parts.
///
/// ```
/// use htex_format::library::NamePattern;
/// let wood: NamePattern = "wood/*".parse()?;
/// assert!(wood.matches("wood/oak") && !wood.matches("wood/old/oak"));
/// let oak: NamePattern = "wood/oak".parse()?;
/// assert!(oak.matches("wood/oak") && !oak.is_pattern());
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct NamePattern(NameOrPattern);

#[derive(Debug, Clone, PartialEq)]
enum NameOrPattern {
    Name(String),
    Pattern(Pattern),
}

impl NamePattern {
    /// Returns whether a name matches.
    pub fn matches(&self, name: &str) -> bool {
        self.matches_with(name, true)
    }

    /// Returns whether a text matches. In this text, unlike in a name, `/` is an ordinary
    /// character, so `*` and `?` also match it.
    pub fn matches_text(&self, text: &str) -> bool {
        self.matches_with(text, false)
    }

    fn matches_with(&self, text: &str, has_parts: bool) -> bool {
        let options = MatchOptions { require_literal_separator: has_parts, ..MatchOptions::new() };
        match &self.0 {
            NameOrPattern::Name(own) => own == text,
            NameOrPattern::Pattern(pattern) => pattern.matches_with(text, options),
        }
    }

    /// Returns whether this is a pattern, which may match several names.
    pub fn is_pattern(&self) -> bool {
        matches!(self.0, NameOrPattern::Pattern(_))
    }

    /// Returns the text of the name or the pattern.
    pub fn as_str(&self) -> &str {
        match &self.0 {
            NameOrPattern::Name(name) => name,
            NameOrPattern::Pattern(pattern) => pattern.as_str(),
        }
    }
}

impl FromStr for NamePattern {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // Names cannot contain `*` or `?`, but they may contain brackets.
        if !text.contains(['*', '?']) {
            return Ok(Self(NameOrPattern::Name(text.to_owned())));
        }
        let pattern = Pattern::new(text).map_err(|error| format!("{text}: {error}"))?;
        Ok(Self(NameOrPattern::Pattern(pattern)))
    }
}

impl Display for NamePattern {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.as_str())
    }
}
