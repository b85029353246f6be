//! The descriptors of the built-in models.

use htex::host::Registry;

use crate::call::{Answer, Files};
use crate::refusal::Refusal;

pub(crate) fn models(_: &[u8], _: Files<'_>) -> Result<Answer, Refusal> {
    let registry = Registry::builtin();
    let descriptors: Vec<_> = registry
        .models()
        .iter()
        .map(|model| model.descriptor())
        .collect();
    Answer::new(&descriptors, Vec::new())
}
