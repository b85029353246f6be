//! The table of formats, and the documents that repeat it.

use std::fs;
use std::path::Path;

use htex_recording::FORMATS;

#[test]
fn documents_name_every_format() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..");
    for document in [
        "README.md",
        "docs/recording-formats.md",
        "sdk/bindings/python/README.md",
        "sdk/bindings/python/python/htex/_author.py",
    ] {
        let text = fs::read_to_string(root.join(document)).unwrap();
        for format in FORMATS {
            let name = format.name.split(' ').next().unwrap();
            assert!(text.contains(name), "{document}: {name}");
        }
    }
}

#[test]
fn names_extensions_and_signatures_are_of_one_format_each() {
    let mut all: Vec<Vec<u8>> = Vec::new();
    for format in FORMATS {
        all.push(format.name.into());
        all.extend(format.extensions.iter().map(|e| (*e).into()));
        let signed = format.signatures.iter();
        all.extend(signed.map(|(at, bytes)| [&at.to_le_bytes(), *bytes].concat()));
    }
    let count = all.len();
    all.sort();
    all.dedup();
    assert_eq!(all.len(), count);
}
