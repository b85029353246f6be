//! Assets at the edges of rules: the last value that is allowed and the first that is not, and the
//! order of findings. Each of them tells apart readers that `tests/peers/mutants` lists.

use htex_format::*;
use serde_json::{Value, json};

use super::cases::Named;
use super::parts::{self, block, parts, with_text};
use super::raw_zip::{Entry, Header, archive};
use super::{asset, fitted, sbeta, steps};

/// The manifest of a small asset with few of the keys that may be absent.
fn manifest() -> Value {
    let mut manifest = parts::manifest();
    for key in ["author", "tags", "provenance"] {
        manifest.as_object_mut().unwrap().remove(key);
    }
    manifest["conditions"] = json!([{ "speed_mm_s": 40 }]);
    manifest["representations"][0]["at"] = json!([{ "condition": 0, "level_rms": 0.1 }]);
    manifest
}

fn with_manifest(change: impl Fn(&mut Value)) -> Vec<u8> {
    let mut manifest = manifest();
    change(&mut manifest);
    let mut parts = parts(manifest.to_string().as_bytes(), &block());
    parts[1] = deflated(&parts[1]);
    archive(&parts)
}

fn with_parts(change: impl Fn(&mut Vec<Entry>)) -> Vec<u8> {
    let mut parts = parts(manifest().to_string().as_bytes(), &block());
    change(&mut parts);
    archive(&parts)
}

fn with_bytes(change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = with_parts(|_| ());
    change(&mut bytes);
    bytes
}

/// All of these assets, with the default limits.
pub(super) fn edges() -> Vec<Named> {
    let groups = [
        end_records(),
        headers(),
        texts(),
        versions(),
        texture(),
        values(),
        licences(),
        stores(),
        blocks(),
        tables(),
        fields_and_plugins(),
    ];
    groups.into_iter().flatten().collect()
}

/// An archive of one empty entry, whose end record is changed.
fn end_record(change: impl Fn(&mut [u8])) -> Vec<u8> {
    let mut bytes = archive(&[Entry::stored("a", b"")]);
    let end = bytes.len() - 22;
    change(&mut bytes[end..]);
    bytes
}

fn end_records() -> Vec<Named> {
    let empty = archive(&[]);
    vec![
        ("archive_zip64_locator", {
            let mut bytes = archive(&[Entry::stored("a", b"")]);
            let end = bytes.len() - 22;
            bytes.splice(end..end, [&b"PK\x06\x07"[..], &[0; 16]].concat());
            bytes
        }),
        ("archive_zip64_count", end_record(|end| end[10..12].fill(0xFF))),
        ("archive_zip64_disk", end_record(|end| end[4..6].fill(0xFF))),
        ("archive_zip64_and_bytes_after", {
            let mut bytes = end_record(|end| end[16..20].fill(0xFF));
            bytes.push(0);
            bytes
        }),
        ("archive_invalid_disk", end_record(|end| end[4] = 1)),
        ("archive_invalid_disk_of_directory", end_record(|end| end[6] = 1)),
        ("archive_invalid_count_of_disk", end_record(|end| end[8] = 0)),
        ("archive_invalid_comment", end_record(|end| end[20] = 1)),
        ("archive_invalid_directory_beyond", end_record(|end| end[12] += 1)),
        ("archive_extra_data_cut_off_record", [&empty[..], b"PK\x05\x06more"].concat()),
        // The count is one too small, so that a record is left.
        (
            "archive_invalid_record_left",
            with_bytes(|b| {
                let end = b.len() - 22;
                b[end + 8] -= 1;
                b[end + 10] -= 1;
            }),
        ),
        (
            "archive_extra_data_between",
            with_bytes(|b| {
                let directory = first(b, b"PK\x01\x02");
                b.splice(directory..directory, *b"gap");
                let end = b.len() - 22;
                let at = u32::from_le_bytes(b[end + 16..end + 20].try_into().unwrap());
                b[end + 16..end + 20].copy_from_slice(&(at + 3).to_le_bytes());
            }),
        ),
        // The second entry is said to be where the third is.
        (
            "archive_extra_data_place",
            with_bytes(|b| {
                let directory = first(b, b"PK\x01\x02");
                let second = directory + 4 + first(&b[directory + 4..], b"PK\x01\x02");
                let third = second + 4 + first(&b[second + 4..], b"PK\x01\x02");
                b.copy_within(third + 42..third + 46, second + 42);
            }),
        ),
        (
            "archive_invalid_local",
            with_bytes(|b| {
                let manifest = first(b, b"manifest.json");
                b[manifest - 30] = b'Q';
            }),
        ),
        // Data that run into the directory, and data that run beyond the file.
        ("archive_extra_data_into_directory", with_longer(4)),
        ("archive_invalid_beyond", with_longer(100_000)),
        // The last end record counts, and this one is in the data of an entry.
        (
            "entry_unreferenced_end_record",
            with_parts(|p| p.push(Entry::stored("notes.txt", &archive(&[])))),
        ),
    ]
}

fn first(bytes: &[u8], pattern: &[u8]) -> usize {
    bytes.windows(pattern.len()).position(|window| window == pattern).unwrap()
}

