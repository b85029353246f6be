//! Limits for reading untrusted libraries.

/// Limits for reading, with their default values. The reader checks each limit before it reads or
/// unpacks the bytes that the limit concerns.
///
/// ```
/// use htex_format::library::{Limits, validate_source};
/// let limits = Limits { root_bytes: 0, ..Default::default() };
/// assert!(!validate_source(&b"not a library"[..], &limits)?.valid);
/// # Ok::<(), htex_format::library::LibraryError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Number of textures in the library: 16,777,216.
    pub entries: u64,
    /// Number of leaf pages in the index: 65,536.
    pub leaves: u64,
    /// Size of the root page when unpacked, bytes: 1 MiB.
    pub root_bytes: u64,
    /// Size of a leaf page when unpacked, bytes: 64 KiB.
    pub leaf_bytes: u64,
    /// Size of a texture, bytes: 16 MiB, the limit of a `.htex` file.
    pub asset_bytes: u64,
    /// Number of different shared objects: 1,048,576. Only validation counts the shared objects.
    pub objects: u64,
    /// Ratio of the size of all textures to the size of the file: 1,000. This limit applies to
    /// programs that read all textures, e.g. to validate or to unpack them
    /// ([`crate::library::Ratio`]).
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
