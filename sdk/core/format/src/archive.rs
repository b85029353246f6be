//! Strict ZIP reader: checks all records first, then unpacks every entry.
//!
//! The ZIP format allows files in which two programs see different archives. The rules for assets
//! exclude such files. In an asset, the entries start at byte 0 and have no gaps between them.
//! After the entries comes the directory, which lists them in the same order, and then the end
//! record. The local headers state the same names and sizes as the directory.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::ops::Range;

use crate::limits::Limits;
use crate::rules as rule;
use crate::unpack::{DEFLATED, STORED, unpack};
use crate::zip_records::{self, Central, Common, END_BYTES, End, Local};
use htex_base::finding::Findings;

/// Name of the entry that identifies an asset.
pub(crate) const MIMETYPE: &str = "mimetype";
/// Contents of the entry `mimetype`.
pub(crate) const MEDIA_TYPE: &str = "application/vnd.htex+zip";
pub(crate) const MANIFEST: &str = "manifest.json";

// Bit 0 means encryption, and bit 6 means strong encryption. Bit 13 means that values of the local
// header are hidden. This also occurs only in encrypted archives.
const ENCRYPTED: u16 = 1 | 1 << 6 | 1 << 13;
const DATA_DESCRIPTOR: u16 = 1 << 3;
const ZIP64_16: u16 = u16::MAX;
const ZIP64_32: u32 = u32::MAX;

/// An unpacked entry.
pub(crate) struct Entry<'a> {
    pub name: String,
    pub method: u16,
    pub bytes: Cow<'a, [u8]>,
}

/// An entry whose records were checked and whose data is still packed.
struct PackedEntry<'a> {
    name: String,
    common: Common,
    data: &'a [u8],
}

/// A valid archive with all entries unpacked.
pub(crate) struct Archive<'a> {
    pub entries: Vec<Entry<'a>>,
}

impl<'a> Archive<'a> {
    /// Checks the records and unpacks all entries. If something is wrong, adds an error to the
    /// findings and returns `None`.
    pub(crate) fn open(bytes: &'a [u8], limits: &Limits, findings: &mut Findings) -> Option<Self> {
        if bytes.len() as u64 > limits.file_bytes {
            findings.add(rule::FILE_TOO_LARGE, "", too_large(bytes.len() as u64, limits));
            return None;
        }
        let end = end_record(bytes, limits, findings)?;
        let packed = directory(bytes, &end, limits, findings)?;
        // Entries are unpacked only if all records are valid, because the limits are compared with
        // the sizes in the records.
        if findings.has_errors() {
            return None;
        }
        // All entries are unpacked, even after a failure, so that each damaged entry gets a
        // finding.
        let unpacked = packed.into_iter().map(|packed| packed.unpack(findings));
        let entries: Vec<Option<Entry<'_>>> = unpacked.collect();
        let entries = entries.into_iter().collect::<Option<_>>()?;
        Some(Self { entries })
    }

    pub(crate) fn index(&self, name: &str) -> Option<usize> {
        self.entries.iter().position(|entry| entry.name == name)
    }
}

impl<'a> PackedEntry<'a> {
    fn unpack(self, findings: &mut Findings) -> Option<Entry<'a>> {
        let (name, method) = (self.name, self.common.method);
        match unpack(self.data, &self.common) {
            Ok(bytes) => Some(Entry { name, method, bytes }),
            Err(problem) => {
                let message = format!("{name} is damaged: {problem}; get the file again");
                findings.add(rule::ENTRY_CORRUPT, "", message);
                None
            }
        }
    }
}

pub(crate) fn too_large(bytes: u64, limits: &Limits) -> String {
    let limit = limits.file_bytes;
    format!("the file has {bytes} bytes and the limit is {limit}; raise it if you trust the file")
}

