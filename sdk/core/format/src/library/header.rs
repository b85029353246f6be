//! The header: the first 128 bytes of a library.

use std::ops::Range;

use crate::library::fault::Fault;
use crate::library::limits::Limits;
use crate::library::page::crc32;
use crate::library::rules as rule;

/// First bytes of every library. As in PNG, they contain a byte that is not ASCII and both kinds of
/// line ends. A transfer in text mode changes these bytes, so a reader notices it.
pub const MAGIC: [u8; 8] = *b"\x89HTL\r\n\x1a\n";
/// File extension of libraries.
pub const EXTENSION: &str = "htexlib";

pub(crate) const HEADER_BYTES: usize = 128;
pub(crate) const MAJOR: u16 = 1;
pub(crate) const MINOR: u16 = 1;

/// Place of the header, as written in findings.
const PLACE: &str = "/header";
/// Names of the parts, in file order.
const PARTS: [&str; 4] = ["root", "leaves", "shared", "payload"];

/// The header. The parts of a library follow each other without gaps in this order: header, root,
/// leaves, shared, payload.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Header {
    pub minor: u16,
    /// The root page of the index.
    pub root: Range<u64>,
    /// The leaf pages of the index.
    pub leaves: Range<u64>,
    /// Objects that several textures share, and after them the spectra.
    pub shared: Range<u64>,
    /// The textures' own bytes.
    pub payload: Range<u64>,
    pub entries: u64,
    /// Number of leaf pages.
    pub leaf_count: u32,
    /// BLAKE3 of the root and the leaves as stored in the file.
    pub index_blake3: [u8; 32],
}

impl Header {
    /// Reads and checks the header at the start of `bytes`. `file_bytes` is the size of the file.
    pub(crate) fn read(bytes: &[u8], file_bytes: u64, limits: &Limits) -> Result<Self, Fault> {
        let start = &bytes[..bytes.len().min(MAGIC.len())];
        // If a file of a few bytes begins correctly, it is a library that was cut off. The error
        // for this case is below.
        if start.is_empty() || !MAGIC.starts_with(start) {
            let message = "it does not begin as a library; name a .htexlib file, or get it again";
            return Err(Fault::new(rule::LIBRARY_UNRECOGNISED, PLACE, message));
        }
        let Some((bytes, _)) = bytes.split_first_chunk::<HEADER_BYTES>() else {
            let length = bytes.len();
            let message = format!("the file has {length} of the header's 128 bytes; get it again");
            return Err(Fault::new(rule::LIBRARY_TRUNCATED, "", message));
        };
        // The specification demands this check before the checks below, because another major
        // version may differ in everything else.
        check_version(bytes)?;
        check_sum(bytes)?;
        let header = Self::fields(bytes)?;
        header.check_length(file_bytes)?;
        header.check_limits(limits)?;
        Ok(header)
    }

    fn fields(bytes: &[u8; HEADER_BYTES]) -> Result<Self, Fault> {
        let minor = u16_at(bytes, 10);
        // A newer minor version may give the reserved bytes a meaning.
        if u32_at(bytes, 12) != 0 && minor <= MINOR {
            return Err(invalid("the reserved bytes 12 to 15 are not 0"));
        }
        let mut end = HEADER_BYTES as u64;
        let mut parts = [const { 0..0u64 }; 4];
        for (i, part) in parts.iter_mut().enumerate() {
            let (at, length) = (u64_at(bytes, 16 + 16 * i), u64_at(bytes, 24 + 16 * i));
            let name = PARTS[i];
            if at != end {
                return Err(invalid(&format!(
                    "{name} starts at byte {at} and the part before it ends at {end}"
                )));
            }
            end = at
                .checked_add(length)
                .ok_or_else(|| invalid(&format!("{name} has {length} bytes, beyond 64 bits")))?;
            *part = at..end;
        }
        let [root, leaves, shared, payload] = parts;
        let mut index_blake3 = [0; 32];
        index_blake3.copy_from_slice(&bytes[92..124]);
        Ok(Self {
            minor,
            root,
            leaves,
            shared,
            payload,
            entries: u64_at(bytes, 80),
            leaf_count: u32_at(bytes, 88),
            index_blake3,
        })
    }

    fn check_length(&self, file_bytes: u64) -> Result<(), Fault> {
        let stated = self.payload.end;
        if file_bytes < stated {
            let message = format!("the file has {file_bytes} of {stated} bytes; get it again");
            return Err(Fault::new(rule::LIBRARY_TRUNCATED, "", message));
        }
        if file_bytes > stated {
            let extra = file_bytes - stated;
            let message = format!("{extra} bytes follow the last texture; remove them");
            return Err(Fault::new(rule::LIBRARY_EXTRA_DATA, "", message));
        }
        Ok(())
    }

