//! Recipes of libraries, and results of jobs.

use htex_build::{BuildError, Made, Recipe};
use htex_finding::plain;

use crate::promise::sentence;

/// A recipe, and the result of a job.
pub fn recipe(input: &[u8]) -> bool {
    let made = taken(Made::from_bytes("key", input).and_then(|made| made.to_bytes("key")));
    let Ok(text) = std::str::from_utf8(input) else {
        return made;
    };
    taken(Recipe::parse(text)) || made
}

fn taken<T>(result: Result<T, BuildError>) -> bool {
    // A reader of TOML shows the line that is wrong below its sentence.
    if let Err(error) = &result {
        sentence(&plain(&error.to_string()));
    }
    result.is_ok()
}
