//! JSON documents of a versioned format, read so that every problem has its place.

use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::Rule;
use crate::json_text::{self, TextError};
use crate::report::Findings;
use crate::typed::typed;

/// A kind of document: what it is called in messages, its version, and the rules it is held to.
#[derive(Debug, Clone, Copy)]
pub struct Document {
    /// What a message calls the text, such as `manifest`.
    pub text: &'static str,
    /// What a message calls the text as a file, such as `manifest.json`.
    pub file: &'static str,
    /// What a message calls the thing that has a version, such as `asset`.
    pub thing: &'static str,
    /// The key that holds the version.
    pub version_key: &'static str,
    /// The major version that is read.
    pub major: u64,
    /// The newest minor version that is known.
    pub minor: u64,
    /// Its rules.
    pub rules: DocumentRules,
}

/// The rules that every document is held to, under the codes of its kind.
#[derive(Debug, Clone, Copy)]
pub struct DocumentRules {
    /// It nests too deep.
    pub too_deep: &'static Rule,
    /// It is not JSON.
    pub syntax: &'static Rule,
    /// A key is missing, stands twice or has a value of the wrong type.
    pub wrong_type: &'static Rule,
    /// It has no version.
    pub version_missing: &'static Rule,
    /// The version is none.
    pub version_invalid: &'static Rule,
    /// It is of another major version.
    pub version_unsupported: &'static Rule,
    /// It is of a newer minor version.
    pub version_newer: &'static Rule,
}

/// A text that is JSON, of a version that can be read.
#[derive(Debug)]
pub struct Opened {
    /// The whole of it.
    pub value: Value,
    /// Whether its minor version is newer than known.
    pub newer: bool,
}

impl Document {
    /// Opens a text that nests at most `max_depth` deep; none when a finding says why not.
    pub fn open(&self, bytes: &[u8], max_depth: usize, findings: &mut Findings) -> Option<Opened> {
        let (rules, text) = (&self.rules, self.text);
        let depth = depth(bytes);
        if depth > max_depth {
            let message = format!("the {text} nests {depth} deep and the limit is {max_depth}");
            findings.add(rules.too_deep, "", message);
            return None;
        }
        let value = self.value(bytes, findings)?;
        let newer = self.check_version(&value, findings)?;
        Some(Opened { value, newer })
    }

    fn value(&self, bytes: &[u8], findings: &mut Findings) -> Option<Value> {
        let rules = &self.rules;
        match json_text::parse(bytes) {
            Ok(value) => Some(value),
            Err(TextError::Syntax(error)) => {
                let message = format!("{} is not JSON: {error}; correct it there", self.file);
                findings.add(rules.syntax, "", message);
                None
            }
            Err(TextError::Twice(pointer)) => {
                let message = "the key stands twice; keep one of them".to_owned();
                findings.add(rules.wrong_type, pointer, message);
                None
            }
        }
    }

    /// Whether the minor version is newer than known; none when the document cannot be read.
    fn check_version(&self, value: &Value, findings: &mut Findings) -> Option<bool> {
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
        let is = format!("the {thing} is of version {major}.{minor} and this reader of");
        if major != known_major {
            let message = format!("{is} {known_major}");
            findings.add(rules.version_unsupported, pointer, message);
            return None;
        }
        if minor > known_minor {
            let message = format!("{is} {known_major}.{known_minor}; update to see all of it");
            findings.add(rules.version_newer, pointer, message);
        }
        Some(minor > known_minor)
    }

    /// The document as a `T`, and pointers to the keys inside it that no type knows; none when a
    /// finding says why not.
    pub fn typed<T: DeserializeOwned>(
        &self,
        opened: &Opened,
        findings: &mut Findings,
    ) -> Option<(T, Vec<String>)> {
        match typed(&opened.value) {
            Ok(typed) => Some(typed),
            Err(error) => {
                let message = format!("{error}; correct it or add what is missing");
                let pointer = error.pointer.unwrap_or_default();
                findings.add(self.rules.wrong_type, pointer, message);
                None
            }
        }
    }
}

/// Greatest number of arrays and objects open at once.
fn depth(bytes: &[u8]) -> usize {
    let (mut open, mut deepest) = (0usize, 0);
    let mut bytes = bytes.iter();
    while let Some(&byte) = bytes.next() {
        match byte {
            b'"' => skip_string(&mut bytes),
            b'[' | b'{' => {
                open += 1;
                deepest = deepest.max(open);
            }
            b']' | b'}' => open = open.saturating_sub(1),
            _ => {}
        }
    }
    deepest
}

/// Skips the rest of a string.
fn skip_string(bytes: &mut std::slice::Iter<'_, u8>) {
    while let Some(&byte) = bytes.next() {
        match byte {
            b'"' => return,
            b'\\' => _ = bytes.next(),
            _ => {}
        }
    }
}

/// `MAJOR.MINOR` without signs or leading zeros.
fn numbers(version: &str) -> Option<(u64, u64)> {
    let (major, minor) = version.split_once('.')?;
    Some((number(major)?, number(minor)?))
}

fn number(text: &str) -> Option<u64> {
    let number: u64 = text.parse().ok()?;
    (number.to_string() == text).then_some(number)
}
