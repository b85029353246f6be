//! Byte ranges of an archive's entries. If several assets share an entry, programs use these ranges
//! to store the entry only once.

use std::ops::Range;

use crate::zip_records;

/// An archive entry: its name, and the range in the file of its data as stored (compressed or not).
///
/// ```no_run
/// let bytes = std::fs::read("sandpaper.htex")?;
/// for entry in htex_format::entry_ranges(&bytes) {
///     println!("{}: {} bytes", entry.name, entry.data.len());
/// }
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EntryRange {
    /// Name of the entry.
    pub name: String,
    /// Byte range of the entry's data in the file.
    pub data: Range<usize>,
}

/// Returns the entries of a valid asset in file order. If the bytes are not a valid asset, the
/// function returns those entries that it finds.
pub fn entry_ranges(bytes: &[u8]) -> Vec<EntryRange> {
    let Some(end) = zip_records::find_end(bytes) else {
        return Vec::new();
    };
    let mut at = end.directory_at as usize;
    let directory = (0..end.entries).map_while(|_| {
        let (central, next) = zip_records::central(bytes, at)?;
        at = next;
        let start = usize::try_from(central.local_at).ok()?;
        let local = zip_records::local(bytes, start, central.common.packed)?;
        Some(EntryRange {
            name: String::from_utf8_lossy(central.name).into_owned(),
            data: local.data,
        })
    });
    directory.collect()
}
