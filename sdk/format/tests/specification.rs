//! The specification's worked example has the bytes that the code writes.
#![allow(clippy::unwrap_used)]

mod common;

use common::{asset, fitted};
use htex_format::{Asset, Steps, StoredAs};

const TEXT: &str = include_str!("../../../spec/htex-1.md");

/// Bytes of the code block that starts with `hex`.
fn example() -> Vec<u8> {
    let (_, rest) = TEXT.split_once("```hex\n").unwrap();
    let (block, _) = rest.split_once("```").unwrap();
    let bytes = block.lines().map(|line| line.split('#').next().unwrap());
    bytes
        .flat_map(str::split_whitespace)
        .map(|b| u8::from_str_radix(b, 16).unwrap())
        .collect()
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
    let bytes = asset(1, vec![(representation, vec![flat])])
        .to_bytes()
        .unwrap();
    let block = example();
    assert!(
        bytes.windows(block.len()).any(|w| w == block),
        "not in the file: {block:02x?}"
    );
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
        ("values", limits.values as u64),
    ];
    for (name, value) in rows {
        assert!(
            TEXT.contains(&format!("| `{name}` | {value} |")),
            "{name} {value}"
        );
    }
}