    fn check_limits(&self, limits: &Limits) -> Result<(), Fault> {
        let (entries, leaves) = (self.entries, u64::from(self.leaf_count));
        if entries > limits.entries {
            let limit = limits.entries;
            let message = format!(
                "there are {entries} textures and the limit is {limit}; raise it if you trust the file"
            );
            return Err(Fault::new(rule::LIBRARY_ENTRIES_TOO_MANY, PLACE, message));
        }
        if leaves > limits.leaves {
            let limit = limits.leaves;
            let message = format!(
                "there are {leaves} pages and the limit is {limit}; raise it if you trust the file"
            );
            return Err(Fault::new(rule::LIBRARY_LEAVES_TOO_MANY, PLACE, message));
        }
        // Every leaf has at least one entry.
        if (entries == 0) != (leaves == 0) || leaves > entries {
            return Err(invalid(&format!("{entries} textures are in {leaves} pages")));
        }
        Ok(())
    }

    #[cfg(feature = "write")]
    pub(crate) fn to_bytes(&self) -> [u8; HEADER_BYTES] {
        let mut bytes = [0; HEADER_BYTES];
        bytes[..8].copy_from_slice(&MAGIC);
        bytes[8..10].copy_from_slice(&MAJOR.to_le_bytes());
        bytes[10..12].copy_from_slice(&self.minor.to_le_bytes());
        let parts = [&self.root, &self.leaves, &self.shared, &self.payload];
        for (i, part) in parts.into_iter().enumerate() {
            let (at, length) = (part.start, part.end - part.start);
            bytes[16 + 16 * i..24 + 16 * i].copy_from_slice(&at.to_le_bytes());
            bytes[24 + 16 * i..32 + 16 * i].copy_from_slice(&length.to_le_bytes());
        }
        bytes[80..88].copy_from_slice(&self.entries.to_le_bytes());
        bytes[88..92].copy_from_slice(&self.leaf_count.to_le_bytes());
        bytes[92..124].copy_from_slice(&self.index_blake3);
        let crc = crc32(&bytes[..124]);
        bytes[124..].copy_from_slice(&crc.to_le_bytes());
        bytes
    }
}

/// Returns the note that a library has a newer minor version than this program supports. Returns
/// `None` for other libraries.
pub(crate) fn newer_note(minor: u16) -> Option<Fault> {
    let message = format!(
        "the library has version {MAJOR}.{minor} and this program supports {MAJOR}.{MINOR}; what is new is ignored"
    );
    (minor > MINOR).then(|| Fault::new(rule::LIBRARY_VERSION_NEWER, PLACE, message))
}

/// Returns the note of [`newer_note`] for the first bytes of a file. These bytes need not be a
/// valid header.
pub(crate) fn newer_note_of(start: &[u8]) -> Option<Fault> {
    let bytes = start.first_chunk::<HEADER_BYTES>()?;
    let is_library = bytes.starts_with(&MAGIC) && check_version(bytes).is_ok();
    is_library.then(|| newer_note(u16_at(bytes, 10))).flatten()
}

fn check_version(bytes: &[u8; HEADER_BYTES]) -> Result<(), Fault> {
    let (major, minor) = (u16_at(bytes, 8), u16_at(bytes, 10));
    if major == MAJOR {
        return Ok(());
    }
    let message = format!(
        "the library has version {major}.{minor} and version {MAJOR} can be read; use a program that reads it"
    );
    let rule = rule::LIBRARY_VERSION_UNSUPPORTED;
    Err(Fault::new(rule, PLACE, message))
}

fn check_sum(bytes: &[u8; HEADER_BYTES]) -> Result<(), Fault> {
    let (found, stated) = (crc32(&bytes[..124]), u32_at(bytes, 124));
    if found == stated {
        return Ok(());
    }
    let message =
        format!("its checksum is {found:08x} instead of {stated:08x}; get the file again");
    Err(Fault::new(rule::LIBRARY_HEADER_CHECKSUM, PLACE, message))
}

fn invalid(problem: &str) -> Fault {
    let message = format!("{problem}; pack the library again");
    Fault::new(rule::LIBRARY_HEADER_INVALID, PLACE, message)
}

fn u16_at(bytes: &[u8; HEADER_BYTES], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

fn u32_at(bytes: &[u8; HEADER_BYTES], at: usize) -> u32 {
    u32::from(u16_at(bytes, at)) | u32::from(u16_at(bytes, at + 2)) << 16
}

fn u64_at(bytes: &[u8; HEADER_BYTES], at: usize) -> u64 {
    u64::from(u32_at(bytes, at)) | u64::from(u32_at(bytes, at + 4)) << 32
}
