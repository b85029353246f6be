//! Limits of scenes.

/// Limits for reading untrusted scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Size of the file, bytes; default 1 MiB.
    pub file_bytes: u64,
    /// Nesting depth of arrays and objects; default 16.
    pub json_depth: usize,
    /// Number of surfaces; default 256.
    pub surfaces: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { file_bytes: 1 << 20, json_depth: 16, surfaces: 256 }
    }
}
