//! The conformance files: valid libraries, and files that each break a rule.

use std::collections::BTreeMap;

use htex_base::finding::{FileReport, Report};
use htex_format::library::{Limits, validate_source};
use serde_json::json;

use super::edges;
use super::raw::{Raw, crc32};
use super::{Texture, four_described, module, pack, pack_bytes, texture};

/// A conformance file.
pub struct Case {
    pub name: String,
    pub bytes: Vec<u8>,
    pub limits: Limits,
}

impl Case {
    pub fn report(&self) -> Report {
        validate_source(self.bytes.as_slice(), &self.limits).unwrap()
    }

    /// The expected report, as pretty JSON.
    pub fn golden(&self) -> String {
        let report = FileReport {
            limits: overrides(&self.limits),
            ..self.report().of_file(&format!("{}.htexlib", self.name))
        };
        serde_json::to_string_pretty(&json!(report)).unwrap() + "\n"
    }
}

fn overrides(limits: &Limits) -> BTreeMap<String, u64> {
    let all =
        super::cases::limits(limits).into_iter().zip(super::cases::limits(&Limits::default()));
    all.filter(|(ours, default)| ours != default)
        .map(|((name, ours), _)| (name.to_owned(), ours))
        .collect()
}

/// All limits by name.
pub fn limits(limits: &Limits) -> [(&'static str, u64); 7] {
    [
        ("entries", limits.entries),
        ("leaves", limits.leaves),
        ("root_bytes", limits.root_bytes),
        ("leaf_bytes", limits.leaf_bytes),
        ("asset_bytes", limits.asset_bytes),
        ("objects", limits.objects),
        ("ratio", limits.ratio),
    ]
}

/// All conformance files.
pub fn cases() -> Vec<Case> {
    let named =
        valid().into_iter().chain(files()).chain(pages()).chain(entries()).chain(edges::edges());
    let mut cases: Vec<Case> =
        named.map(|(name, bytes)| case(name, bytes, Limits::default())).collect();
    let limits = limited().into_iter();
    cases.extend(limits.chain(edges::limited().into_iter().map(|(n, b, l)| case(n, b, l))));
    cases
}

pub type Named = (&'static str, Vec<u8>);

fn case(name: &str, bytes: Vec<u8>, limits: Limits) -> Case {
    Case { name: name.to_owned(), bytes, limits }
}

/// Four textures: three in folders, one of them at two speeds.
pub fn four() -> Vec<Texture> {
    let mut four = ["felt", "wood/birch", "wood/oak", "wood/Ölweide"].map(texture).to_vec();
    four[1].speeds_mm_s = vec![40.0, 120.0];
    four[1].tags = Vec::new();
    four[3].tags = vec!["wood".to_owned()];
    four
}

/// Three textures, two of which embed the same module.
pub fn sharing() -> Vec<Texture> {
    let mut three = ["a", "b", "c"].map(texture).to_vec();
    three[0].modules = vec![module(1, 300)];
    three[2].modules = vec![module(2, 200), module(1, 300)];
    three
}

/// Textures under two names each, one of them with a module.
fn equal() -> Vec<u8> {
    let (felt, shared) = (texture("felt").bytes(), sharing()[2].bytes());
    let names = ["felt", "felt again", "shared", "wood/shared"].map(str::to_owned);
    pack_bytes("Equal", names.iter().zip([&felt, &felt, &shared, &shared])).1
}

fn raw() -> Raw {
    Raw::of(&four(), 2)
}

/// Spectra of one leaf of two, two errors and metadata with an unknown key.
fn described() -> Raw {
    raw().with(|raw| {
        let mut levels = [0; 48];
        levels.iter_mut().enumerate().for_each(|(i, level)| *level = 255 - 5 * i as u8);
        raw.spectra = vec![vec![None, Some((-34.5, levels))]];
        raw.leaves[0][1].felt = 152;
        raw.leaves[0][1].held_out = 301;
        raw.metadata = br#"{"version":"2","mood":["calm"]}"#.to_vec();
    })
}

fn valid() -> Vec<Named> {
    vec![
        ("valid_empty", pack("", &[]).1),
        ("valid_one", pack("One", &four()[..1]).1),
        ("valid_four", pack("Four", &four()).1),
        ("valid_shared", pack("Shared", &sharing()).1),
        ("valid_equal", equal()),
        ("valid_small_leaves", raw().bytes()),
        ("valid_described", four_described()),
        ("valid_described_leaf", described().bytes()),
        ("valid_version_1_0", raw().with(|raw| raw.version.1 = 0).bytes()),
        (
            "valid_newer_minor",
            raw()
                .with(|raw| {
                    raw.version.1 = 7;
                    raw.pages = vec![(0, |page| page.push(9)), (2, |page| page.extend([1, 2]))];
                    raw.header = Some(|header| header[12] = 1);
                })
                .bytes(),
        ),
    ]
}

/// Files that are damaged as a whole, or in the header.
fn files() -> Vec<Named> {
    let changed = |change: fn(&mut Vec<u8>)| {
        let mut bytes = raw().bytes();
        change(&mut bytes);
        bytes
    };
    let header = |change: fn(&mut Vec<u8>)| raw().with(|raw| raw.header = Some(change)).bytes();
    vec![
        ("library_unrecognised", b"This is no library, but a text.".to_vec()),
        ("library_unrecognised_empty", Vec::new()),
        (
            "library_unrecognised_as_text",
            changed(|bytes| {
                bytes.remove(4);
            }),
        ),
        ("library_truncated", changed(|bytes| bytes.truncate(bytes.len() - 9))),
        ("library_truncated_header", changed(|bytes| bytes.truncate(100))),
        ("library_extra_data", changed(|bytes| bytes.extend(b"more"))),
        ("library_version_unsupported", header(|header| header[8] = 2)),
        ("library_header_checksum", changed(|bytes| bytes[81] ^= 1)),
        ("library_header_invalid_gap", header(|header| header[32] += 1)),
        ("library_header_invalid_reserved", header(|header| header[13] = 1)),
        ("library_header_invalid_overflow", header(|header| header[72..80].fill(0xff))),
        ("library_header_invalid_counts", header(|header| header[80..84].fill(0))),
        ("library_count_wrong", header(|header| header[80] += 1)),
        ("library_count_wrong_leaves", header(|header| header[88] += 1)),
        ("library_index_changed", raw().with(|raw| raw.index_blake3 = Some([7; 32])).bytes()),
        (
            "library_entries_too_many",
            header(|header| header[80..88].copy_from_slice(&(1u64 << 40).to_le_bytes())),
        ),
    ]
}

fn metadata(json: &[u8]) -> Vec<u8> {
    raw().with(|raw| raw.metadata = json.to_vec()).bytes()
}

/// Files with a bad page.
fn pages() -> Vec<Named> {
    let page = |number: usize, change: fn(&mut Vec<u8>)| {
        raw().with(|raw| raw.pages = vec![(number, change)]).bytes()
    };
    let stream = |number: usize, change: fn(&mut Vec<u8>)| {
        raw().with(|raw| raw.streams = vec![(number, change)]).bytes()
    };
    vec![
        ("library_page_checksum", {
            let mut bytes = raw().bytes();
            bytes[128 + 20] ^= 1;
            bytes
        }),
        ("library_page_corrupt", stream(1, |stream| stream[0] = 7)),
        ("library_page_corrupt_follows", stream(2, |stream| stream.extend(b"more"))),
        ("library_page_corrupt_endless", stream(0, |stream| stream[0] = 0)),
        (
            "library_page_corrupt_longer",
            stream(0, |stream| stream.splice(0..0, [0, 1, 0, 0xfe, 0xff, 7]).for_each(drop)),
        ),
        ("library_page_invalid_root", page(0, |page| page.push(0))),
        ("library_page_invalid_root_name", page(0, |page| page[0] = 0xff)),
        ("library_page_invalid_leaf", page(1, |page| page.truncate(page.len() - 1))),
        ("library_page_invalid_count", page(1, |page| page[0] = 0x7f)),
        ("library_page_invalid_none", page(1, |page| page[0] = 0)),
        ("library_page_invalid_words", page(1, |page| page[3] = b'~')),
        (
            "library_page_invalid_integer",
            page(0, |page| page.splice(4..5, [0x82, 0]).for_each(drop)),
        ),
        (
            "library_header_invalid_leaves",
            raw()
                .with(|raw| {
                    // Then the lengths end the page.
                    raw.version.1 = 0;
                    raw.pages = vec![(0, |page| {
                        let low = page.len() - 2;
                        page[low] ^= 1;
                    })];
                })
                .bytes(),
        ),
        (
            "library_header_invalid_spectra",
            described()
                .with(|raw| {
                    // The length of the second leaf's spectra, before the hash.
                    raw.pages = vec![(0, |page| {
                        let at = page.len() - 33;
                        page[at] = 0x7f;
                    })];
                })
                .bytes(),
        ),
        ("library_metadata_invalid", metadata(br#"{"date":"2026-02-29"}"#)),
        ("library_metadata_invalid_json", metadata(br#"{"version":"1""#)),
        ("library_metadata_invalid_type", metadata(br#"{"authors":"Ann"}"#)),
        ("library_metadata_invalid_twice", metadata(br#"{"version":"1","version":"2"}"#)),
        ("library_metadata_invalid_line", metadata(br#"{"homepage":"a\nb"}"#)),
        (
            "library_metadata_invalid_direction",
            metadata("{\"description\":\"a\u{202e}b\"}".as_bytes()),
        ),
        (
            "library_page_invalid_metadata",
            metadata(format!("{{\"description\":\"{}\"}}", "x".repeat(8200)).as_bytes()),
        ),
        ("library_page_checksum_spectra", {
            let mut bytes = described().bytes();
            let payload = u64::from_le_bytes(bytes[64..72].try_into().unwrap()) as usize;
            bytes[payload - 1] ^= 1;
            bytes
        }),
        (
            "library_page_invalid_spectrum",
            described().with(|raw| raw.spectra[0][1] = Some((f32::NAN, [255; 48]))).bytes(),
        ),
        (
            "library_page_invalid_levels",
            described().with(|raw| raw.spectra[0][1] = Some((0.0, [254; 48]))).bytes(),
        ),
        (
            "library_page_invalid_known",
            described().with(|raw| raw.pages = vec![(101, |page| page[1] = 2)]).bytes(),
        ),
        ("library_count_wrong_spectra", described().with(|raw| raw.spectra[0].push(None)).bytes()),
        (
            "library_index_changed_spectra",
            described().with(|raw| raw.spectra_blake3 = Some([7; 32])).bytes(),
        ),
        ("library_name_invalid_library", raw().with(|raw| raw.name = b"Bell\x07".to_vec()).bytes()),
        (
            "library_order_invalid_separators",
            raw()
                .with(|raw| raw.separators = Some(vec![b"a".to_vec(), b"wood/oak".to_vec()]))
                .bytes(),
        ),
        (
            "library_order_invalid_leaf",
            raw().with(|raw| raw.separators = Some(vec![Vec::new(), b"wood/z".to_vec()])).bytes(),
        ),
    ]
}

/// Files with a bad entry.
fn entries() -> Vec<Named> {
    let changed = |change: fn(&mut Raw)| raw().with(change).bytes();
    vec![
        ("library_name_invalid", changed(|raw| raw.leaves[0][0].name = b"../felt".to_vec())),
        (
            "library_name_invalid_device",
            changed(|raw| raw.leaves[0][0].name = b"aux.felt".to_vec()),
        ),
        (
            "library_name_invalid_superscript",
            changed(|raw| raw.leaves[0][0].name = "com².felt".into()),
        ),
        ("library_name_invalid_long", changed(|raw| raw.leaves[0][0].name = vec![b'f'; 251])),
        (
            "library_name_invalid_folder",
            changed(|raw| raw.leaves[0][0].name = b"felt.htex/felt".to_vec()),
        ),
        ("library_names_alike", changed(|raw| raw.leaves[0][0].name = "WOOD/ÖLWEIDE".into())),
        (
            "library_names_alike_decomposed",
            changed(|raw| raw.leaves[0][0].name = "WOOD/O\u{308}LWEIDE".into()),
        ),
        (
            "library_name_invalid_direction",
            changed(|raw| raw.leaves[0][0].name = "bark\u{202e}gnp".into()),
        ),
        (
            "library_name_invalid_invisible",
            changed(|raw| raw.leaves[0][0].name = "bark\u{2060}".into()),
        ),
        ("library_page_invalid_utf8", changed(|raw| raw.leaves[0][0].name = b"\xff".to_vec())),
        ("library_order_invalid", changed(|raw| raw.leaves[0][0].name = b"wood/elm".to_vec())),
        (
            "library_order_invalid_duplicate",
            changed(|raw| raw.leaves[0][0].name = b"wood/birch".to_vec()),
        ),
        ("library_range_invalid_end", changed(|raw| raw.leaves[1][1].own += 1)),
        (
            "library_range_invalid_gap",
            changed(|raw| {
                raw.leaves[1].iter_mut().for_each(|row| row.at -= 1);
                raw.leaves[1][1].own += 1;
            }),
        ),
        ("library_range_invalid_rest", changed(|raw| raw.payload.push(0))),
        ("library_range_invalid_object", changed(|raw| raw.leaves[0][0].cuts = vec![(0, 0, 1)])),
        (
            "library_range_invalid_cut",
            changed(|raw| {
                raw.shared = vec![0];
                raw.leaves[0][0].cuts = vec![(99_999, 0, 1)];
            }),
        ),
        ("library_range_invalid_overlap", overlapping()),
        ("library_page_invalid_object", changed(|raw| raw.leaves[0][0].cuts = vec![(0, 0, 0)])),
        (
            "library_page_invalid_conditions",
            changed(|raw| raw.leaves[0][0].speeds = Some((9.0, 8.0))),
        ),
        (
            "library_page_invalid_nan",
            changed(|raw| raw.leaves[0][0].forces = Some((1.0, f64::INFINITY))),
        ),
        ("library_page_invalid_contact", changed(|raw| raw.leaves[0][0].law.0 |= 3)),
        ("library_page_invalid_exponent", changed(|raw| raw.leaves[0][0].law.1[1] = 4.5)),
        ("library_page_invalid_quantity", changed(|raw| raw.leaves[0][0].quantity = 5)),
        ("library_page_invalid_felt", changed(|raw| raw.leaves[0][0].felt = 100_002)),
        ("library_page_invalid_held_out", changed(|raw| raw.leaves[0][1].held_out = 100_002)),
        (
            "library_page_invalid_licence",
            raw()
                .with(|raw| {
                    // The first licence, before two authors, two quantities and two felt differences.
                    raw.pages = vec![(1, |page| {
                        let at = page.len() - 8;
                        page[at] = 2;
                    })];
                })
                .bytes(),
        ),
        (
            "library_entry_wrong_licence",
            changed(|raw| raw.leaves[0][0].license = Some("MIT".to_owned())),
        ),
        (
            "library_entry_wrong_author",
            changed(|raw| raw.leaves[0][0].author = Some("Ann".to_owned())),
        ),
        ("library_entry_wrong_quantity", changed(|raw| raw.leaves[0][0].quantity = 2)),
        ("library_entry_wrong_law", changed(|raw| raw.leaves[0][0].law.1[0] = 1.0)),
        ("library_object_unused", changed(|raw| raw.shared = vec![1, 2, 3])),
        ("library_asset_changed", changed(|raw| raw.payload[40] ^= 1)),
        ("library_asset_changed_shared", {
            let mut bytes = pack("Shared", &sharing()).1;
            let at = u64::from_le_bytes(bytes[48..56].try_into().unwrap()) as usize;
            bytes[at] ^= 1;
            bytes
        }),
        (
            "library_asset_invalid",
            changed(|raw| {
                raw.payload[0] = b'Q';
                let own = raw.leaves[0][0].own as usize;
                raw.leaves[0][0].hash = *blake3::hash(&raw.payload[..own]).as_bytes();
            }),
        ),
        (
            "library_entry_wrong",
            changed(|raw| {
                raw.leaves[0][0].tags.pop();
                raw.leaves[0][1].models = vec!["org.example.other".to_owned()];
                raw.leaves[1][0].speeds = None;
            }),
        ),
    ]
}

/// Two shared objects that overlap; both textures are whole.
fn overlapping() -> Vec<u8> {
    raw()
        .with(|raw| {
            let (first, second) = (raw.leaves[0][0].own as usize, raw.leaves[0][1].own as usize);
            let both = raw.payload.drain(..first + second).collect::<Vec<u8>>();
            raw.shared = both;
            let leaf = &mut raw.leaves[0];
            for row in leaf.iter_mut() {
                (row.at, row.own) = (0, 0);
            }
            leaf[0].cuts = vec![(0, 0, first as u64)];
            leaf[1].cuts = vec![(0, first as u64, 10), (0, first as u64 + 10, second as u64 - 10)];
            let overlapped = raw.shared[first - 1..first + 10].to_vec();
            leaf[0].cuts.push((0, first as u64 - 1, overlapped.len() as u64));
            let all = [&raw.shared[..first], &overlapped].concat();
            leaf[0].hash = *blake3::hash(&all).as_bytes();
            let removed = (first + second) as u64;
            raw.leaves[1].iter_mut().for_each(|row| row.at -= removed);
        })
        .bytes()
}

/// Valid files, with limits too low for them.
fn limited() -> Vec<Case> {
    let (four, shared) = (pack("Four", &four()).1, pack("Shared", &sharing()).1);
    let of = |name: &str, bytes: &[u8], change: fn(&mut Limits)| {
        let mut limits = Limits::default();
        change(&mut limits);
        case(name, bytes.to_vec(), limits)
    };
    vec![
        of("library_entries_too_many_limit", &four, |l| l.entries = 3),
        of("library_leaves_too_many", &raw().bytes(), |l| l.leaves = 1),
        of("library_page_too_large_root", &four, |l| l.root_bytes = 4),
        of("library_page_too_large_root_packed", &big_root(), |_| ()),
        of("library_page_too_large_leaf", &four, |l| l.leaf_bytes = 100),
        of("library_asset_too_large", &four, |l| l.asset_bytes = 500),
        of("library_objects_too_many", &shared, |l| l.objects = 0),
        of("library_ratio", &shared, |l| l.ratio = 0),
    ]
}

/// A root page that states a size above the limit without having the bytes.
fn big_root() -> Vec<u8> {
    let mut bytes = raw().bytes();
    let root = 128..u64::from_le_bytes(bytes[32..40].try_into().unwrap()) as usize;
    bytes[root.start + 4..root.start + 8].fill(0xff);
    let crc = crc32(&bytes[root.start + 4..root.end]);
    bytes[root.start..root.start + 4].copy_from_slice(&crc.to_le_bytes());
    bytes
}
