//! The specification's worked example has the bytes that the code writes.

use crate::common;

use common::parts::{manifest, with_text};
use common::{asset, fitted};
use htex_format::{Asset, Limits, Steps, StoredAs, validate};

const TEXT: &str = include_str!("../../../../../spec/htex-1.md");

/// Returns the bytes of the code block that starts with `hex`.
fn example() -> Vec<u8> {
    let (_, rest) = TEXT.split_once("```hex\n").unwrap();
    let (block, _) = rest.split_once("```").unwrap();
    let bytes = block.lines().map(|line| line.split('#').next().unwrap());
    bytes.flat_map(str::split_whitespace).map(|b| u8::from_str_radix(b, 16).unwrap()).collect()
}

#[test]
fn the_worked_block_is_what_the_code_writes_and_reads() {
    let steps = |scale, offset, log| Steps { scale, offset, log };
    let fields = [
        ("weights", "", 2, StoredAs::F32),
        ("peak_hz", "Hz", 0, StoredAs::U16(steps(0.5, 0.0, false))),
        ("gain", "", 0, StoredAs::U8(steps(0.1, -5.0, true))),
    ];
    let (representation, _) = fitted("example", 1, &fields);
    let flat = vec![2.0, 0.5, -0.25, 100.2, 0.135];
    let bytes = asset(1, vec![(representation, vec![flat])]).to_bytes().unwrap();
    let block = example();
    assert!(bytes.windows(block.len()).any(|w| w == block), "not in the file: {block:02x?}");
    let read = &Asset::from_bytes(&bytes).unwrap().parameters[0][0];
    assert_eq!(read[..4], [2.0, 0.5, -0.25, 100.0]);
    assert!((read[4] - (-2.0f64).exp()).abs() < 1e-15);
}

#[test]
fn the_text_names_every_limit_and_its_default() {
    let limits = htex_format::Limits::default();
    let rows = [
        ("file_bytes", limits.file_bytes),
        ("entries", limits.entries as u64),
        ("entry_bytes", limits.entry_bytes),
        ("total_bytes", limits.total_bytes),
        ("ratio", limits.ratio),
        ("json_depth", limits.json_depth as u64),
        ("json_nodes", limits.json_nodes as u64),
        ("conditions", limits.conditions as u64),
        ("values", limits.values as u64),
    ];
    for (name, value) in rows {
        assert!(TEXT.contains(&format!("| `{name}` | {value} |")), "{name} {value}");
    }
}

/// Checks what the specification says about licences.
#[test]
fn licences_have_the_grammar_of_the_text() {
    let code = |license: &str| htex_format::check_license(license).err().map(|e| e.rule().code);
    let valid = [
        "MIT AND Apache-2.0",
        "MIT and (Apache-2.0 or 0BSD)",
        "Apache-2.0+",
        "GPL-2.0",
        "GPL-2.0-or-later WITH Classpath-exception-2.0",
        "MIT WITH AdditionRef-x",
        "DocumentRef-a:LicenseRef-b OR MIT with DocumentRef-a:AdditionRef-b",
    ];
    assert!(valid.iter().all(|license| code(license).is_none()));
    let unlisted = [
        "mit",
        "Foo-1.0",
        "MIT OR Foo-1.0 OR Bar",
        "MIT WITH Foo",
        // Neither is a licence, and each of the lists has ids of its own.
        "NONE",
        "NOASSERTION",
        "MIT WITH 0BSD",
        "Classpath-exception-2.0",
    ];
    for unlisted in unlisted {
        assert_eq!(code(unlisted), Some("LICENSE_UNKNOWN"), "{unlisted}");
    }
    let invalid = [
        "",
        "MIT And 0BSD",
        "Apache-2.0 +",
        "Apache-2.0+OR MIT",
        "GPL-2.0+",
        "Foo-1.0+",
        "a_b",
        "a:b",
        "MIT Foo",
        "MIT\u{a0}OR 0BSD",
        "AND",
        "LicenseRef-",
        "LicenseRef-a:b",
        "DocumentRef-a",
        "DocumentRef-a:MIT",
        "DocumentRef-:LicenseRef-b",
        "AdditionRef-a",
        "MIT WITH LicenseRef-a",
        "MIT WITH AdditionRef-",
    ];
    for invalid in invalid {
        assert_eq!(code(invalid), Some("LICENSE_INVALID"), "{invalid}");
    }
    // The white space of ASCII, from U+0009 to U+000D and U+0020.
    assert_eq!(code("\u{b}MIT\tOR\u{c}0BSD\r\n"), None);
}

/// 2^53 and the number above it, written with digits only and with a point.
#[test]
fn whole_numbers_are_compared_as_the_text_says() {
    let codes = |number: &str| {
        let segments = format!("\"segments\":{number}");
        let text = manifest().to_string().replacen("\"segments\":48", &segments, 1);
        assert!(text.contains(number));
        let report = validate(&with_text(text.as_bytes()), &Limits::default());
        report.findings.into_iter().map(|f| f.code).collect::<Vec<_>>()
    };
    for valid in ["9007199254740992", "9007199254740993.0", "9007199254740993e0"] {
        assert_eq!(codes(valid), [""; 0], "{valid}");
    }
    for refused in ["9007199254740993", "9007199254740995.0", "18446744073709551616"] {
        assert_eq!(codes(refused), ["JSON_TYPE"], "{refused}");
    }
}
