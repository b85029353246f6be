//! Recipes of libraries, and results of jobs.

use htex_base::finding::plain;
use htex_build::{BuildError, JobResult, Recipe};

use crate::promise::sentence;

/// Reads the input as a recipe and as the result of a job.
pub fn recipe(input: &[u8]) -> bool {
    let made = taken(JobResult::from_bytes("key", input).and_then(|made| made.to_bytes("key")));
    let Ok(text) = std::str::from_utf8(input) else {
        return made;
    };
    taken(Recipe::parse(text)) || made
}

fn taken<T>(result: Result<T, BuildError>) -> bool {
    // A TOML reader shows the wrong line below its sentence.
    if let Err(error) = &result {
        sentence(&plain(&error.to_string()));
    }
    result.is_ok()
}
