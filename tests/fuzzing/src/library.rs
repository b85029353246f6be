//! Libraries: whole files, and files built around fuzzed pages.

use htex_base::finding::Report;
use htex_format::library::{
    Library, LibraryError, Limits, MAGIC, Writer, check_name, validate_source,
};

use crate::promise;

/// Smaller than the defaults, so that short inputs reach slow paths.
const LIMITS: Limits = Limits {
    entries: 1 << 12,
    leaves: 64,
    root_bytes: 1 << 14,
    leaf_bytes: 1 << 14,
    asset_bytes: 1 << 16,
    objects: 64,
    ratio: 10,
};
/// Number of textures that are read by name.
const READ: usize = 32;
const HEADER_BYTES: usize = 128;

/// The input's first byte determines how the rest is used; its third bit, whether what is built around
/// the rest is of version 1.1.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Around {
    /// The rest is a file.
    File,
    /// The rest is a file; its header gets a valid checksum.
    Header,
    /// The rest is a leaf page, shared objects and payload. The lengths of the first two come
    /// before them (16 bits each).
    Leaf,
    /// The rest is a root page, in front of the leaf pages of [`leaves`].
    Root,
}

impl Around {
    const ALL: [Self; 4] = [Self::File, Self::Header, Self::Leaf, Self::Root];

    /// Returns the input that uses `rest` in this way, in a library of version 1.`minor`.
    pub(crate) fn input(self, rest: &[u8], minor: u8) -> Vec<u8> {
        [&[self as u8 + minor * Self::ALL.len() as u8], rest].concat()
    }

    fn file(self, rest: &[u8], minor: u8) -> Option<Vec<u8>> {
        Some(match self {
            Self::File => rest.to_vec(),
            Self::Header => with_checksum(rest),
            Self::Leaf => {
                let (lengths, parts) = rest.split_first_chunk::<4>()?;
                let [leaf, shared] =
                    [0, 2].map(|i| usize::from(u16::from_le_bytes([lengths[i], lengths[i + 1]])));
                let (leaf, rest) = parts.split_at_checked(leaf)?;
                let (shared, payload) = rest.split_at_checked(shared)?;
                let entries = leaf.first().map_or(0, |count| u64::from(count & 0x7f));
                let leaf = page(leaf);
                // A name, one leaf, an empty separator, the leaf's length.
                let mut root = vec![1, b'L', 1, 0, 0];
                let length = leaf.len();
                root.extend([
                    length as u8 | 0x80,
                    (length >> 7) as u8 | 0x80,
                    (length >> 14) as u8,
                ]);
                if length < 1 << 14 {
                    root.truncate(7);
                    root[6] &= 0x7f;
                }
                if minor > 0 {
                    // Metadata, and no spectra.
                    root.extend(b"\x02{}\0");
                    root.extend(blake3::hash(&[]).as_bytes());
                }
                file(&page(&root), &leaf, shared, payload, (entries, 1), minor)
            }
            Self::Root => {
                let leaves = leaves(minor);
                let shared = spectra().concat();
                let shared = if minor > 0 { &shared[..] } else { &[] };
                file(&page(rest), &leaves.concat(), shared, &[], (2, 2), minor)
            }
        })
    }
}

/// Pages with a spectrum for each of the [`leaves`].
pub(crate) fn spectra() -> [Vec<u8>; 2] {
    [1.5f32, -40.0].map(|largest| page(&[&[1, 1][..], &largest.to_le_bytes(), &[255; 48]].concat()))
}

/// Two leaf pages with an empty texture each, `a` and `b`.
pub(crate) fn leaves(minor: u8) -> [Vec<u8>; 2] {
    // No rights, no licence, no author, a quantity, no felt difference.
    let newer: &[u8] = if minor > 0 { &[0; 5] } else { &[] };
    // One entry, no words, its name, no tags, no models, no conditions, a law of zeros, no bytes,
    // no objects, a hash.
    [b'a', b'b'].map(|name| {
        let before = [1, 0, 0, 1, name, 0, 0, 0];
        let law = [0; 1 + 3 * 8];
        page(&[&before[..], &law, &[0, 0, 0], &[7; 32], newer].concat())
    })
}

/// Opens a library and reads it as far as an application would. If it is valid, it is also packed
/// again.
pub fn library(input: &[u8]) -> bool {
    let Some((kind, rest)) = input.split_first() else {
        return false;
    };
    let around = Around::ALL[usize::from(*kind) % Around::ALL.len()];
    let minor = *kind / Around::ALL.len() as u8 % 2;
    let Some(file) = around.file(rest, minor) else {
        return false;
    };
    let report = validate_source(file.as_slice(), &LIMITS).expect("memory can be read");
    promise::findings(&report.findings);
    match Library::open_source_with(file.as_slice(), LIMITS) {
        Ok(library) => read(&library, &report),
        Err(error) => {
            promise::sentence(&error);
            assert!(!report.valid, "valid, and does not open: {error}");
            false
        }
    }
}

