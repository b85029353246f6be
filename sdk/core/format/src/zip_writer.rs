//! Writes ZIP archives in the strict form that the module `archive` requires. The same entries give
//! the same bytes on every machine.

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::DeflateEncoder;

use crate::unpack::{DEFLATED, STORED, crc32};
use crate::zip_records::{CENTRAL, Common, END, LOCAL};

/// Compression level. zlib-rs chooses the same matches on every processor, so the bytes are the
/// same everywhere. Zopfli would take 100 ms per asset and save five bytes.
const DEFLATE_LEVEL: u32 = 9;

/// 1 January 1980, 0:00, the earliest time that ZIP can express.
const NO_TIME: u32 = 33 << 16;

/// ZIP version needed to unpack a stored entry and a deflated entry: 1.0 and 2.0.
const VERSIONS: [u16; 2] = [10, 20];
/// Code of the system that wrote the archive: Unix, so that the attributes are Unix attributes.
const UNIX: u16 = 3 << 8;
/// Unix attributes of a regular file that everyone may read and only its owner may write.
const ATTRIBUTES: u32 = 0o100_644 << 16;

/// An archive that is being written.
#[derive(Default)]
pub(crate) struct ZipWriter {
    bytes: Vec<u8>,
    /// The records of the directory.
    directory: Vec<u8>,
    entries: usize,
}

impl ZipWriter {
    /// Adds an entry uncompressed.
    pub(crate) fn store(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        self.add(name, bytes, STORED, bytes)
    }

    /// Adds an entry, compressed.
    pub(crate) fn deflate(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::new(DEFLATE_LEVEL));
        encoder.write_all(bytes)?;
        self.add(name, bytes, DEFLATED, &encoder.finish()?)
    }

    fn add(&mut self, name: &str, bytes: &[u8], method: u16, packed: &[u8]) -> io::Result<()> {
        let common = Common {
            flags: 0,
            method,
            time_date: NO_TIME,
            crc: crc32(bytes),
            packed: small(packed.len())?,
            size: small(bytes.len())?,
        };
        let local_at = small(self.bytes.len())?;
        put_local(&mut self.bytes, &common, short(name.len())?, name);
        self.bytes.extend_from_slice(packed);
        put_central(&mut self.directory, &common, short(name.len())?, name, local_at);
        self.entries += 1;
        Ok(())
    }

    /// Returns the archive.
    pub(crate) fn finish(mut self) -> io::Result<Vec<u8>> {
        let directory_at = small(self.bytes.len())?;
        let directory_bytes = small(self.directory.len())?;
        self.bytes.append(&mut self.directory);
        put_end(&mut self.bytes, short(self.entries)?, directory_bytes, directory_at);
        Ok(self.bytes)
    }
}

/// Converts a size to 32 bits. Without ZIP64, sizes must be below 4 GiB.
fn small(size: usize) -> io::Result<u32> {
    u32::try_from(size).map_err(|_| io::Error::other("the archive has 4 GiB or more"))
}

/// Converts the length of a name, or the number of entries, to 16 bits.
fn short(size: usize) -> io::Result<u16> {
    u16::try_from(size)
        .map_err(|_| io::Error::other("a name or the number of entries exceeds 65,535"))
}

/// Writes a local header. The entry's data follow it.
fn put_local(out: &mut Vec<u8>, common: &Common, name_len: u16, name: &str) {
    put_u32(out, LOCAL);
    put_u16(out, [version(common)]);
    put_common(out, common);
    put_u16(out, [name_len, 0]);
    out.extend_from_slice(name.as_bytes());
}

/// Writes a directory record.
fn put_central(out: &mut Vec<u8>, common: &Common, name_len: u16, name: &str, local_at: u32) {
    put_u32(out, CENTRAL);
    put_u16(out, [UNIX | version(common), version(common)]);
    put_common(out, common);
    // The zeros mean: no extra field, no comment, the first disk, no internal attributes.
    put_u16(out, [name_len, 0, 0, 0, 0]);
    put_u32(out, ATTRIBUTES);
    put_u32(out, local_at);
    out.extend_from_slice(name.as_bytes());
}

/// Writes the end record.
fn put_end(out: &mut Vec<u8>, entries: u16, directory_bytes: u32, directory_at: u32) {
    put_u32(out, END);
    put_u16(out, [0, 0, entries, entries]);
    put_u32(out, directory_bytes);
    put_u32(out, directory_at);
    put_u16(out, [0]);
}

fn version(common: &Common) -> u16 {
    VERSIONS[usize::from(common.method != 0)]
}

fn put_common(out: &mut Vec<u8>, common: &Common) {
    put_u16(out, [common.flags, common.method]);
    for number in [common.time_date, common.crc, common.packed, common.size] {
        put_u32(out, number);
    }
}

fn put_u16<const N: usize>(out: &mut Vec<u8>, numbers: [u16; N]) {
    out.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
}

fn put_u32(out: &mut Vec<u8>, number: u32) {
    out.extend_from_slice(&number.to_le_bytes());
}
