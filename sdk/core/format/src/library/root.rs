//! The root page of the index. It contains the library's name and metadata and, for each leaf page,
//! the length of the page and a separator. Each name on a leaf page equals the page's separator or
//! sorts after it.
//!
//! Even for a library of a million textures, the root page fits into the first 16 KiB of the file,
//! so that the first read contains it.

use std::ops::Range;

use crate::library::fault::{Fault, leaf_place, spectra_place};
use crate::library::header::Header;
use crate::library::metadata::{LibraryMetadata, METADATA_BYTES};
use crate::library::name::check_library_name;
use crate::library::page;
use crate::library::rules as rule;
use crate::library::wire::{Cursor, WireError};

/// Place of the root page, as written in findings.
pub(crate) const PLACE: &str = "/root";

#[derive(Debug, Clone)]
pub(crate) struct Root {
    /// Name of the library.
    pub name: String,
    /// A separator for each leaf. The separator equals the leaf's first name or sorts before it,
    /// and sorts after all names of the previous leaves.
    separators: Texts,
    /// Offsets of the leaves in the file, followed by the end of the last leaf.
    offsets: Vec<u64>,
    /// The library's metadata.
    // The metadata are in a box, so that the type of an open library is not much larger than the
    // type of a library that is being opened.
    pub metadata: Box<LibraryMetadata>,
    /// Offsets, in the file, of the spectra of each leaf, followed by the end of the last leaf's
    /// spectra.
    spectra: Vec<u64>,
    /// BLAKE3 of all spectra.
    pub spectra_blake3: [u8; 32],
}

impl Root {
    /// Decodes the unpacked page.
    pub(crate) fn read(page: &[u8], header: &Header, leaf_bytes: u64) -> Result<Self, Fault> {
        let mut cursor = Cursor::new(page);
        let malformed = |m| Fault::page(PLACE, m);
        let name = cursor.text().map_err(malformed)?.to_owned();
        if let Err(problem) = check_library_name(&name) {
            let message = format!("the library's name is not allowed: {problem}");
            return Err(Fault::new(rule::LIBRARY_NAME_INVALID, PLACE, message));
        }
        // Each leaf has three numbers of at least one byte: two lengths for its separator, and the
        // length of the leaf itself.
        let count = cursor.count(3).map_err(malformed)?;
        if count as u64 != u64::from(header.leaf_count) {
            let message = format!(
                "it has {count} leaves and the header states {}; pack the library again",
                header.leaf_count
            );
            return Err(Fault::new(rule::LIBRARY_COUNT_WRONG, PLACE, message));
        }
        let separators = Texts::read(&mut cursor, count)?;
        let offsets = offsets(&mut cursor, count, header, leaf_bytes)?;
        let mut root = Self {
            name,
            separators,
            offsets,
            metadata: Box::default(),
            spectra: vec![header.shared.end; count + 1],
            spectra_blake3: NO_SPECTRA,
        };
        if header.minor > 0 {
            root.metadata = Box::new(metadata(&mut cursor)?);
            root.spectra = spectra(&mut cursor, count, header, leaf_bytes)?;
            root.spectra_blake3 = cursor.array().map_err(malformed)?;
        }
        if header.minor <= crate::library::header::MINOR && cursor.rest() > 0 {
            return Err(malformed(cursor.malformed("bytes follow the last value")));
        }
        Ok(root)
    }

    pub(crate) fn leaves(&self) -> usize {
        self.separators.len()
    }

    /// Returns the byte range of a leaf in the file.
    pub(crate) fn leaf(&self, leaf: usize) -> Option<Range<u64>> {
        Some(*self.offsets.get(leaf)?..*self.offsets.get(leaf + 1)?)
    }

    /// Returns where in the file the spectra of a leaf's entries are, as a byte range. Returns
    /// `None` if no entry of the leaf has a spectrum.
    pub(crate) fn spectra(&self, leaf: usize) -> Option<Range<u64>> {
        let range = *self.spectra.get(leaf)?..*self.spectra.get(leaf + 1)?;
        Some(range).filter(|range| !range.is_empty())
    }

    /// Returns where the spectra begin in the file, which is where the shared objects end.
    pub(crate) fn spectra_start(&self) -> u64 {
        self.spectra.first().copied().unwrap_or_default()
    }

