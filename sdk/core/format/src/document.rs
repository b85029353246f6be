//! Parses versioned JSON documents, and reports each problem with a JSON pointer to its place.

use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::json_text::{JsonError, parse_json};
use crate::typed::typed;
use htex_base::finding::Findings;
use htex_base::finding::Rule;

/// A kind of document: its name in messages, its version and its rules.
#[derive(Debug, Clone, Copy)]
pub struct Document {
    /// Name of the text in messages, such as `manifest`.
    pub text: &'static str,
    /// Name of the file in messages, such as `manifest.json`.
    pub file: &'static str,
    /// Name of the versioned thing in messages, such as `asset`.
    pub thing: &'static str,
    /// The key whose value is the version.
    pub version_key: &'static str,
    /// The supported major version.
    pub major: u64,
    /// The newest supported minor version.
    pub minor: u64,
    /// The rules of the document.
    pub rules: DocumentRules,
}

/// The rules that apply to every kind of document. Each kind of document supplies its own set of
/// these rules, because each kind has its own error codes. The comment on each field describes the
/// problem that the rule reports.
#[derive(Debug, Clone, Copy)]
pub struct DocumentRules {
    /// The nesting exceeds the limit.
    pub too_deep: &'static Rule,
    /// The number of values exceeds the limit; `None` for documents that are short anyway.
    pub too_large: Option<&'static Rule>,
    /// The text is not JSON.
    pub syntax: &'static Rule,
    /// A key is missing, appears twice or has a value of the wrong type.
    pub wrong_type: &'static Rule,
    /// The version is missing.
    pub version_missing: &'static Rule,
    /// The version is invalid.
    pub version_invalid: &'static Rule,
    /// The major version is not supported.
    pub version_unsupported: &'static Rule,
    /// The minor version is newer than the supported minor version.
    pub version_newer: &'static Rule,
}

/// A parsed JSON text of a supported version.
#[derive(Debug)]
pub struct VersionedJson {
    /// The parsed JSON.
    pub value: Value,
    /// Whether the document's minor version is newer than the supported minor version.
    pub newer: bool,
}

impl Document {
    /// Parses a JSON text with a nesting depth of at most `max_depth`, and with at most `max_nodes`
    /// opening brackets and commas. If the text is not valid, adds a finding that says why, and
    /// returns `None`.
    pub fn open(
        &self,
        bytes: &[u8],
        max_depth: usize,
        max_nodes: usize,
        findings: &mut Findings,
    ) -> Option<VersionedJson> {
        let (rules, text) = (&self.rules, self.text);
        // Counted on the text, because the parser has a limit of its own and would report another
        // error first.
        let JsonSize { depth, nodes } = JsonSize::of(bytes);
        if depth > max_depth {
            let message = format!("the {text} nests {depth} deep and the limit is {max_depth}");
            findings.add(rules.too_deep, "", message);
            return None;
        }
        if let Some(rule) = rules.too_large.filter(|_| nodes > max_nodes) {
            let message =
                format!("the {text} has up to {nodes} values and the limit is {max_nodes}");
            findings.add(rule, "", message);
            return None;
        }
        let value = self.value(bytes, findings)?;
        let minor = self.check_version(&value, findings)?;
        Some(VersionedJson { value, newer: minor > self.minor })
    }

    fn value(&self, bytes: &[u8], findings: &mut Findings) -> Option<Value> {
        let rules = &self.rules;
        match parse_json(bytes) {
            Ok(value) => Some(value),
            Err(JsonError::Syntax(error)) => {
                let message = format!("{} is not valid JSON: {error}; correct it", self.file);
                findings.add(rules.syntax, "", message);
                None
            }
            Err(JsonError::Twice(pointer)) => {
                let message = "the key appears twice; keep one".to_owned();
                findings.add(rules.wrong_type, pointer, message);
                None
            }
        }
    }

    /// Returns the minor version; `None` if the document cannot be read.
    fn check_version(&self, value: &Value, findings: &mut Findings) -> Option<u64> {
        let (rules, key, thing) = (&self.rules, self.version_key, self.thing);
        let (known_major, known_minor) = (self.major, self.minor);
        let Some(object) = value.as_object() else {
            let message = format!("the {} is not an object; write {{ ... }}", self.text);
            findings.add(rules.wrong_type, "", message);
            return None;
        };
        let right = format!("\"{known_major}.{known_minor}\"");
        let Some(version) = object.get(key) else {
            let message = format!("there is no key {key}; add \"{key}\": {right}");
            findings.add(rules.version_missing, "", message);
            return None;
        };
        let pointer = format!("/{key}");
        let Some((major, minor)) = version.as_str().and_then(numbers) else {
            let message = format!("{key} is not a version; write {right}");
            findings.add(rules.version_invalid, pointer, message);
            return None;
        };
        let is = format!("the {thing} has version {major}.{minor} and this reader supports");
        if major != known_major {
            let message = format!("{is} {known_major}");
            findings.add(rules.version_unsupported, pointer, message);
            return None;
        }
        if minor > known_minor {
            let message = format!("{is} {known_major}.{known_minor}; update to see all of it");
            findings.add(rules.version_newer, pointer, message);
        }
        Some(minor)
    }

    /// Converts the document to a `T` and returns it with the pointers to all unknown keys. If the
    /// types do not match, adds a finding that says why, and returns `None`.
    pub fn typed<T: DeserializeOwned>(
        &self,
        opened: &VersionedJson,
        findings: &mut Findings,
    ) -> Option<(T, Vec<String>)> {
        match typed(&opened.value) {
            Ok(typed) => Some(typed),
            Err(error) => {
                let message = format!("{error}; correct the value or add the key");
                findings.add(self.rules.wrong_type, error.pointer, message);
                None
            }
        }
    }
}

/// Size of a JSON text, counted without parsing it.
struct JsonSize {
    /// Nesting depth: the largest number of arrays and objects that contain each other.
    depth: usize,
    /// Number of opening brackets and commas outside strings.
    nodes: usize,
}

impl JsonSize {
    fn of(mut bytes: &[u8]) -> Self {
        let (mut open, mut size) = (0usize, Self { depth: 0, nodes: 0 });
        while let Some((&byte, rest)) = bytes.split_first() {
            bytes = rest;
            match byte {
                b'"' => bytes = after_string(bytes),
                b'[' | b'{' => {
                    open += 1;
                    size.depth = size.depth.max(open);
                    size.nodes += 1;
                }
                // The text may be invalid JSON that closes more brackets than it opens. The parser
                // reports that later.
                b']' | b'}' => open = open.saturating_sub(1),
                b',' => size.nodes += 1,
                _ => {}
            }
        }
        size
    }
}

/// Skips the rest of a string.
fn after_string(mut bytes: &[u8]) -> &[u8] {
    while let Some(at) = memchr::memchr2(b'"', b'\\', bytes) {
        match bytes[at] {
            b'"' => return &bytes[at + 1..],
            // The character after a backslash belongs to the string.
            _ => bytes = bytes.get(at + 2..).unwrap_or_default(),
        }
    }
    &[]
}

/// Parses `MAJOR.MINOR`: numbers up to 2^32 - 1 without signs or leading zeros.
fn numbers(version: &str) -> Option<(u64, u64)> {
    let (major, minor) = version.split_once('.')?;
    Some((number(major)?, number(minor)?))
}

fn number(text: &str) -> Option<u64> {
    let number: u32 = text.parse().ok()?;
    // `parse` accepts `+1` and `01`. The number is written again and compared, because only one
    // form of each number is allowed.
    (number.to_string() == text).then_some(number.into())
}