/// An asset whose last entry is said to be longer than it is.
fn with_longer(more: u32) -> Vec<u8> {
    with_parts(|p| {
        let change = |h: &mut Header| (h.packed, h.size) = (h.packed + more, h.size + more);
        p[2] = p[2].clone().with(change);
    })
}

/// The name of an entry, and its change.
type Changed = (&'static str, fn(&mut Entry));

/// Entries that are added to an asset, each after a change.
fn with_entries(changes: &[Changed]) -> Vec<u8> {
    with_parts(|p| {
        for (name, change) in changes {
            let mut entry = Entry::stored(name, b"12345");
            change(&mut entry);
            p.push(entry);
        }
    })
}

fn both(entry: &mut Entry, change: fn(&mut Header)) {
    *entry = entry.clone().with(change);
}

fn headers() -> Vec<Named> {
    let names: [&'static [u8]; 9] =
        [b"~ ok", b"a/./b", b"a//b", b"/", b"..", b"a\x1f", b"a\x7f", b"a\xe9", b"a\\b"];
    vec![
        (
            "entry_name_unsafe_each",
            with_parts(|p| {
                let entry = |n: &&[u8]| Entry::stored("", b"").with(|h| h.name = n.to_vec());
                p.extend(names.iter().map(entry));
            }),
        ),
        // Of the flags only bits 0, 3, 6 and 13 have a meaning. The method of an encrypted entry
        // is not looked at.
        (
            "entry_encrypted_bits",
            with_entries(&[
                ("a", |e| both(e, |h| h.flags = 1 << 6)),
                ("b", |e| both(e, |h| h.flags = 1 << 13)),
                ("c", |e| both(e, |h| h.flags = !(1 | 1 << 3 | 1 << 6 | 1 << 13))),
                ("d", |e| both(e, |h| (h.flags, h.method) = (1, 93))),
            ]),
        ),
        (
            "archive_zip64_entry",
            with_entries(&[
                ("a", |e| e.central.comment = b"note".to_vec()),
                ("b", |e| both(e, |h| h.size = u32::MAX)),
            ]),
        ),
        (
            "entry_extra_field_each",
            with_entries(&[
                ("a", |e| e.central.comment = b"note".to_vec()),
                ("b", |e| both(e, |h| h.extra = vec![0x55, 0x54, 0, 0])),
            ]),
        ),
        (
            "entry_header_mismatch_each",
            with_entries(&[
                ("a", |e| e.local.flags = 1 << 11),
                ("b", |e| e.local.method = 8),
                ("c", |e| e.local.minutes = 1),
                ("d", |e| e.local.crc ^= 1),
                ("e", |e| e.local.packed -= 1),
                ("f", |e| e.central.disk = 1),
                ("g", |e| e.central.disk = u16::MAX),
            ]),
        ),
        (
            "entry_corrupt_each",
            with_parts(|p| {
                // A stream whose only block is not the last one, and one of another length.
                p[1] = super::archive_cases::deflated(&p[1]);
                p[1].data[0] = 0;
                p[2] = super::archive_cases::deflated(&p[2]);
                p[2] = p[2].clone().with(|h| h.size += 1);
            }),
        ),
        (
            "mimetype_wrong_line_end",
            with_parts(|p| p[0] = Entry::stored("mimetype", b"application/vnd.htex+zip\n")),
        ),
    ]
}

/// An asset whose manifest is changed as text.
fn with_change(from: &str, to: &str) -> Vec<u8> {
    let text = manifest().to_string();
    assert!(text.contains(from), "{from}");
    with_text(text.replacen(from, to, 1).as_bytes())
}

/// An asset with further keys at the start of the manifest.
fn with_keys(keys: &str) -> Vec<u8> {
    with_change("{", &format!("{{{keys},"))
}

fn with_segments(number: &str) -> Vec<u8> {
    with_change("\"speed_mm_s\":40", &format!("\"segments\":{number}"))
}

fn texts() -> Vec<Named> {
    let brackets = "[{,".repeat(40);
    vec![
        (
            "valid_texts",
            with_keys(&format!(
                r#""description":"\"{brackets}\\","source":"\b\f\n\r\t\/\u00e9\ud83d\ude00","finger":"A\u0020""#
            )),
        ),
        ("json_syntax_zeros", with_change("20.0", "020.0")),
        ("json_syntax_point", with_change("20.0", "20.")),
        ("json_syntax_after", with_text(format!("{} 1", manifest()).as_bytes())),
        // Unknown keys are sorted, and pointers are escaped.
        (
            "json_unknown_key_escapes",
            with_keys(r#""z/y":1,"z0":1,"\ud83d\ude00":1,"a~b":{"c":1},"B":1,"\u007e\u002f":1"#),
        ),
        ("valid_largest_integers", with_segments("9007199254740993.0")),
        ("valid_largest_integer", with_segments("9007199254740992")),
        ("valid_zero_integer", with_segments("-0")),
        ("json_type_integer_of_digits", with_segments("9007199254740993")),
        ("json_type_integer_above", with_segments("9007199254740994.0")),
        ("json_type_integer_negative", with_segments("-1")),
        // The first key in the order of bytes, whatever the order of the text.
        (
            "json_type_order",
            with_text(
                manifest()
                    .to_string()
                    .replacen("\"unit\":\"N\"", "\"source\":1", 1)
                    .replacen('{', "{\"unit\":1,", 1)
                    .as_bytes(),
            ),
        ),
        (
            "json_type_missing_last",
            with_manifest(|m| {
                m.as_object_mut().unwrap().remove("band");
                m["unit"] = json!(1);
            }),
        ),
        (
            "json_type_triangle",
            with_manifest(|m| m["representations"][0]["triangles"] = json!([[0, 1, 2, 3]])),
        ),
        (
            "quantity_unknown_and_type",
            with_manifest(|m| {
                m["author"] = json!(5);
                m["quantity"] = json!("friction");
            }),
        ),
        (
            "condition_invalid_hundred",
            with_manifest(|m| {
                m["conditions"] = (0..100).map(|i| json!({ "force_n": -1 - i })).collect();
            }),
        ),
    ]
}

fn versions() -> Vec<Named> {
    let version = |version: Value| with_manifest(|m| m["htex"] = version.clone());
    vec![
        ("version_invalid_zeros", version(json!("1.00"))),
        ("version_invalid_minor", version(json!("1.4294967296"))),
        ("version_invalid_major", version(json!("4294967296.0"))),
        ("version_invalid_number", version(json!(1.0))),
        ("valid_largest_minor", version(json!("1.4294967295"))),
        ("version_unsupported_largest", version(json!("4294967295.0"))),
    ]
}

fn texture() -> Vec<Named> {
    let doi = |doi: &str| with_manifest(|m| m["doi"] = json!(doi));
    let band = |low_hz: f64, high_hz: f64| {
        with_manifest(|m| m["band"] = json!({ "low_hz": low_hz, "high_hz": high_hz }))
    };
    vec![
        ("name_empty_unicode", with_manifest(|m| m["name"] = json!("\u{2003}\u{85}\u{3000}\t"))),
        // These are no white space, so the name is not blank.
        (
            "valid_name_without_width",
            with_manifest(|m| m["name"] = json!(" \u{200b}\u{feff}\u{1c} ")),
        ),
        ("valid_doi", doi("10.123456789.0.12/!~a")),
        ("doi_invalid_three_digits", doi("10.123/a")),
        ("doi_invalid_ten_digits", doi("10.1234567890/a")),
        ("doi_invalid_space", doi("10.1234/a b")),
        ("doi_invalid_letter", doi("10.1234/\u{fc}")),
        ("doi_invalid_no_name", doi("10.1234/")),
        ("valid_band_to_20_khz", band(19_999.0, 20_000.0)),
        ("band_invalid_above", band(20.0, 20_000.5)),
        ("band_invalid_zero", band(0.0, 20.0)),
        ("band_invalid_equal", band(20.0, 20.0)),
        ("band_invalid_between", band(21.0, 24.0)),
    ]
}

/// An asset with an empty entry `edges.bin` in the place of its block.
fn with_empty_block(change: impl Fn(&mut Value)) -> Vec<u8> {
    let mut manifest = manifest();
    change(&mut manifest);
    let mut parts = parts(manifest.to_string().as_bytes(), &block());
    parts[2] = Entry::stored("edges.bin", b"");
    archive(&parts)
}

/// Measures with other values than those of a fit.
fn quality(correlation: f64) -> Value {
    json!({
        "spectral_correlation": correlation, "band_error_db": [0, 0, 0, 0, 0, 0, 0, 0, 0], "band_error_rms_db": 0,
    })
}

fn values() -> Vec<Named> {
    let hash = "0123456789abcdefABCDEF".repeat(3)[..64].to_owned();
    let recordings = json!([
        { "file": "a.csv", "rate_hz": 1, "segments": 0, "blake3": &hash },
        { "file": "b\\a.csv", "rate_hz": 0, "segments": 1, "blake3": "" },
        { "file": "c.csv", "rate_hz": 1, "segments": 1, "blake3": "g".repeat(64) },
    ]);
    let part = |weight: f64| json!({ "name": "a", "weight": weight, "blake3": &hash });
    let exponent = |exponent: f64| json!({ "exponent": exponent, "source": "given" });
    vec![
        (
            "source_invalid_each",
            with_manifest(|m| {
                m["provenance"]["recordings"] = recordings.clone();
                let from = [-0.1, 0.0, 1.0, 1.1].map(part);
                m["provenance"]["made"] = json!({ "how": "mixed", "from": from });
            }),
        ),
        (
            "condition_invalid_each",
            with_manifest(|m| {
                m["conditions"] = json!([
                    { "speed_mm_s": 0, "force_n": 0, "repeatability_rms_db": 0 },
                    { "speed_mm_s": 1, "force_n": -1 },
                    { "speed_mm_s": 1, "force_n": 1, "repeatability_rms_db": -1 },
                ]);
            }),
        ),
        (
            "law_invalid_each",
            with_manifest(|m| {
                m["law"] = json!({
                    "frequency_speed": exponent(-4.5),
                    "level_speed": exponent(-4.0),
                    "level_force": { "exponent": 4.5, "source": "measured", "standard_error": -1 },
                });
            }),
        ),
        (
            "valid_edges",
            with_empty_block(|m| {
                m["provenance"]["made"] = json!({ "how": "mixed", "from": [part(0.0), part(1.0)] });
                m["law"] = json!({
                    "frequency_speed": exponent(-4.0),
                    "level_speed": exponent(4.0),
                    "level_force": { "exponent": 0, "source": "measured", "standard_error": 0 },
                });
                m["conditions"] = json!([{ "speed_mm_s": 0, "force_n": 0 }, { "speed_mm_s": 1 }]);
                m["representations"][0]["at"] = json!([
                    { "condition": 1, "level_rms": 0, "quality": quality(-1.0) },
                    { "condition": 0, "level_rms": 1e6, "quality": quality(1.0) },
                ]);
                // Without steps there is no number at a condition.
                m["representations"][0]["fields"] = json!([]);
                m["representations"][0]["parameters"] = json!("edges.bin");
                m["representations"][0]["model"] = json!("a.b-1.c_2");
                let version = "0.0.18446744073709551615-0.a-1.00b+01.a";
                m["representations"][0]["model_version"] = json!(version);
                let extensions = json!({ "A-1.b_2.C/10": null });
                m["extensions"] = extensions;
            }),
        ),
        (
            "level_invalid_velocity",
            with_manifest(|m| {
                m["quantity"] = json!("velocity");
                m["unit"] = json!("m/s");
                m["representations"][0]["at"][0]["level_rms"] = json!(10_001);
            }),
        ),
        (
            "quality_invalid_each",
            with_manifest(|m| {
                m["conditions"] =
                    json!([{}, { "speed_mm_s": 1 }, { "speed_mm_s": 2 }, { "speed_mm_s": 3 }]);
                let at = |condition: usize| json!({ "condition": condition, "level_rms": -1 });
                let mut all = [0, 1, 2, 9].map(at);
                all[0]["quality"] = quality(-1.5);
                all[0]["left_out"] =
                    json!({ "band_error_rms_db": 0, "third_octave_error_rms_db": -1 });
                all[1]["quality"] = quality(1.5);
                all[1]["quality"]["band_error_db"] = json!([0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
                all[1]["quality"]["band_error_rms_db"] = json!(-1);
                all[1]["quality"]["samples_spectral_correlation"] = json!(-1.5);
                all[1]["quality"]["rounding_error_db"] = json!(-1);
                all[2]["left_out"] = json!({ "band_error_rms_db": -1 });
                m["representations"][0]["at"] = json!(all);
            }),
        ),
        (
            "model_id_invalid_each",
            with_manifest(|m| {
                let models = [
                    ("org.htex", "1.0.0"),
                    ("org.htex.Beta", "1.0.0"),
                    ("org..beta", "1.0.0"),
                    ("org.example.a", "01.0.0"),
                    ("org.example.b", "1.0.0-01"),
                    ("org.example.c", "18446744073709551616.0.0"),
                    ("org.example.d", "1.0.0+"),
                ];
                let representation = |(model, version): (&str, &str)| {
                    json!({
                        "model": model, "model_version": version, "fields": [], "parameters": "absent.bin",
                        "at": [{ "condition": 0, "level_rms": 0 }],
                    })
                };
                m["representations"] = models.map(representation).into_iter().collect();
            }),
        ),
        // One finding in each of several stages, in their order.
        (
            "name_empty_and_one_of_each_stage",
            with_manifest(|m| {
                m["name"] = json!("");
                m["conditions"] = json!([{ "force_n": -1 }]);
                m["law"] = json!({
                    "frequency_speed": exponent(5.0), "level_speed": exponent(0.0), "level_force": exponent(0.0),
                });
                m["representations"][0]["model_version"] = json!("1");
                m["reference"] = json!({ "file": "absent.bin" });
                m["plugins"] = json!([{
                    "model": "org.htex.sbeta", "version": "1", "file": "plugins/other.wasm", "blake3": "0",
                }]);
                m["extensions"] = json!({ "LOOK": 1 });
            }),
        ),
        (
            "entry_missing_reference",
            with_manifest(|m| m["reference"] = json!({ "file": "absent.bin" })),
        ),
        (
            "parameters_entry_invalid_mimetype",
            with_manifest(|m| m["representations"][0]["parameters"] = json!("mimetype")),
        ),
        (
            "parameters_entry_invalid_twice",
            with_manifest(|m| m["reference"] = json!({ "file": "parameters/sbeta.bin" })),
        ),
    ]
}

fn licences() -> Vec<Named> {
    let license = |license: &str| with_manifest(|m| m["license"] = json!(license));
    vec![
        (
            "valid_license_expression",
            license(
                "\u{b}(MIT or\tApache-2.0+)and GPL-2.0-only with Classpath-exception-2.0 OR \
                 DocumentRef-a:LicenseRef-b WITH DocumentRef-c.d:AdditionRef-e-f",
            ),
        ),
        ("license_invalid_mixed_case", license("MIT And 0BSD")),
        ("license_invalid_bracket", license("(MIT")),
        ("license_invalid_two", license("MIT 0BSD")),
        ("license_invalid_plus_of_agpl", license("AGPL-3.0+")),
        ("license_invalid_plus_of_gpl", license("GPL-2.0+")),
        ("license_invalid_plus_of_gfdl", license("GFDL-1.3+")),
        ("license_invalid_plus_unknown", license("Unknown-1.0+")),
        ("license_invalid_reference", license("LicenseRef-")),
        ("license_invalid_document", license("DocumentRef-:LicenseRef-a")),
        ("license_invalid_document_of_id", license("DocumentRef-a:MIT")),
        ("license_invalid_addition", license("AdditionRef-a")),
        ("license_invalid_space", license("MIT\u{a0}OR 0BSD")),
        ("license_unknown_case", license("mit")),
        ("license_unknown_none", license("NONE")),
        ("license_unknown_no_assertion", license("NOASSERTION")),
        ("license_unknown_addition", license("MIT WITH 0BSD")),
        ("license_unknown_exception", license("Classpath-exception-2.0")),
    ]
}

/// A representation of a model that no reader has: its fields, and its block at one condition.
type Stored = (Value, Vec<u8>);

/// An asset with these representations.
fn with_representations(stored: &[Stored], change: impl Fn(&mut Value)) -> Vec<u8> {
    let mut manifest = manifest();
    let mut entries = parts(b"", &block());
    entries.truncate(2);
    let representations = stored.iter().enumerate().map(|(i, (fields, block))| {
        let name = format!("{i}.bin");
        let entry = Entry::stored(&name, block);
        entries.push(if block.len() > 1_000 { deflated(&entry) } else { entry });
        json!({
            "model": format!("org.example.m{i}"), "model_version": "1.0.0", "fields": fields,
            "at": [{ "condition": 0, "level_rms": 0 }], "parameters": name,
        })
    });
    manifest["representations"] = representations.collect();
    change(&mut manifest);
    entries[1] = deflated(&Entry::stored("manifest.json", manifest.to_string().as_bytes()));
    archive(&entries)
}

fn of_one_field(store: Value, is_list: bool, block: &[u8]) -> Stored {
    (json!([{ "name": "x", "list": is_list, "store": store }]), block.to_vec())
}

fn list_of_bytes(block: &[u8]) -> Stored {
    of_one_field(json!({ "u8": { "scale": 1 } }), true, block)
}

fn scalar(block: &[u8]) -> Stored {
    of_one_field(json!({ "u8": { "scale": 1 } }), false, block)
}

fn packed(block: &[u8]) -> Stored {
    of_one_field(json!({ "packed": { "scale": 1 } }), true, block)
}

fn stores() -> Vec<Named> {
    let two_50 = 2.0f64.powi(50);
    let stores = [
        json!({ "u8": { "scale": 1, "offset": two_50 / 2.0 } }),
        json!({ "u8": { "scale": 1, "offset": 2.0 * two_50 } }),
        json!({ "u8": { "scale": 1, "offset": two_50 - 100.0 } }),
        json!({ "u8": { "scale": 1, "offset": -two_50 - 100.0 } }),
        json!({ "u8": { "scale": 0.5 / two_50, "log": true } }),
        json!({ "u8": { "scale": 1.0 / two_50, "log": true } }),
        json!({ "u16": { "scale": 0.1, "log": true } }),
        json!({ "u8": { "scale": 0.1, "offset": -709, "log": true } }),
        json!({ "u8": { "scale": 0.1, "offset": -708, "log": true } }),
    ];
    let fields = stores
        .iter()
        .enumerate()
        .map(|(i, store)| json!({ "name": format!("f{i}"), "store": store }));
    let fields = fields.collect();
    vec![
        ("store_invalid_each", with_representations(&[(fields, vec![0; 10])], |_| ())),
        // A packed number has no length: k, the number, and zeros.
        (
            "store_invalid_packed_scalar",
            with_representations(
                &[of_one_field(json!({ "packed": { "scale": 1 } }), false, &[0x00, 0xA0])],
                |_| (),
            ),
        ),
    ]
}

/// A packed list of numbers of which most are equal: they take a bit each.
fn nearly_equal(count: usize) -> Vec<u8> {
    let mut bits: Vec<bool> = vec![false; 11];
    let (mut state, mut is_higher) = (1u32, false);
    for i in 1..count {
        // xorshift32 (Marsaglia 2003).
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        // From 0 to 1 is 2, from 1 to 0 is 1: so many ones, and a zero.
        if i % 256 < 8 && state % 2 == 0 {
            bits.extend([true, !is_higher].into_iter().filter(|bit| *bit));
            is_higher = !is_higher;
        }
        bits.push(false);
    }
    bits.resize(bits.len().next_multiple_of(8), false);
    let byte = |bits: &[bool]| bits.iter().fold(0, |byte, bit| byte << 1 | u8::from(*bit));
    bits.chunks(8).map(byte).collect()
}

/// The entry with its data deflated.
fn deflated(entry: &Entry) -> Entry {
    use std::io::Write;
    let mut stream = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::best());
    stream.write_all(&entry.data).unwrap();
    let data = stream.finish().unwrap();
    let packed = data.len() as u32;
    let headers = entry.clone().with(|h| (h.method, h.packed) = (8, packed));
    Entry { data, ..headers }
}

fn blocks() -> Vec<Named> {
    let with = |stored: &[Stored]| with_representations(stored, |_| ());
    let list = |length: &[u8], count: usize| list_of_bytes(&[length, &vec![7; count]].concat());
    let floats = |x: f32| of_one_field(json!("f32"), false, &x.to_le_bytes());
    let log = json!({ "u16": { "scale": 0.1, "log": true } });
    let of_reference = |high_hz: f64, low_hz: f64, bytes: &[u8]| {
        let mut manifest = manifest();
        manifest["band"] = json!({ "low_hz": low_hz, "high_hz": high_hz });
        manifest["reference"] = json!({ "file": "reference.bin" });
        let mut parts = parts(manifest.to_string().as_bytes(), &block());
        parts.push(Entry::stored("reference.bin", bytes));
        archive(&parts)
    };
    vec![
        // The shortest length of each form but the last.
        (
            "valid_long_lists",
            with(&[
                list(&[0], 0),
                list(&[250], 250),
                list(&[0xFB, 251, 0], 251),
                list(&[0xFB, 0x2C, 1], 300),
                packed(&[&[0xFC, 0, 0, 1, 0][..], &nearly_equal(65_536)].concat()),
            ]),
        ),
        (
            "parameters_invalid_length_form",
            with(&[
                list(&[0xFB, 250, 0], 250),
                list(&[0xFC, 0xFB, 0, 0, 0], 251),
                list(&[0xFD, 1, 0, 0, 0, 0, 0, 0, 0], 1),
                list(&[0xFE], 254),
                list(&[0xFF], 255),
            ]),
        ),
        (
            "parameters_not_finite_each",
            with(&[
                floats(f32::NAN),
                floats(f32::INFINITY),
                floats(f32::NEG_INFINITY),
                of_one_field(log, false, &[0xFF, 0xFF]),
            ]),
        ),
        // The value 5e308, in a list that is whole, in one that is cut off, and in one with another k.
        (
            "parameters_not_finite_packed",
            with(&[
                of_one_field(json!({ "packed": { "scale": 1e308 } }), true, &[1, 0, 0xA0]),
                of_one_field(json!({ "packed": { "scale": 1e308 } }), true, &[2, 0, 0xA0]),
                of_one_field(json!({ "packed": { "scale": 1e308 } }), true, &[1, 0x20, 0xA0]),
            ]),
        ),
        // No number; 9 and 8, where k of 0 and of 1 take as many bits; 0, 255 and 0, where no k
        // takes fewer bits than 7.
        (
            "valid_packed_forms",
            with(&[
                packed(&[0]),
                packed(&[2, 0b0000_0001, 0b0011_0000]),
                packed(&[3, 0b1110_0000, 0b0001_1101, 0b1111_1011, 0b1011_1110, 0b1000_0000]),
            ]),
        ),
        (
            "parameters_invalid_packed_each",
            with(&[
                // The same with k = 1, and 9 and 9 with k = 1.
                packed(&[2, 0b0010_0001, 0b0010_1000]),
                packed(&[2, 0b0010_0001, 0b0010_0000]),
                // 255 and 256; 0 and -1.
                packed(&[2, 0b0001_1111, 0b1111_1000]),
                packed(&[2, 0b0000_0000, 0b0001_0000]),
                // A bit behind the number; more numbers than bits.
                packed(&[1, 0b0000_0000, 0b0000_0001]),
                packed(&[17, 0, 0]),
            ]),
        ),
        (
            "parameters_invalid_coded_above",
            coded_block(&[0xFF, 0xFF, 0xFC, 0x9B, 0xF2, 0xED, 0x95]),
        ),
        ("valid_coded_walks", coded_walks()),
        ("reference_invalid_infinite", of_reference(21.0, 20.0, &f32::INFINITY.to_le_bytes())),
        // A multiple of 5 Hz that rounding put outside the band is in it.
        ("valid_reference_rounded", of_reference(24.999_999_996, 20.000_000_004, &[0; 8])),
        (
            "parameters_entry_invalid_block",
            with_representations(&[list(&[0], 0), list(&[0], 0)], |m| {
                m["representations"][1]["parameters"] = json!("0.bin");
            }),
        ),
    ]
}

/// A coded asset of two conditions whose block is one coded list.
fn coded_block(block: &[u8]) -> Vec<u8> {
    parts::with_coded(block, |_| ())
}

/// The same with a change, and with its manifest deflated.
fn with_coded(block: &[u8], change: fn(&mut Value)) -> Vec<u8> {
    let manifest = parts::coded_manifest(change).to_string();
    let mut parts = parts(manifest.as_bytes(), block);
    parts[1] = deflated(&parts[1]);
    archive(&parts)
}

/// Coded lists that wander by steps of all sizes, some of them longer than the one before and some
/// shorter, and coded numbers.
fn coded_walks() -> Vec<u8> {
    let mut state = 1u32;
    let mut draw = |below: u32| {
        // xorshift32 (Marsaglia 2003).
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state % below
    };
    let lengths = [70usize, 70, 70, 20, 20, 70, 70, 3, 3, 70, 70, 70];
    let count = lengths.len();
    let coded = StoredAs::Coded(steps(1.0));
    let fields = [("walk", "", 1, coded), ("number", "", 0, coded)];
    let (mut representation, mut parameters) = fitted("walks", count, &fields);
    representation.model = "org.example.walks".to_owned();
    let mut walk = vec![128i32; 70];
    for (flat, length) in parameters.iter_mut().zip(lengths) {
        let sizes = [1, 3, 8, 30, 200];
        for (i, step) in walk.iter_mut().enumerate() {
            let size = sizes[(i / 14) % 5];
            *step = (*step + draw(2 * size + 1) as i32 - size as i32).clamp(0, 255);
        }
        let list = walk[..length].iter().map(|step| f64::from(*step));
        *flat = std::iter::once(length as f64).chain(list).collect();
        flat.push(f64::from(draw(256)));
    }
    let mut asset = asset(count, vec![(representation, parameters)]);
    asset.manifest.htex = "1.1".to_owned();
    asset.manifest.extensions_required = vec![CODED.to_owned()];
    asset.to_bytes().unwrap()
}

fn tables() -> Vec<Named> {
    /// The code of the specification's example.
    const CODE: &[u8] = &[0xFF, 0xFF, 0xFB, 0x76, 0x57, 0x42, 0xB5];
    let with = |change: fn(&mut Value)| with_coded(CODE, change);
    fn force(m: &mut Value) -> &mut Value {
        &mut m["conditions"]["columns"]["force_n"]
    }
    vec![
        ("json_type_table_per_below", with(|m| force(m)["per"] = json!(0.999))),
        ("json_type_table_per_above", with(|m| force(m)["per"] = json!(1_000_001))),
        (
            "json_type_table_rows_order",
            with(|m| *force(m) = json!({ "rows": [1, 0], "values": [1, 2] })),
        ),
        ("json_type_table_values_more", with(|m| force(m)["values"] = json!([50, 60]))),
        ("json_type_table_values_fewer", with(|m| force(m)["values"] = json!([]))),
        // `segments` has too many values, and so has `force_n`, which comes first.
        (
            "json_type_table_columns_order",
            with(|m| {
                m["conditions"]["columns"]["segments"] = json!({ "rows": [0], "values": [1, 2] });
                force(m)["values"] = json!([50, 60]);
            }),
        ),
        (
            "json_type_table_without_full",
            with(|m| {
                m["conditions"] = json!({ "columns": { "force_n": { "rows": [], "values": [] } } })
            }),
        ),
        // 2,048 rows of the table, and as many of each of 128 tables in it.
        (
            "json_type_table_too_many_rows",
            with(|m| {
                let inner = (0..128).map(|i| (format!("c{i}"), json!({ "columns": {} })));
                let mut columns: serde_json::Map<String, Value> = inner.collect();
                columns.insert("speed_mm_s".to_owned(), json!(vec![0; 2048]));
                m["conditions"] = json!({ "columns": columns });
            }),
        ),
        (
            "condition_index_duplicate_in_table",
            with(|m| m["representations"][0]["at"]["columns"]["condition"] = json!([1, 1])),
        ),
    ]
}

/// A key of small order with a signature for which the plain check holds, a signature whose point
/// has a small order, a key that is too short, and a valid signature in capital digits.
fn signatures() -> Vec<u8> {
    let module = b"\0asm\x01\0\0\0";
    let zeros = "0".repeat(62);
    let small = format!("01{zeros}");
    let base = "58".to_owned() + &"66".repeat(31);
    let signed = |model: &str, public_key: &str, ed25519: &str| {
        let mut plugin = Plugin::new(model, "1.0.0", module);
        let (public_key, ed25519) = (public_key.to_owned(), ed25519.to_owned());
        plugin.signature = Some(Signature { public_key, ed25519 });
        plugin
    };
    // S is the hash of the point, the key and the text, times the secret key.
    let of_point = "e603dc14b47a7c9135f2a2f1e110450df04a11c23a3eb504cbedc8391c9be00b";
    let key = "7767a3242dc9b58bbc68488c1265cc6cc5f26c6f3c88a5d55e901b0734dca572";
    let mut capital = Plugin::new("org.htex.sbeta", "1.0.0", module)
        .signed(&htex_format::signing::SecretKey::from_bytes(&[7; 32]));
    let signature = capital.signature.as_mut().unwrap();
    signature.public_key.make_ascii_uppercase();
    signature.ed25519.make_ascii_uppercase();
    let short = capital.signature.clone().unwrap();
    let mut asset = asset(1, vec![sbeta(1)]);
    asset.manifest.plugins = vec![
        capital,
        signed("org.example.key", &small, &format!("{base}01{zeros}")),
        signed("org.example.point", key, &format!("{small}{of_point}")),
        signed("org.example.short", &short.public_key[..62], &short.ed25519),
    ];
    let manifest = serde_json::to_vec(&asset.manifest).unwrap();
    let mut parts = parts(&manifest, &block());
    parts.extend(asset.manifest.plugins.iter().map(|p| Entry::stored(&p.file, module)));
    archive(&parts)
}

fn fields_and_plugins() -> Vec<Named> {
    let field = |change: fn(&mut Value)| {
        with_manifest(|m| change(&mut m["representations"][0]["fields"][0]))
    };
    let named = |name: &str| with_manifest(|m| m["extensions"] = json!({ name: 1 }));
    vec![
        ("field_unit_wrong_one", field(|f| f["unit"] = json!("1"))),
        (
            "field_kind_wrong_and_unit",
            with_manifest(|m| {
                let field = &mut m["representations"][0]["fields"][0];
                field["unit"] = json!("Hz");
                field["list"] = json!(true);
            }),
        ),
        // A reader of version 1 of a model knows nothing of the fields of version 2.
        (
            "valid_other_major_of_model",
            with_manifest(|m| {
                m["representations"][0]["model_version"] = json!("2.0.0");
                m["representations"][0]["fields"][0]["name"] = json!("gamma");
            }),
        ),
        (
            "field_unknown_pre_release",
            with_manifest(|m| {
                m["representations"][0]["model_version"] = json!("1.0.0-alpha");
                m["representations"][0]["fields"][0]["name"] = json!("gamma");
            }),
        ),
        (
            "extension_name_invalid_each",
            with_text(
                manifest()
                    .to_string()
                    .replacen(
                        '{',
                        r#"{"extensions":{"org.example.x/01":1,"org.example.x/0":1,"org.example.x":1,"com.x/1":1,"com.ex ample.x/1":1,"a..b/1":1},"#,
                        1,
                    )
                    .as_bytes(),
            ),
        ),
        ("extension_name_invalid_slash", named("com.example.a/b/1")),
        (
            "extension_required_unknown_present",
            with_manifest(|m| {
                m["extensions"] = json!({ "com.example.x/1": 1 });
                m["extensions_required"] = json!(["com.example.x/1"]);
            }),
        ),
        (
            "plugin_invalid_each",
            with_manifest(|m| {
                let plugin = |model: &str, version: &str, file: &str| {
                    json!({ "model": model, "version": version, "file": file, "blake3": "0".repeat(64) })
                };
                m["plugins"] = json!([
                    plugin("org.htex.sbeta", "1.0", "plugins/org.htex.sbeta.wasm"),
                    plugin("org.htex.bands", "1.0.0", "org.htex.bands.wasm"),
                    plugin("Bands", "1.0.0", "plugins/Bands.wasm"),
                ]);
            }),
        ),
        ("plugin_signature_invalid_each", signatures()),
    ]
}

/// Files with limits: their names and bytes with the limits.
pub(super) fn limited() -> Vec<(&'static str, Vec<u8>, Limits)> {
    let default = Limits::default();
    let three = with_manifest(|m| {
        m["name"] = json!("");
        m["conditions"] = json!([{}, { "speed_mm_s": 1 }, { "speed_mm_s": 2 }]);
    });
    let small = |limits: Limits| (with_parts(|_| ()), limits);
    // Seven numbers in lists and packed lists, and one on its own.
    let lists = with_representations(
        &[
            list_of_bytes(&[3, 1, 2, 3]),
            packed(&[4, 0, 0]),
            of_one_field(json!({ "u8": { "scale": 1 } }), false, &[5]),
        ],
        |_| (),
    );
    let codes = coded_walks();
    let walked = Asset::from_bytes(&codes).unwrap().parameters;
    // A length is no number.
    let coded = walked.iter().flatten().map(|flat| flat.len() - 1).sum::<usize>();
    let reference = |bytes: usize| {
        let mut manifest = manifest();
        manifest["band"] = json!({ "low_hz": 20, "high_hz": 21 });
        manifest["reference"] = json!({ "file": "reference.bin" });
        let mut parts = parts(manifest.to_string().as_bytes(), &block());
        parts.push(Entry::stored("reference.bin", &vec![0; bytes]));
        archive(&parts)
    };
    let (json, (sound, _)) = (manifest().to_string(), small(default));
    let nodes = json.matches(['[', '{', ',']).count();
    // The name has a comma.
    let exact = Limits {
        file_bytes: sound.len() as u64,
        entries: 3,
        entry_bytes: json.len() as u64,
        total_bytes: (24 + json.len() + 8) as u64,
        ratio: 1,
        json_depth: 5,
        json_nodes: nodes - 1,
        conditions: 1,
        values: 2,
    };
    vec![
        ("valid_at_limits", sound.clone(), exact),
        ("json_too_large", sound.clone(), Limits { json_nodes: nodes - 2, ..default }),
        ("json_too_deep_and_large", sound, Limits { json_depth: 4, json_nodes: 10, ..default }),
        ("conditions_too_many", three, Limits { conditions: 2, ..default }),
        ("values_too_many_lists", lists.clone(), Limits { values: 7, ..default }),
        ("values_too_many_coded", codes, Limits { values: coded - 1, ..default }),
        ("values_too_many_reference", reference(4), Limits { values: 2, ..default }),
        ("reference_length_and_limit", reference(8), Limits { values: 2, ..default }),
        (
            "parameters_invalid_length_and_limit",
            with_representations(&[list_of_bytes(&[9, 1])], |_| ()),
            Limits { values: 2, ..default },
        ),
        // Numbers of a block with a finding count for the next one, and those of a list that
        // exceeds the limit do not.
        (
            "parameters_invalid_and_counted",
            with_representations(
                &[list_of_bytes(&[2, 1, 2, 9]), list_of_bytes(&[2, 1, 2])],
                |_| (),
            ),
            Limits { values: 3, ..default },
        ),
        (
            "values_too_many_and_not_counted",
            with_representations(
                &[list_of_bytes(&[4, 1, 2, 3, 4]), list_of_bytes(&[3, 1, 2, 3])],
                |_| (),
            ),
            Limits { values: 3, ..default },
        ),
        (
            "values_too_many_scalar",
            with_representations(&[list_of_bytes(&[1, 1]), scalar(&[])], |_| ()),
            Limits { values: 1, ..default },
        ),
    ]
}
