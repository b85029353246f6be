//! What is wrong with a file, and where.

use std::fmt;

/// Longest quotation from a file, characters.
const MOST_QUOTED: usize = 100;

/// Why a file cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}{problem}")]
pub struct Fault {
    /// Where in the file.
    pub place: Place,
    /// What is wrong, and what to do.
    pub problem: String,
}

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Place {
    /// The line, counted from 1; 0 for the file as a whole.
    pub line: usize,
    /// The name of the element, if it is in one.
    pub element: String,
}

impl Fault {
    pub(super) fn at(place: Place, problem: impl Into<String>) -> Self {
        Self { place, problem: problem.into() }
    }

    /// A fault of the file as a whole.
    pub(super) fn of_file(problem: impl Into<String>) -> Self {
        Self::at(Place::default(), problem)
    }
}

impl fmt::Display for Place {
    /// Formats the place as `line 12, ARcoeff: `; empty for the file as a whole.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.line, &self.element[..]) {
            (0, _) => Ok(()),
            (line, "") => write!(f, "line {line}: "),
            (line, element) => write!(f, "line {line}, {}: ", short(element)),
        }
    }
}

/// The beginning of a text from the file, on one line.
pub(super) fn short(text: &str) -> String {
    let shown: String = text.chars().take(MOST_QUOTED).collect();
    shown.escape_debug().to_string()
}
