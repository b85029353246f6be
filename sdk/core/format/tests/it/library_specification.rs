//! The specification's example, limits and conformance files, compared with encoders and a reader
//! that share no code with the crate.

use crate::library_common as common;

use common::cases::{cases, four, limits};
use common::pack;
use common::raw::Raw;
use htex_format::library::{Library, Limits};
use serde_json::{Value, json};

const TEXT: &str = include_str!("../../../../../spec/htexlib-1.md");
/// What `tests/peers/library.py` prints for the valid conformance files. That reader was written
/// only from the specification.
const LISTED: &str = include_str!("../../../../../tests/golden/library.json");

/// Lines of the code block with this name: bytes and comment.
fn lines(name: &str) -> Vec<(Vec<u8>, &'static str)> {
    let (_, rest) = TEXT.split_once(&format!("```hex {name}\n")).unwrap();
    let (block, _) = rest.split_once("```").unwrap();
    let byte = |b: &str| u8::from_str_radix(b, 16).unwrap();
    let line = |line: &'static str| {
        let (bytes, comment) = line.split_once('#').unwrap_or((line, ""));
        (bytes.split_whitespace().map(byte).collect(), comment)
    };
    block.lines().map(line).collect()
}

/// Bytes of the code block with this name.
fn example(name: &str) -> Vec<u8> {
    lines(name).into_iter().flat_map(|(bytes, _)| bytes).collect()
}

/// Returns the number of bytes that a line's comment states, if it states one.
fn stated(comment: &str) -> Option<u64> {
    let words: Vec<&str> = comment.split_whitespace().filter(|w| *w != "own").collect();
    let bytes = words.iter().rposition(|word| word.starts_with("bytes"))?;
    words.get(bytes.checked_sub(1)?)?.parse().ok()
}

/// Reads a line as a LEB128 integer, or its last eight bytes as a little-endian integer.
fn number(line: &[u8]) -> u64 {
    match line.last_chunk::<8>() {
        Some(last) => u64::from_le_bytes(*last),
        None => line.iter().rev().fold(0, |sum, byte| sum << 7 | u64::from(byte & 0x7f)),
    }
}

#[test]
fn the_example_states_its_numbers_of_bytes() {
    let mut checked = 0;
    for name in ["root", "leaf", "header"] {
        for (line, comment) in lines(name) {
            if let Some(stated) = stated(comment) {
                assert_eq!(number(&line), stated, "{comment}");
                checked += 1;
            }
        }
    }
    assert_eq!(checked, 5);
}

/// Unpacks a page with `flate2`.
fn unpacked(page: &[u8]) -> Vec<u8> {
    use std::io::Read;
    let mut contents = Vec::new();
    let mut inflater = flate2::read::DeflateDecoder::new(&page[8..]);
    inflater.read_to_end(&mut contents).unwrap();
    contents
}

#[test]
fn the_example_is_what_the_writer_and_another_encoder_write() {
    let (_, file) = pack("One", &four()[..1]);
    assert_eq!(file[..128], example("header"));
    assert_eq!(unpacked(&file[128..185]), example("root"));
    assert_eq!(unpacked(&file[185..303]), example("leaf"));
    let raw = Raw::of(&four()[..1], 1);
    assert_eq!(raw.page(1), example("leaf"));
    let kept =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../../spec/library-conformance/valid_one.htexlib");
    assert_eq!(std::fs::read(kept).unwrap(), file);
}

/// Both encoders write the same pages for four textures, some of whose names share their start.
#[test]
fn pages_of_several_entries_are_those_of_another_encoder() {
    let (_, file) = pack("Raw", &four());
    let library = Library::open_source(file.as_slice()).unwrap();
    let leaf = library.index().leaf_range(0).unwrap();
    let raw = Raw::of(&four(), 4);
    assert_eq!(unpacked(&file[leaf.start as usize..leaf.end as usize]), raw.page(1));
    let payload = file.len() - raw.payload.len();
    assert_eq!(file[payload..], raw.payload);
}

#[test]
fn entries_are_those_that_another_reader_lists() {
    let mut valid: Vec<_> = cases().into_iter().filter(|c| c.name.starts_with("valid")).collect();
    valid.sort_by(|a, b| a.name.cmp(&b.name));
    let listed: Vec<Value> =
        LISTED.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(valid.len(), listed.len());
    for (case, listed) in valid.iter().zip(listed) {
        let library = Library::open_source(case.bytes.as_slice()).unwrap();
        let entries: Vec<_> = library.entries().map(|entry| entry.unwrap()).collect();
        let spectra = entries.iter().map(|entry| {
            let spectrum = library.description(entry).unwrap().spectrum?;
            Some(spectrum.levels_db().to_vec())
        });
        let spectra: Vec<_> = spectra.collect();
        let ours = json!({
            "name": library.name(),
            "metadata": library.metadata(),
            "entries": entries,
            "spectra": spectra,
        });
        assert_eq!(ours, listed, "{}", case.name);
    }
}

#[test]
fn the_text_names_every_limit_and_its_default() {
    for (name, value) in limits(&Limits::default()) {
        assert!(TEXT.contains(&format!("| `{name}` | {value} |")), "{name} {value}");
    }
}