/// Returns the end record if the file holds exactly one archive and nothing else.
fn end_record(bytes: &[u8], limits: &Limits, findings: &mut Findings) -> Option<End> {
    let Some(end) = zip_records::find_end(bytes) else {
        let message = "there is no end record: this is not a ZIP archive, or the file is truncated";
        findings.add(rule::ARCHIVE_INVALID, "", message.to_owned());
        return None;
    };
    let counts = [end.disks[0], end.disks[1], end.entries_here, end.entries];
    if end.zip64
        || counts.contains(&ZIP64_16)
        || end.directory_bytes == ZIP64_32
        || end.directory_at == ZIP64_32
    {
        let message = "the end record is a ZIP64 record; write the archive without ZIP64";
        findings.add(rule::ARCHIVE_ZIP64, "", message.to_owned());
        return None;
    }
    let after = bytes.len() - end.at - END_BYTES;
    if after > 0 {
        let message = format!("{after} bytes follow the end record; remove them or the comment");
        findings.add(rule::ARCHIVE_EXTRA_DATA, "", message);
        return None;
    }
    let whole = end.disks == [0, 0] && end.entries_here == end.entries && end.comment_bytes == 0;
    let directory_end = u64::from(end.directory_at) + u64::from(end.directory_bytes);
    if !whole || directory_end > end.at as u64 {
        let message =
            "the end record is inconsistent: the file is truncated or one part of a split archive";
        findings.add(rule::ARCHIVE_INVALID, "", message.to_owned());
        return None;
    }
    if directory_end < end.at as u64 {
        let gap = end.at as u64 - directory_end;
        let message = format!("{gap} bytes precede the archive or its end record; remove them");
        findings.add(rule::ARCHIVE_EXTRA_DATA, "", message);
        return None;
    }
    let (entries, limit) = (usize::from(end.entries), limits.entries);
    if entries > limit {
        let message = format!("there are {entries} entries and the limit is {limit}");
        findings.add(rule::ARCHIVE_TOO_MANY_ENTRIES, "", message);
        return None;
    }
    Some(end)
}

fn directory<'a>(
    bytes: &'a [u8],
    end: &End,
    limits: &Limits,
    findings: &mut Findings,
) -> Option<Vec<PackedEntry<'a>>> {
    let mut entries = Vec::new();
    let mut names = BTreeSet::new();
    let (mut at, mut expected_local, mut total) = (end.directory_at as usize, 0usize, 0u64);
    for index in 0..usize::from(end.entries) {
        // The bytes are cut off before the end record, so that no field of a directory record can
        // extend into the end record.
        let record = zip_records::central(bytes.get(..end.at)?, at);
        let Some((central, next)) = record else {
            let message = format!("the directory is damaged at record {index}");
            findings.add(rule::ARCHIVE_INVALID, "", message);
            return None;
        };
        at = next;
        let name = String::from_utf8_lossy(central.name).into_owned();
        check_name(central.name, &name, findings);
        // Comparing ASCII letters is enough, because a name with any other character has just been
        // reported.
        if !names.insert(name.to_ascii_lowercase()) {
            let message = format!("two entries have the name {name:?}; keep one");
            findings.add(rule::ENTRY_NAME_DUPLICATE, "", message);
        }
        check_record(&central, &name, findings);
        check_sizes(&central, &name, limits, findings);
        total += u64::from(central.common.size);
        let data = check_local(bytes, &central, &name, expected_local, findings)?;
        expected_local = data.end;
        entries.push(PackedEntry { name, common: central.common, data: bytes.get(data)? });
    }
    check_ends(end, at, expected_local, findings);
    if total > limits.total_bytes {
        let limit = limits.total_bytes;
        let message = format!("the entries unpack to {total} bytes and the limit is {limit}");
        findings.add(rule::ARCHIVE_TOO_LARGE, "", message);
    }
    Some(entries)
}

/// Checks that the entries end where the directory starts, and that the directory ends where the
/// end record starts.
fn check_ends(end: &End, directory_end: usize, entries_end: usize, findings: &mut Findings) {
    if directory_end != end.at {
        let message = "the directory is longer or shorter than the end record says".to_owned();
        findings.add(rule::ARCHIVE_INVALID, "", message);
    } else if entries_end != end.directory_at as usize {
        let message = "there are bytes between the last entry and the directory; remove them";
        findings.add(rule::ARCHIVE_EXTRA_DATA, "", message.to_owned());
    }
}