    /// Returns the leaf that contains the name, if any leaf does.
    pub(crate) fn leaf_of(&self, name: &[u8]) -> Option<usize> {
        let count = self.leaves();
        let (mut low, mut high) = (0, count);
        while low < high {
            let middle = low + (high - low) / 2;
            if self.separators.get(middle).is_some_and(|s| s <= name) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low.checked_sub(1)
    }

    /// Returns the smallest name that a leaf may contain, and the smallest name that belongs to the
    /// next leaf (`None` for the last leaf).
    pub(crate) fn bounds(&self, leaf: usize) -> (&[u8], Option<&[u8]>) {
        let low = self.separators.get(leaf).unwrap_or_default();
        (low, self.separators.get(leaf + 1))
    }
}

/// BLAKE3 of no bytes.
const NO_SPECTRA: [u8; 32] = [
    0xaf, 0x13, 0x49, 0xb9, 0xf5, 0xf9, 0xa1, 0xa6, 0xa0, 0x40, 0x4d, 0xea, 0x36, 0xdc, 0xc9, 0x49,
    0x9b, 0xcb, 0x25, 0xc9, 0xad, 0xc1, 0x12, 0xb7, 0xcc, 0x9a, 0x93, 0xca, 0xe4, 0x1f, 0x32, 0x62,
];

fn metadata(cursor: &mut Cursor<'_>) -> Result<LibraryMetadata, Fault> {
    let malformed = |m: WireError| Fault::page(PLACE, m);
    let length = cursor.count(1).map_err(malformed)?;
    if length > METADATA_BYTES {
        return Err(malformed(cursor.malformed("the metadata exceeds 8192 bytes")));
    }
    let json = cursor.read_bytes(length).map_err(malformed)?;
    // The metadata are parsed by the reader of manifests, so that modules for the web contain only
    // one parser.
    let read = crate::parse_json(json).map_err(|error| error.to_string()).and_then(|value| {
        // A type with a derived `Deserialize` would also accept an array of its values.
        if !value.is_object() {
            return Err("it is not an object".to_owned());
        }
        serde_json::from_value::<LibraryMetadata>(value).map_err(|error| error.to_string())
    });
    read.and_then(|metadata| metadata.check().map(|()| metadata)).map_err(|problem| {
        let message = format!("the library's metadata: {problem}; pack the library again");
        Fault::new(rule::LIBRARY_METADATA_INVALID, PLACE, message)
    })
}

/// Reads the lengths of the spectra and returns their offsets. The spectra are at the end of the
/// shared part.
fn spectra(
    cursor: &mut Cursor<'_>,
    count: usize,
    header: &Header,
    leaf_bytes: u64,
) -> Result<Vec<u64>, Fault> {
    let (mut lengths, mut total) = (Vec::with_capacity(count), 0u64);
    for leaf in 0..count {
        let length = cursor.varint().map_err(|m| Fault::page(PLACE, m))?;
        page::check_packed_size(length, leaf_bytes, &spectra_place(leaf))?;
        total = total.saturating_add(length);
        lengths.push(length);
    }
    let Some(mut at) = header.shared.end.checked_sub(total).filter(|at| *at >= header.shared.start)
    else {
        let message = format!(
            "the spectra have {total} bytes, more than the shared part; pack the library again"
        );
        return Err(Fault::new(rule::LIBRARY_HEADER_INVALID, PLACE, message));
    };
    let ends = lengths.into_iter().map(|length| {
        at += length;
        at
    });
    let start = header.shared.end - total;
    Ok(std::iter::once(start).chain(ends.collect::<Vec<_>>()).collect())
}

/// Reads the lengths of the leaves and returns their offsets.
fn offsets(
    cursor: &mut Cursor<'_>,
    count: usize,
    header: &Header,
    leaf_bytes: u64,
) -> Result<Vec<u64>, Fault> {
    let mut offsets = vec![header.leaves.start];
    let mut at = header.leaves.start;
    for leaf in 0..count {
        let length = cursor.varint().map_err(|m| Fault::page(PLACE, m))?;
        // The sizes of all leaves are checked here, so that reading a leaf later needs no check of
        // its size.
        page::check_packed_size(length, leaf_bytes, &leaf_place(leaf))?;
        at = at.saturating_add(length);
        offsets.push(at);
    }
    if at == header.leaves.end {
        return Ok(offsets);
    }
    let message = format!(
        "the leaves end at byte {at} and the header states {}; pack the library again",
        header.leaves.end
    );
    Err(Fault::new(rule::LIBRARY_HEADER_INVALID, PLACE, message))
}

/// Sorted texts, all in one buffer.
#[derive(Debug, Clone)]
struct Texts {
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

impl Texts {
    /// Reads `count` texts. The first text must be empty, and each text must sort after the text
    /// before it.
    fn read(cursor: &mut Cursor<'_>, count: usize) -> Result<Self, Fault> {
        let (mut bytes, mut ends) = (Vec::new(), Vec::with_capacity(count));
        let mut text = Vec::new();
        for leaf in 0..count {
            let before = text.clone();
            cursor.following(&mut text).map_err(|m| Fault::page(PLACE, m))?;
            // The first separator is empty, so every name equals it or sorts after it. Therefore,
            // every name belongs to a leaf. All other separators are not empty.
            if (leaf == 0) != text.is_empty() || leaf > 0 && text <= before {
                let message = format!(
                    "the first name of leaf {leaf} is not above the one before; pack the library again"
                );
                return Err(Fault::new(rule::LIBRARY_ORDER_INVALID, PLACE, message));
            }
            bytes.extend_from_slice(&text);
            ends.push(bytes.len());
        }
        Ok(Self { bytes, ends })
    }

    fn len(&self) -> usize {
        self.ends.len()
    }

    fn get(&self, index: usize) -> Option<&[u8]> {
        let end = *self.ends.get(index)?;
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        self.bytes.get(start..end)
    }
}
