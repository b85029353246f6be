//! Limits for reading untrusted files.

/// Limits for reading, with their default values. The reader checks each limit before it reads or
/// unpacks the bytes that the limit concerns.
///
/// ```
/// let limits = htex_format::Limits { file_bytes: 1 << 20, ..Default::default() };
/// assert!(!htex_format::validate(&[0; 2 << 20], &limits).valid);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Size of the file, bytes: 16 MiB.
    pub file_bytes: u64,
    /// Number of entries in the archive: 256.
    pub entries: usize,
    /// Size of an entry when unpacked, bytes: 4 MiB.
    pub entry_bytes: u64,
    /// Size of all entries together when unpacked, bytes: 16 MiB.
    pub total_bytes: u64,
    /// Ratio of an entry's unpacked size to its packed size: 200.
    pub ratio: u64,
    /// Nesting depth of the manifest's arrays and objects: 32. The JSON parser itself refuses a
    /// depth of more than 100.
    pub json_depth: usize,
    /// Size of the manifest as JSON, counted in opening brackets and commas outside strings:
    /// 1,000,000. This count limits the number of values, because a manifest has at most one value
    /// more than it has opening brackets and commas.
    pub json_nodes: usize,
    /// Number of conditions: 10,000. A player finds triangles between the conditions. The time that
    /// this takes grows faster than the number of conditions.
    pub conditions: usize,
    /// Number of values in all parameter blocks and reference spectra together: 1,048,576.
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
            json_nodes: 1_000_000,
            conditions: 10_000,
            values: 1 << 20,
        }
    }
}
