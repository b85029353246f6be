//! Archives and entries that each break a rule.

use super::cases::Named;
use super::parts::{with_bytes, with_parts};
use super::raw_zip::Entry;

pub(super) fn archives() -> Vec<Named> {
    vec![
        ("archive_invalid", b"This is no archive, but a text.".to_vec()),
        ("archive_invalid_cut_off", with_bytes(|b| b.truncate(b.len() - 9))),
        (
            "archive_invalid_directory",
            with_bytes(|b| {
                let directory = b.windows(4).position(|w| w == b"PK\x01\x02").unwrap();
                b[directory] = b'Q';
            }),
        ),
        ("archive_extra_data_after", with_bytes(|b| b.extend(b"more"))),
        (
            "archive_extra_data_before",
            with_bytes(|b| {
                b.splice(0..0, *b"#!/bin/sh\n");
            }),
        ),
        (
            "archive_zip64",
            with_bytes(|b| {
                let end = b.len() - 22;
                b[end + 16..end + 20].fill(0xFF);
            }),
        ),
    ]
}

pub(super) fn entries() -> Vec<Named> {
    let named = |name: &'static [u8]| {
        with_parts(move |p| p.push(Entry::stored("", b"x").with(|h| h.name = name.to_vec())))
    };
    let changed = |change: fn(&mut Entry)| with_parts(move |p| change(&mut p[2]));
    vec![
        ("entry_name_unsafe", named(b"../outside.bin")),
        ("entry_name_unsafe_absolute", named(b"/etc/passwd")),
        ("entry_name_unsafe_backslash", named(b"..\\outside.bin")),
        ("entry_name_unsafe_drive", named(b"C:outside.bin")),
        ("entry_name_unsafe_nul", named(b"a.bin\0.txt")),
        ("entry_name_duplicate", named(b"Manifest.JSON")),
        ("entry_unreferenced", named(b"notes.txt")),
        (
            "entry_encrypted_and_others",
            with_parts(|p| {
                p[1] = p[1].clone().with(|h| h.flags = 1 | 8);
                p[2] = p[2].clone().with(|h| h.method = 93);
                p[2].data[0] ^= 1;
            }),
        ),
        (
            "mimetype_wrong_and_others",
            with_parts(|p| {
                p[0] = Entry::stored("mimetype", b"application/zip");
                p[1] = Entry::stored("manifest.json", b"{}");
            }),
        ),
        ("entry_encrypted", changed(|e| *e = e.clone().with(|h| h.flags = 1))),
        ("entry_compression_unknown", changed(|e| *e = e.clone().with(|h| h.method = 93))),
        ("entry_data_descriptor", changed(|e| *e = e.clone().with(|h| h.flags = 8))),
        ("entry_extra_field", changed(|e| e.central.extra = vec![0x55, 0x54, 0, 0])),
        ("entry_extra_field_local", changed(|e| e.local.extra = vec![0x55, 0x54, 0, 0])),
        (
            "entry_header_mismatch_stored",
            changed(|e| {
                e.local.size += 1;
                e.central.size += 1;
            }),
        ),
        ("entry_header_mismatch", changed(|e| e.local.name[0] = b'P')),
        ("entry_header_mismatch_size", changed(|e| e.local.size += 1)),
        ("entry_corrupt", changed(|e| e.data[3] ^= 1)),
        (
            "entry_corrupt_unreferenced",
            with_parts(|p| {
                let mut notes = Entry::stored("notes.txt", b"x");
                notes.data[0] ^= 1;
                p.push(notes);
            }),
        ),
        (
            "entry_corrupt_deflate",
            with_parts(|p| {
                p[1] = deflated(&p[1]);
                p[1].data[0] = 7;
            }),
        ),
        (
            "entry_corrupt_trailing",
            with_parts(|p| {
                p[1] = deflated(&p[1]);
                p[1].data.extend(b"more");
                let packed = p[1].data.len() as u32;
                p[1] = p[1].clone().with(|h| h.packed = packed);
            }),
        ),
        ("mimetype_missing", with_parts(|p| p.truncate_front(1))),
        ("mimetype_not_first", with_parts(|p| p.swap(0, 1))),
        ("mimetype_compressed", with_parts(|p| p[0] = deflated(&p[0]))),
        ("mimetype_wrong", with_parts(|p| p[0] = Entry::stored("mimetype", b"application/zip"))),
        (
            "manifest_missing",
            with_parts(|p| {
                p.remove(1);
            }),
        ),
        ("entry_missing", with_parts(|p| p.truncate(2))),
    ]
}

trait TruncateFront {
    fn truncate_front(&mut self, count: usize);
}

impl TruncateFront for Vec<Entry> {
    fn truncate_front(&mut self, count: usize) {
        self.drain(..count);
    }
}

/// Returns the entry with its data as a deflate stream that has one stored block (RFC 1951, section
/// 3.2.4).
pub(super) fn deflated(entry: &Entry) -> Entry {
    let length = entry.data.len() as u16;
    let mut data = vec![1];
    data.extend(length.to_le_bytes());
    data.extend((!length).to_le_bytes());
    data.extend(&entry.data);
    let packed = data.len() as u32;
    let headers = entry.clone().with(|h| {
        h.method = 8;
        h.packed = packed;
    });
    Entry { data, ..headers }
}
