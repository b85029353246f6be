//! Recordings with their conditions.

use htex_format::Source;

use crate::{Exploration, Recording};

/// A recording, with its condition as far as it is given.
#[derive(Debug, Clone)]
pub struct Take {
    pub recording: Recording,
    /// Speed and force given by the user; they take precedence over measured ones.
    pub given: Exploration,
}

/// Returns the provenance entry of a recording.
pub(crate) fn source_of(take: &Take, segments: usize) -> Source {
    Source {
        file: take.recording.source.clone(),
        rate_hz: take.recording.rate_hz,
        segments: segments as u64,
        blake3: take.recording.file.blake3(),
    }
}
