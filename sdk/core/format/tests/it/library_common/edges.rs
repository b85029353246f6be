//! Libraries at the edges of rules. Each of them tells apart readers that `tests/peers/mutants` lists.

use htex_format::Asset;
use htex_format::library::Limits;

use super::cases::{Named, four, sharing};
use super::raw::{Change, Raw, Row, crc32};
use super::{Texture, pack, texture};

/// Four textures on two pages, without any bytes, for errors that end the reading before.
fn raw() -> Raw {
    without_payload(Raw::of(&four(), 2))
}

fn one() -> Raw {
    Raw::of(&[texture("a")], 1)
}

fn changed(change: fn(&mut Raw)) -> Vec<u8> {
    raw().with(change).bytes()
}

fn header(change: Change) -> Vec<u8> {
    raw().with(|raw| raw.header = Some(change)).bytes()
}

fn page(number: usize, change: Change) -> Vec<u8> {
    raw().with(|raw| raw.pages = vec![(number, change)]).bytes()
}

/// A library of as many leaves as there are changes of their first entry. Each leaf has one entry,
/// and no texture is whole: of each leaf only the first finding is reported, which comes before.
fn each(changes: &[&dyn Fn(&mut Row)]) -> Vec<u8> {
    let textures: Vec<Texture> = changes.iter().map(|_| texture("a")).collect();
    let mut raw = Raw::of(&textures, 1);
    raw.separators = Some((0..changes.len()).map(separator).collect());
    for (leaf, change) in raw.leaves.iter_mut().zip(changes) {
        change(&mut leaf[0]);
    }
    without_payload(raw).bytes()
}

fn separator(leaf: usize) -> Vec<u8> {
    if leaf == 0 { Vec::new() } else { vec![leaf as u8] }
}

/// The same without the textures' bytes.
fn without_payload(mut raw: Raw) -> Raw {
    raw.payload.clear();
    for row in raw.leaves.iter_mut().flatten() {
        (row.at, row.own) = (0, 0);
    }
    raw
}

/// A library with a leaf for each page, of which each is what `change` makes of a leaf's page.
fn pages_of_leaves(changes: &[fn(&mut Vec<u8>)]) -> Vec<u8> {
    let textures: Vec<Texture> = changes.iter().map(|_| texture("a")).collect();
    let mut raw = Raw::of(&textures, 1);
    raw.separators = Some((0..changes.len()).map(separator).collect());
    let numbered = changes.iter().enumerate();
    raw.pages = numbered.map(|(leaf, change)| (leaf + 1, *change)).collect();
    without_payload(raw).bytes()
}

fn metadata(json: &str) -> Vec<u8> {
    let change = |raw: &mut Raw| {
        raw.metadata = json.as_bytes().to_vec();
        raw.is_deflated = true;
    };
    one().with(change).bytes()
}

