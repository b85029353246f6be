//! Wraps fuzzed parts in containers with valid checksums, which a fuzzer would not find.
//! Modules are built from well-typed bodies, so that mutations reach the code after the checks.

use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

const MEDIA_TYPE: &[u8] = b"application/vnd.htex+zip";

/// Makes a valid archive from a manifest and other entries, all stored without compression.
pub fn container<'a>(
    manifest: &'a [u8],
    entries: impl IntoIterator<Item = (&'a str, &'a [u8])>,
) -> Vec<u8> {
    let first = [("mimetype", MEDIA_TYPE), ("manifest.json", manifest)];
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .system(System::Unix)
        .unix_permissions(0o644);
    for (name, bytes) in first.into_iter().chain(entries) {
        // This writer refuses duplicate names, so `open_asset` covers those.
        if writer.start_file(name, options).is_ok() {
            writer.write_all(bytes).expect("memory takes all");
        }
    }
    writer.finish().expect("memory takes all").into_inner()
}

/// Returns the same archive with valid checksums, for all stored entries that can be found.
pub fn with_checksums(bytes: &[u8]) -> Vec<u8> {
    const LOCAL: &[u8] = b"PK\x03\x04";
    const CENTRAL: &[u8] = b"PK\x01\x02";
    let mut mended = bytes.to_vec();
    let mut sums = Vec::new();
    let mut at = 0;
    while let Some(header) = mended.get(at..at + 30) {
        if header.starts_with(CENTRAL) {
            let Some(directory) = mended.get_mut(at..at + 46) else {
                break;
            };
            if !sums.is_empty() {
                directory[16..20].copy_from_slice(&u32::to_le_bytes(sums.remove(0)));
            }
            at += 46 + [28, 30, 32].map(|i| u16_at(&mended, at + i)).iter().sum::<usize>();
        } else if header.starts_with(LOCAL) {
            let is_stored = u16_at(&mended, at + 8) == 0;
            let size = u16_at(&mended, at + 18) + (u16_at(&mended, at + 20) << 16);
            let data = at + 30 + u16_at(&mended, at + 26) + u16_at(&mended, at + 28);
            let sum = match mended.get(data..data.saturating_add(size)) {
                Some(stored) if is_stored => crc32fast::hash(stored),
                _ => u32::from_le_bytes([header[14], header[15], header[16], header[17]]),
            };
            mended[at + 14..at + 18].copy_from_slice(&sum.to_le_bytes());
            sums.push(sum);
            at = data.saturating_add(size);
        } else {
            break;
        }
    }
    mended
}

fn u16_at(bytes: &[u8], at: usize) -> usize {
    let two = bytes.get(at..at + 2).unwrap_or(&[0, 0]);
    usize::from(u16::from_le_bytes([two[0], two[1]]))
}
