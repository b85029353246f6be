//! How much a reader takes from a file it does not trust.

/// Caps, each applied before the bytes it bounds are read or unpacked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of the file: 16 MiB.
    pub file_bytes: u64,
    /// Entries of the archive: 256.
    pub entries: usize,
    /// Bytes of an entry when unpacked: 4 MiB.
    pub entry_bytes: u64,
    /// Bytes of all entries together when unpacked: 16 MiB.
    pub total_bytes: u64,
    /// Unpacked bytes of an entry for each packed byte: 200.
    pub ratio: u64,
    /// Depth of arrays and objects within one another in the manifest: 32. More than 100 is
    /// refused by the JSON parser itself.
    pub json_depth: usize,
    /// Numbers in all parameter blocks and the reference together: 1,048,576.
    pub values: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 16 << 20,
            entries: 256,
            entry_bytes: 4 << 20,
            total_bytes: 16 << 20,
            ratio: 200,
            json_depth: 32,
            values: 1 << 20,
        }
    }
}