/// Reads all entries and some textures. Returns true if there are entries.
fn read(library: &Library<&[u8]>, report: &Report) -> bool {
    let refused = |error: LibraryError| {
        promise::sentence(&error);
        assert!(!report.valid, "valid, and cannot be read: {error}");
    };
    let (mut before, mut count) = (String::new(), 0);
    for entry in library.entries() {
        let entry = match entry {
            Ok(entry) => entry,
            Err(error) => {
                refused(error);
                return count > 0;
            }
        };
        assert!(entry.name > before && check_name(&entry.name).is_ok(), "{:?}", entry.name);
        if count < READ {
            let found = library.entry(&entry.name).expect("its page was read");
            assert_eq!(found.as_ref(), Some(&entry));
            match library.read(&entry) {
                Ok(bytes) => assert_eq!(bytes.len() as u64, entry.bytes),
                Err(error) => refused(error),
            }
        }
        before = entry.name;
        count += 1;
    }
    let described = library.described().map(|described| described.map(|(entry, _)| entry.name));
    match described.collect::<Result<Vec<_>, _>>() {
        Ok(names) => assert_eq!(names.len(), count),
        Err(error) => refused(error),
    }
    if report.valid {
        assert_eq!(count as u64, library.len());
        pack_again(library);
    }
    count > 0
}

/// The textures of a valid library can be packed, and the new library has the same textures.
fn pack_again(library: &Library<&[u8]>) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("again.htexlib");
    let mut writer = Writer::create(&path, library.name()).expect("its name is allowed");
    writer.allow_unlicensed();
    for entry in library.entries() {
        let entry = entry.expect("it was read before");
        let bytes = library.read(&entry).expect("it was read before");
        writer.add(&entry.name, &bytes).expect("it is valid");
    }
    writer.finish().expect("it can be written");
    let again = Library::open(&path).expect("what is written can be opened");
    let facts = |entry: Result<htex_format::library::Entry, _>| {
        let entry = entry.expect("it can be read");
        (
            entry.name,
            entry.tags,
            entry.models,
            entry.conditions,
            (entry.contact, entry.law),
            entry.blake3,
        )
    };
    assert!(library.entries().map(facts).eq(again.entries().map(facts)));
}

/// Makes an index page with a valid checksum, not compressed: a deflate stream of stored blocks.
pub(crate) fn page(contents: &[u8]) -> Vec<u8> {
    let mut page = (contents.len() as u32).to_le_bytes().to_vec();
    let blocks = contents.chunks(usize::from(u16::MAX));
    let last = blocks.len().saturating_sub(1);
    if contents.is_empty() {
        page.extend([1, 0, 0, 0xff, 0xff]);
    }
    for (i, block) in blocks.enumerate() {
        let length = block.len() as u16;
        page.push(u8::from(i == last));
        page.extend(length.to_le_bytes());
        page.extend((!length).to_le_bytes());
        page.extend(block);
    }
    [&crc32fast::hash(&page).to_le_bytes(), &page[..]].concat()
}

/// Makes a file from these parts with a valid header. `counts` are the numbers of entries and
/// leaves.
fn file(
    root: &[u8],
    leaves: &[u8],
    shared: &[u8],
    payload: &[u8],
    counts: (u64, u32),
    minor: u8,
) -> Vec<u8> {
    let mut file = MAGIC.to_vec();
    file.extend([1, 0, minor, 0, 0, 0, 0, 0]);
    let mut at = HEADER_BYTES as u64;
    for part in [root, leaves, shared, payload] {
        file.extend(at.to_le_bytes());
        file.extend((part.len() as u64).to_le_bytes());
        at += part.len() as u64;
    }
    file.extend(counts.0.to_le_bytes());
    file.extend(counts.1.to_le_bytes());
    let index = [root, leaves].concat();
    file.extend(blake3::hash(&index).as_bytes());
    file.extend([0; 4]);
    with_checksum(&[&file, &index, shared, payload].concat())
}

/// Returns the file with a valid header checksum.
fn with_checksum(file: &[u8]) -> Vec<u8> {
    let mut file = file.to_vec();
    if let Some((header, _)) = file.split_first_chunk_mut::<HEADER_BYTES>() {
        let crc = crc32fast::hash(&header[..HEADER_BYTES - 4]);
        header[HEADER_BYTES - 4..].copy_from_slice(&crc.to_le_bytes());
    }
    file
}
