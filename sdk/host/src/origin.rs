//! Where a model's code comes from.

use std::path::PathBuf;

/// Where a model's code comes from.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Origin {
    /// Linked into this program.
    Builtin,
    /// A type of this program, registered by it.
    Own,
    /// A native library, which runs with all rights of this program.
    Native(PathBuf),
    /// A WASM module in a file, which runs in a sandbox.
    Wasm(PathBuf),
    /// A WASM module that came with something else, by the name of that.
    Embedded(String),
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Builtin => f.write_str("built in"),
            Self::Own => f.write_str("part of this program"),
            Self::Native(path) | Self::Wasm(path) => path.display().fmt(f),
            Self::Embedded(name) => write!(f, "embedded in {name}"),
        }
    }
}
