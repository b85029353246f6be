//! Untrusted text printed to a terminal.

use std::sync::OnceLock;

use htex_base::finding::plain;
use htex_format::{Limits, validate};
use htex_host::{Registry, read_descriptor};
use serde_json::Value;

use crate::block;
use crate::container::container;

/// Largest length of a text, characters.
const MOST: usize = 1000;
/// Largest number of output bytes per byte of text. An escape such as `\u{1b}` has six.
const WIDEST: usize = 6;

/// Puts a text into a string or a key of a manifest and of a descriptor; the first byte chooses
/// which. Messages about them, and the text itself, must be printed as one line without control
/// characters.
pub fn printed_text(input: &[u8]) -> bool {
    let Some((&which, text)) = input.split_first() else {
        return false;
    };
    let text: String = String::from_utf8_lossy(text).chars().take(MOST).collect();
    is_tame(&plain(&text), text.len());
    for (document, said) in
        [(manifest(), of_manifest as fn(&str) -> Vec<String>), (descriptor(), of_descriptor)]
    {
        let mut document = document.clone();
        write(&mut document, which.into(), &text);
        for sentence in said(&document.to_string()) {
            is_tame(&plain(&sentence), sentence.len());
        }
    }
    !text.is_empty()
}

/// Asserts that it is one line without characters that control a terminal, reverse text or hide it,
/// and that printing it again does not change it.
fn is_tame(printed: &str, from_bytes: usize) {
    let steers = printed.chars().find(|c| steers(*c));
    assert_eq!(steers, None, "in {printed:?}");
    assert!(printed.len() <= WIDEST * from_bytes, "{printed:?}");
    assert_eq!(plain(printed), printed);
}

/// Whether it is a control character, another line end, or a mark of direction, zero width or
/// language.
fn steers(c: char) -> bool {
    let marks = [
        0x00ad..=0x00ad,
        0x061c..=0x061c,
        0x180e..=0x180e,
        0x200b..=0x200f,
        0x2028..=0x202e,
        0x2060..=0x206f,
        0xfeff..=0xfeff,
        0xfff9..=0xfffb,
        0x13430..=0x1343f,
        0x1bca0..=0x1bca3,
        0x1d173..=0x1d17a,
        0xe0000..=0xe0fff,
    ];
    c.is_control() || marks.iter().any(|range| range.contains(&u32::from(c)))
}

/// Returns the messages about a manifest. Messages of findings have no control characters.
fn of_manifest(json: &str) -> Vec<String> {
    let bytes = container(json.as_bytes(), [("parameters.bin", &[0; 64][..])]);
    let findings = validate(&bytes, &Limits::default()).findings;
    for finding in &findings {
        is_tame(&finding.to_string(), usize::MAX / WIDEST);
    }
    let refused = htex_format::Asset::from_bytes(&bytes).err().map(|error| error.to_string());
    findings.into_iter().map(|finding| finding.message).chain(refused).collect()
}

fn of_descriptor(json: &str) -> Vec<String> {
    let refused = read_descriptor(json).err();
    refused.map(|error| error.to_string()).into_iter().collect()
}

fn manifest() -> &'static Value {
    static MANIFEST: OnceLock<Value> = OnceLock::new();
    MANIFEST.get_or_init(|| {
        let mut manifest = block::manifest(&Registry::builtin().models()[0], 1);
        manifest.author = Some("fuzzed".to_owned());
        manifest.tags = vec!["fuzzed".to_owned()];
        manifest.extensions_required = vec!["com.example.note/1".to_owned()];
        let source = htex_format::Source {
            file: "fuzzed.csv".to_owned(),
            rate_hz: 1000.0,
            segments: 1,
            blake3: None,
        };
        manifest.provenance.recordings = vec![source];
        serde_json::to_value(&manifest).expect("a manifest is JSON")
    })
}

fn descriptor() -> &'static Value {
    static DESCRIPTOR: OnceLock<Value> = OnceLock::new();
    DESCRIPTOR.get_or_init(|| {
        let registry = Registry::builtin();
        serde_json::to_value(registry.models()[0].descriptor()).expect("a descriptor is JSON")
    })
}

/// Replaces one of a document's strings by a text, or adds the text as a key to one of its objects.
fn write(document: &mut Value, which: usize, text: &str) {
    let mut places = Vec::new();
    find(document, String::new(), &mut places);
    let place = &places[which % places.len()];
    match document.pointer_mut(place) {
        Some(Value::Object(object)) => {
            object.insert(text.to_owned(), text.into());
        }
        Some(value) => *value = text.into(),
        None => {}
    }
}

/// Finds pointers to all texts and objects.
fn find(value: &Value, pointer: String, places: &mut Vec<String>) {
    match value {
        Value::Array(list) => {
            for (i, value) in list.iter().enumerate() {
                find(value, format!("{pointer}/{i}"), places);
            }
        }
        Value::Object(object) => {
            for (key, value) in object {
                let key = htex_base::finding::escape(key);
                find(value, format!("{pointer}/{key}"), places);
            }
            places.push(pointer);
        }
        Value::String(_) => places.push(pointer),
        _ => {}
    }
}