fn check_name(raw: &[u8], name: &str, findings: &mut Findings) {
    let plain = raw.iter().all(|&b| (b' '..=b'~').contains(&b) && b != b'\\' && b != b':');
    let parts = name.split('/').all(|part| !matches!(part, "" | "." | ".."));
    if !plain || !parts {
        let message =
            format!("{name:?} is not a safe name; use relative names of ASCII characters");
        findings.add(rule::ENTRY_NAME_UNSAFE, "", message);
    }
}

fn check_record(central: &Central<'_>, name: &str, findings: &mut Findings) {
    let common = &central.common;
    if common.flags & ENCRYPTED != 0 {
        let message = format!("{name} is encrypted; write it without a password");
        findings.add(rule::ENTRY_ENCRYPTED, "", message);
    } else if !matches!(common.method, STORED | DEFLATED) {
        let method = common.method;
        let message = format!("{name} is compressed by method {method}; store or deflate it");
        findings.add(rule::ENTRY_COMPRESSION_UNKNOWN, "", message);
    }
    if common.flags & DATA_DESCRIPTOR != 0 {
        let message =
            format!("{name} has its sizes after its data; write them in the local header");
        findings.add(rule::ENTRY_DATA_DESCRIPTOR, "", message);
    }
    if [common.packed, common.size, central.local_at].contains(&ZIP64_32) {
        let message = format!("{name} has ZIP64 sizes; write the archive without ZIP64");
        findings.add(rule::ARCHIVE_ZIP64, "", message);
    }
    if !central.extra.is_empty() || !central.comment.is_empty() {
        let message = format!("{name} has an extra field or a comment; remove it");
        findings.add(rule::ENTRY_EXTRA_FIELD, "", message);
    }
}

fn check_sizes(central: &Central<'_>, name: &str, limits: &Limits, findings: &mut Findings) {
    let (size, packed) = (u64::from(central.common.size), u64::from(central.common.packed));
    let (most, ratio) = (limits.entry_bytes, limits.ratio);
    if size > most {
        let message = format!("{name} unpacks to {size} bytes and the limit is {most}");
        findings.add(rule::ENTRY_TOO_LARGE, "", message);
    }
    if size > packed.saturating_mul(ratio) {
        let message = format!(
            "{name} unpacks from {packed} to {size} bytes and the limit is a ratio of {ratio}"
        );
        findings.add(rule::ENTRY_RATIO, "", message);
    }
}

/// Compares the local header with the directory. Returns the range of the entry's data, or `None`
/// if the data cannot be found.
fn check_local(
    bytes: &[u8],
    central: &Central<'_>,
    name: &str,
    expected: usize,
    findings: &mut Findings,
) -> Option<Range<usize>> {
    if central.local_at as usize != expected {
        let message = format!(
            "{name} starts at byte {} and the entry before it ends at {expected}; \
             write the entries without gaps, in directory order",
            central.local_at
        );
        findings.add(rule::ARCHIVE_EXTRA_DATA, "", message);
        return None;
    }
    let Some(local) = zip_records::local(bytes, expected, central.common.packed) else {
        let message = format!("{name} has no local header at byte {expected}, or is truncated");
        findings.add(rule::ARCHIVE_INVALID, "", message);
        return None;
    };
    // A stored entry has no stream that states its length. Therefore, only this comparison checks
    // that its two sizes are equal.
    let stated = central.common.method == STORED && central.common.packed != central.common.size;
    if !agrees(central, &local) || stated || central.disk != 0 {
        let message =
            format!("the directory and the local header of {name} differ; write the archive again");
        findings.add(rule::ENTRY_HEADER_MISMATCH, "", message);
    }
    // One finding for each entry is enough. If the directory also has an extra field, it has
    // already been reported.
    if !local.extra.is_empty() && central.extra.is_empty() {
        let message = format!("{name} has an extra field in its local header; remove it");
        findings.add(rule::ENTRY_EXTRA_FIELD, "", message);
    }
    Some(local.data)
}

fn agrees(central: &Central<'_>, local: &Local<'_>) -> bool {
    central.common == local.common && central.name == local.name
}
