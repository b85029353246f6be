//! Limits on libraries that are not trusted.

/// Limits of reading, each checked before the bytes it bounds are read or unpacked.
///
/// ```
/// use htex_library::{Limits, validate_source};
/// let limits = Limits { root_bytes: 0, ..Default::default() };
/// assert!(!validate_source(&b"not a library"[..], &limits)?.valid);
/// # Ok::<(), htex_library::LibraryError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Textures of the library: 16,777,216.
    pub entries: u64,
    /// Leaf pages of the index: 65,536.
    pub leaves: u64,
    /// Bytes of the root page when unpacked: 1 MiB.
    pub root_bytes: u64,
    /// Bytes of a leaf page when unpacked: 64 KiB.
    pub leaf_bytes: u64,
    /// Bytes of a texture: 16 MiB, as of a `.htex` file.
    pub asset_bytes: u64,
    /// Different shared objects: 1,048,576. Only validation counts them.
    pub objects: u64,
    /// Ratio of the bytes of all textures to the bytes of the file: 1,000. Whoever reads them all,
    /// to validate or to unpack, sums them up ([`crate::Ratio`]).
    pub ratio: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            entries: 1 << 24,
            leaves: 1 << 16,
            root_bytes: 1 << 20,
            leaf_bytes: 1 << 16,
            asset_bytes: 16 << 20,
            objects: 1 << 20,
            ratio: 1000,
        }
    }
}
