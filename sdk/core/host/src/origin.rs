//! Origins of models.

use std::path::PathBuf;

/// Origin of a model's code.
///
/// ```
/// use htex_host::{Origin, Registry};
/// let registry = Registry::builtin();
/// assert_eq!(*registry.find("ar")?.origin(), Origin::Builtin);
/// # Ok::<(), htex_host::HostError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Origin {
    /// Linked into this program.
    Builtin,
    /// A Rust type that this program registered.
    Own,
    /// An object that the program registered at run time. The text is the name of the object's
    /// programming language.
    Runtime(String),
    /// A native library, which runs with all the rights of this program.
    Native(PathBuf),
    /// A WASM module in a file, which runs in a sandbox.
    Wasm(PathBuf),
    /// A WASM module in an asset or another container. The text is the container's name.
    Embedded(String),
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Builtin => f.write_str("built in"),
            Self::Own => f.write_str("part of this program"),
            Self::Native(path) | Self::Wasm(path) => path.display().fmt(f),
            Self::Runtime(text) => f.write_str(text),
            Self::Embedded(name) => write!(f, "embedded in {name}"),
        }
    }
}