/// Metadata with a text of as many bytes as make them this long.
fn long_metadata(bytes: usize) -> Vec<u8> {
    let rest = r#"{"description":""}"#.len();
    metadata(&format!(r#"{{"description":"{}"}}"#, "x".repeat(bytes - rest)))
}

/// Names that are not allowed.
const NAMES: [&str; 41] = [
    "a\\b",
    "a:b",
    "a*b",
    "a?b",
    "a\"b",
    "a<b",
    "a>b",
    "a|b",
    "a//b",
    "a/./b",
    "a/../b",
    "a/b ",
    "a/b.",
    "a/con",
    "PRN.x",
    "aux",
    "nul",
    "conin$",
    "CONOUT$",
    "lpt1",
    "com0.a.b",
    "lpt\u{b3}",
    "aux .b",
    "a.HTEX/b",
    "a\u{85}",
    "a\u{7f}",
    "a\u{ad}",
    "a\u{61c}",
    "a\u{180e}",
    "a\u{200b}",
    "a\u{200f}",
    "a\u{2028}",
    "a\u{202e}",
    "a\u{206f}",
    "a\u{feff}",
    "a\u{fffb}",
    "a\u{13430}",
    "a\u{1bca3}",
    "a\u{1d173}",
    "a\u{e0000}",
    "/a",
];

/// Names that are allowed, though they are like others that are not.
const ALLOWED: [&str; 8] =
    ["a.htex", "aux1", "b/com10", "c.aux", "com\u{2074}", "con$", "lpt", "n.b/.c"];

fn named(name: &str) -> impl Fn(&mut Row) {
    let name = name.as_bytes().to_vec();
    move |row| row.name.clone_from(&name)
}

fn names() -> Vec<Named> {
    let changes: Vec<_> = NAMES.iter().map(|name| named(name)).collect();
    let changes: Vec<&dyn Fn(&mut Row)> = changes.iter().map(|c| c as &dyn Fn(&mut Row)).collect();
    let long = "\u{e9}".repeat(126);
    let alike = |names: &[&str]| {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        of_one_object(&names).bytes()
    };
    let mut longest = ALLOWED.map(str::to_owned).to_vec();
    // 250 bytes in a part, and 255 in all.
    longest.push(format!("z/{}", "a".repeat(250)));
    longest.push(format!("zz/{}/b", "\u{e9}".repeat(125)));
    vec![
        ("library_name_invalid_each", each(&changes)),
        ("library_name_invalid_bytes", each(&[&named(&long)])),
        ("valid_names", of_one_object(&longest).bytes()),
        // Full case folding, and decomposition before it.
        (
            "library_names_alike_each",
            alike(&["MASSE", "Ma\u{df}e", "\u{3b1}\u{301}\u{345}", "\u{1fb3}\u{301}"]),
        ),
        ("valid_compatible_names", alike(&["2", "\u{b2}"])),
    ]
}

fn headers() -> Vec<Named> {
    fn newer(raw: &mut Raw) {
        raw.version.1 = 7;
    }
    let with_version = |change: Change| {
        raw()
            .with(|raw| {
                newer(raw);
                raw.header = Some(change);
            })
            .bytes()
    };
    let mut extra = changed(newer);
    extra.push(0);
    let mut damaged = changed(newer);
    damaged[81] ^= 1;
    vec![
        // A newer minor version is told first, before an error of any stage.
        ("library_version_newer_and_extra_data", extra),
        ("library_version_newer_and_checksum", damaged),
        ("library_version_newer_and_gap", with_version(|header| header[32] += 1)),
        (
            "library_version_newer_and_root",
            raw()
                .with(|raw| {
                    newer(raw);
                    raw.name = b"\x07".to_vec();
                })
                .bytes(),
        ),
        (
            "valid_newer_minor_with_unused_bytes",
            one()
                .with(|raw| {
                    newer(raw);
                    raw.shared = vec![1, 2, 3];
                })
                .bytes(),
        ),
        ("library_truncated_signature", b"\x89HTL\r".to_vec()),
        ("library_version_unsupported_0", header(|header| header[8] = 0)),
        // Another major version may have another checksum.
        ("library_version_unsupported_checksum", {
            let mut bytes = raw().bytes();
            bytes[8] = 2;
            bytes
        }),
        ("library_header_invalid_no_leaf", {
            let empty = Raw {
                name: b"E".to_vec(),
                version: (1, 1),
                metadata: b"{}".to_vec(),
                ..Raw::default()
            };
            empty.with(|raw| raw.header = Some(|header| header[80] = 1)).bytes()
        }),
        ("library_header_invalid_more_leaves", header(|header| header[80] = 1)),
        ("library_truncated_and_too_many", {
            let mut bytes = header(|header| header[84] = 1);
            bytes.truncate(bytes.len() - 1);
            bytes
        }),
        // An empty root.
        ("library_page_corrupt_empty", {
            let mut bytes = Raw { version: (1, 1), ..Raw::default() }.bytes()[..128].to_vec();
            bytes[24..32].fill(0);
            for at in [32, 48, 64] {
                bytes[at..at + 8].copy_from_slice(&128u64.to_le_bytes());
            }
            let crc = crc32(&bytes[..124]);
            bytes[124..].copy_from_slice(&crc.to_le_bytes());
            bytes
        }),
    ]
}

fn roots() -> Vec<Named> {
    let root = |change: Change| page(0, change);
    /// The first length of a leaf in the root page of `raw`, before metadata of two bytes, two
    /// lengths of spectra and a hash.
    fn leaf_length(page: &[u8]) -> usize {
        page.len() - 32 - 2 - 3 - 4
    }
    vec![
        ("library_page_invalid_root_count", root(|page| page[4] = 0x7f)),
        ("library_page_invalid_root_common", root(|page| page[5] = 1)),
        (
            "library_page_invalid_root_integer",
            root(|page| {
                let most = [&[0xff; 9][..], &[2]].concat();
                page.splice(4..5, most).for_each(drop);
            }),
        ),
        ("library_page_invalid_root_text", changed(|raw| raw.name = vec![b'x'; 256])),
        ("valid_longest_name_of_library", one().with(|raw| raw.name = vec![b'x'; 255]).bytes()),
        ("library_order_invalid_equal_separators", {
            let mut three = without_payload(Raw::of(&four(), 1));
            three.separators = Some(vec![vec![], b"k".to_vec(), b"k".to_vec(), b"z".to_vec()]);
            three.bytes()
        }),
        // The order of separators comes before what follows them.
        (
            "library_order_invalid_and_cut_off",
            raw()
                .with(|raw| {
                    raw.separators = Some(vec![b"a".to_vec(), b"b".to_vec()]);
                    raw.pages = vec![(0, |page| page.truncate(12))];
                })
                .bytes(),
        ),
        // The length of the first leaf comes before the sum.
        (
            "library_page_too_large_leaf_length",
            root(|page| {
                let at = leaf_length(page);
                page.splice(at..at + 2, [0xff, 0xff, 0x7f]).for_each(drop);
            }),
        ),
        (
            "library_page_too_large_spectra_length",
            root(|page| {
                let at = page.len() - 34;
                page.splice(at..at + 1, [0xff, 0xff, 0x7f]).for_each(drop);
            }),
        ),
        ("valid_longest_metadata", long_metadata(8192)),
        ("library_page_invalid_metadata_8193", long_metadata(8193)),
        ("library_metadata_invalid_array", metadata("[]")),
        ("library_metadata_invalid_null", metadata(r#"{"homepage":null}"#)),
        ("library_metadata_invalid_author", metadata(r#"{"authors":["Ann",1]}"#)),
        ("library_metadata_invalid_author_lines", metadata(r#"{"authors":["A\nB"]}"#)),
        (
            "library_metadata_invalid_length",
            metadata(&format!(r#"{{"homepage":"{}"}}"#, "x".repeat(256))),
        ),
        ("library_metadata_invalid_date", metadata(r#"{"date":"20260228"}"#)),
        (
            "valid_metadata",
            metadata(&format!(
                r#"{{"description":"a\n{}","changelog":"b\nc","date":"2024-02-29","source":"{}","mood":null}}"#,
                "x".repeat(300),
                "y".repeat(255)
            )),
        ),
    ]
}

/// Where columns of a leaf of one texture of [`texture`] begin: the bits of its range.
fn range(page: &[u8]) -> usize {
    // The bits, a speed, a force; a law; three integers and a hash; two counts of rights, one of
    // them with a text; a licence, an author, a quantity and two errors.
    page.len() - (1 + 16) - 25 - 3 - 32 - (1 + 8) - 5
}

fn leaves() -> Vec<Named> {
    let finite = |x: f64| move |row: &mut Row| row.speeds = Some((x, x));
    let exponents = |x: [f64; 3]| move |row: &mut Row| row.law.1 = x;
    let words = |count: usize| move |row: &mut Row| row.tags = vec!["w".to_owned(); count];
    let cuts = |count: usize| move |row: &mut Row| row.cuts = vec![(0, 0, 1); count];
    vec![
        (
            "library_page_invalid_each_value",
            each(&[
                &finite(-1.0),
                &finite(-0.0),
                &finite(f64::NAN),
                &finite(f64::INFINITY),
                &exponents([-0.0, 0.0, 0.0]),
                &exponents([-4.5, 0.0, 0.0]),
                &exponents([0.0, 0.0, f64::NAN]),
                &|row: &mut Row| row.law.0 = 0b11_10_10_10,
                &|row: &mut Row| row.law.0 = 0b10_11_10_10,
                &words(65),
                &cuts(257),
                &|row: &mut Row| row.name = vec![b'f'; 256],
            ]),
        ),
        (
            "library_page_invalid_each_leaf",
            pages_of_leaves(&[
                // The bits of a range: one that has no meaning, and two values known to be equal
                // that are not known.
                |page| {
                    let at = range(page);
                    page[at] |= 0x10;
                },
                |page| {
                    let at = range(page);
                    page[at] = 4 | 2 | 8;
                    page.drain(at + 1..at + 9);
                },
                |page| {
                    let at = range(page);
                    page[at] = 1 | 4 | 8;
                    page.drain(at + 9..at + 17);
                },
                // A speed that is no number.
                |page| {
                    let at = range(page);
                    (page[at + 7], page[at + 8]) = (0xf8, 0x7f);
                },
                // A start of 2^64.
                |page| {
                    let at = range(page) + 17 + 25;
                    let beyond = [&[0x80; 9][..], &[2]].concat();
                    page.splice(at..at + 1, beyond).for_each(drop);
                },
                // Equal ends as two numbers.
                |page| {
                    let at = range(page);
                    page[at] &= !4;
                    let speed: Vec<u8> = page[at + 1..at + 9].to_vec();
                    page.splice(at + 1..at + 1, speed).for_each(drop);
                },
                // A word that does not exist, in the list of models before the range.
                |page| {
                    let at = range(page) - 1;
                    page[at] = 3;
                },
                // No entry, and nothing else.
                |page| {
                    page.clear();
                    page.extend([0; 4]);
                },
                // The third word is the second again.
                |page| {
                    let second = 1 + 1 + 15;
                    page.splice(second..second + 6 + 8, [1, b'w', 1, b'w']).for_each(drop);
                },
            ]),
        ),
        // As many words, objects and hundredths of a decibel as there may be, and exponents at the
        // ends of their range. The entries state other things than their textures.
        ("library_entry_wrong_at_limits", {
            let mut two = Raw::of(&[texture("a")], 1);
            let row = &mut two.leaves[0][0];
            row.tags = vec!["w".to_owned(); 64];
            row.law = (0b00_01_00_01, [-4.0, 4.0, 0.0]);
            row.felt = 100_001;
            row.speeds = None;
            row.license = None;
            row.author = Some("x".repeat(255));
            row.quantity = 4;
            row.models = Vec::new();
            two.bytes()
        }),
        ("valid_most_objects", most_objects()),
        (
            "library_page_invalid_known_twice",
            one()
                .with(|raw| {
                    raw.spectra = vec![vec![Some((0.0, [255; 48]))]];
                    raw.pages = vec![(101, |page| page[1] = 3)];
                })
                .bytes(),
        ),
        (
            "library_page_invalid_infinite_level",
            one().with(|raw| raw.spectra = vec![vec![Some((f32::INFINITY, [255; 48]))]]).bytes(),
        ),
    ]
}

/// A texture whose first 256 bytes are as many objects.
fn most_objects() -> Vec<u8> {
    let mut raw = Raw::of(&[texture("a")], 1);
    raw.shared = raw.payload.drain(..256).collect();
    let row = &mut raw.leaves[0][0];
    row.own -= 256;
    row.cuts = (0..256).map(|i| (0, i, 1)).collect();
    raw.bytes()
}

/// A texture with a change of its manifest, and the row that states it.
fn with_manifest(change: impl Fn(&mut htex_format::Manifest), state: impl Fn(&mut Row)) -> Vec<u8> {
    let mut raw = Raw::of(&[texture("a")], 1);
    let mut asset = Asset::from_bytes(&raw.payload).unwrap();
    change(&mut asset.manifest);
    raw.payload = asset.to_bytes().unwrap();
    let row = &mut raw.leaves[0][0];
    row.own = raw.payload.len() as u64;
    row.hash = *blake3::hash(&raw.payload).as_bytes();
    state(row);
    raw.bytes()
}

fn stated() -> Vec<Named> {
    // 128 characters of two bytes: the start of 255 bytes ends within the last.
    let long = "\u{e9}".repeat(128);
    let start = "\u{e9}".repeat(127);
    let given = |exponent: f64| htex_format::Exponent {
        exponent,
        source: htex_format::ExponentSource::Given,
        estimate: None,
        standard_error: None,
    };
    vec![
        (
            "valid_long_author",
            with_manifest(
                |m| m.author = Some(long.clone()),
                |row| row.author = Some(start.clone()),
            ),
        ),
        (
            "valid_acceleration_and_law",
            with_manifest(
                |m| {
                    m.quantity = htex_format::Quantity::Acceleration;
                    m.unit = "m/s2".to_owned();
                    m.contact = htex_format::Contact::Finger;
                    m.law = Some(htex_format::Law {
                        frequency_speed: given(-4.0),
                        level_speed: given(0.0),
                        level_force: given(4.0),
                    });
                },
                |row| {
                    row.quantity = 2;
                    row.law = (0b01_01_01_00, [-4.0, 0.0, 4.0]);
                },
            ),
        ),
        (
            "valid_assumed_velocity",
            with_manifest(
                |m| {
                    m.quantity = htex_format::Quantity::Velocity;
                    m.unit = "m/s".to_owned();
                    m.contact = htex_format::Contact::Finger;
                },
                |row| {
                    row.quantity = 3;
                    row.law = (0b10_10_10_00, [1.0, 1.0, 1.0]);
                },
            ),
        ),
        // A condition without segments was computed, and -0 is 0.
        (
            "valid_computed_condition",
            with_manifest(
                |m| {
                    m.conditions[0].force_n = Some(-0.0);
                    let computed = htex_format::Condition {
                        speed_mm_s: Some(500.0),
                        segments: Some(0),
                        ..Default::default()
                    };
                    m.conditions.push(computed);
                },
                |row| row.forces = Some((0.0, 0.0)),
            ),
        ),
        ("library_entry_wrong_contact_and_source", {
            let mut raw = Raw::of(&four(), 4);
            raw.leaves[0][0].law.0 = 0b10_10_10_00;
            raw.leaves[0][1].law.0 = 0b10_10_01_10;
            raw.leaves[0][2].law = (0b10_10_10_01, [1.0, 0.75, 0.5]);
            raw.leaves[0][2].tags.clear();
            raw.bytes()
        }),
    ]
}

fn ranges() -> Vec<Named> {
    vec![
        // A name of the next leaf, which is above the one before it.
        (
            "library_order_invalid_next_leaf",
            changed(|raw| raw.leaves[0][1].name = b"wood/pine".to_vec()),
        ),
        // An object that ends in the spectra.
        (
            "library_range_invalid_spectra",
            one()
                .with(|raw| {
                    raw.spectra = vec![vec![None]];
                    raw.leaves[0][0].cuts = vec![(0, 0, 4)];
                })
                .bytes(),
        ),
        // The first leaf has a finding, so that its entries are not counted.
        (
            "library_page_invalid_with_spectra",
            Raw::of(&[texture("a"), texture("b")], 1)
                .with(|raw| {
                    raw.spectra = vec![vec![None; 3], vec![None; 3]];
                    raw.leaves[0][0].law.0 |= 3;
                })
                .bytes(),
        ),
        ("library_range_invalid_overlap_after", {
            // An object, and another one that begins before it.
            let mut raw = Raw::of(&[texture("a"), texture("b")], 2);
            let (first, second) = (raw.leaves[0][0].own, raw.leaves[0][1].own);
            let payload = std::mem::take(&mut raw.payload);
            let (a, b) = payload.split_at(first as usize);
            raw.shared = b.to_vec();
            raw.payload = [a, &b[..10]].concat();
            let row_b = &mut raw.leaves[0][1];
            row_b.own = 10;
            row_b.cuts = vec![(10, 10, second - 10)];
            // A third texture, which is all of `b`.
            let mut third = row_b.clone();
            third.name = b"c".to_vec();
            (third.at, third.own) = (first + 10, 0);
            third.cuts = vec![(0, 0, second)];
            raw.leaves[0].push(third);
            raw.bytes()
        }),
    ]
}

/// All of these libraries, with the default limits.
pub fn edges() -> Vec<Named> {
    let groups = [headers(), roots(), leaves(), names(), stated(), ranges()];
    groups.into_iter().flatten().collect()
}

/// A texture under several names, of which the library has the bytes once.
fn of_one_object(names: &[String]) -> Raw {
    let mut raw = one();
    raw.shared = std::mem::take(&mut raw.payload);
    let mut row = raw.leaves[0][0].clone();
    (row.own, row.cuts) = (0, vec![(0, 0, raw.shared.len() as u64)]);
    let named = |name: &String| Row { name: name.clone().into_bytes(), ..row.clone() };
    raw.leaves = vec![names.iter().map(named).collect()];
    raw
}

/// Eight textures of one object, in a file that has as many bytes as all of them.
fn as_long_as_its_textures() -> Vec<u8> {
    let mut raw = of_one_object(&["a", "b", "c", "d", "e", "f", "g", "h"].map(str::to_owned));
    let size = raw.shared.len();
    for length in 0.. {
        raw.metadata = format!(r#"{{"description":"{}"}}"#, "x".repeat(length)).into_bytes();
        let bytes = raw.bytes();
        if bytes.len() == 8 * size {
            return bytes;
        }
    }
    unreachable!()
}

/// Libraries with limits.
pub fn limited() -> Vec<(&'static str, Vec<u8>, Limits)> {
    let default = Limits::default();
    let two = Raw::of(&four()[..2], 1);
    let contents = |number: usize| two.page(number).len() as u64;
    let (bytes, root, leaf) = (two.bytes(), contents(0), contents(1).max(contents(2)));
    let largest = two.leaves.iter().map(|leaf| leaf[0].own).max().unwrap();
    let shared = pack("Shared", &sharing()).1;
    let sizes = sharing().iter().map(|texture| texture.bytes().len() as u64).max().unwrap();
    // A root page of 100 bytes may have 100 / 64 + 72 bytes more in the file: eight of its head, five
    // of a stored block, and 60 others.
    let mut hundred = Raw::of(&four()[..1], 1);
    let rest = hundred.page(0).len() - hundred.name.len();
    hundred.name = vec![b'x'; 100 - rest];
    let longer =
        |change: Change| hundred.clone().with(|raw| raw.streams = vec![(0, change)]).bytes();
    let within = longer(|stream| prepend(stream, &[0, 0, 0, 0xff, 0xff].repeat(12)));
    // A block of fixed codes without contents takes ten bits, and thus one byte more.
    let beyond = longer(|stream| {
        prepend(stream, &[0, 0, 0, 0xff, 0xff].repeat(11));
        prepend(stream, &[2, 0, 0, 0, 0xff, 0xff]);
    });
    let exact = Limits {
        entries: 2,
        leaves: 2,
        root_bytes: root,
        leaf_bytes: leaf,
        asset_bytes: largest,
        objects: 0,
        ratio: 1,
    };
    let mut damaged = bytes.clone();
    damaged[128] ^= 1;
    let (root_of, objects_of) = (
        |root_bytes: u64| Limits { root_bytes, ..default },
        |objects: u64| Limits { objects, ..default },
    );
    vec![
        ("valid_at_limits", bytes, exact),
        ("valid_one_object", shared.clone(), objects_of(1)),
        (
            "library_asset_too_large_with_objects",
            shared,
            Limits { asset_bytes: sizes - 1, ..default },
        ),
        ("valid_ratio", as_long_as_its_textures(), Limits { ratio: 1, ..default }),
        ("valid_packed_margin", within, root_of(100)),
        ("library_page_too_large_packed_margin", beyond, root_of(100)),
        ("library_page_checksum_and_length", damaged, root_of(root - 1)),
    ]
}

fn prepend(stream: &mut Vec<u8>, blocks: &[u8]) {
    stream.splice(0..0, blocks.iter().copied()).for_each(drop);
}
