//! Reports of checking a model.

use std::fmt::{self, Display};

use serde::Serialize;

pub type Report = crate::harness::Report<ModelFile>;

/// The model that was checked, and the seed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelFile {
    pub file: String,
    /// Seed of the voices.
    pub seed: u64,
}

impl Display for ModelFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (seed {})", self.file, self.seed)
    }
}
