//! JSON documents of a versioned format, read so that every problem has its place.

use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::Rule;
use crate::report::Findings;

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
        let value = match serde_json::from_slice::<Value>(bytes) {
            Ok(value) => value,
            Err(error) => {
                let message = format!("{} is not JSON: {error}; correct it there", self.file);
                findings.add(rules.syntax, "", message);
                return None;
            }
        };
        let newer = self.check_version(&value, findings)?;
        Some(Opened { value, newer })
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

    /// The text as a `T`, and pointers to the keys inside it that no type knows; none when a finding
    /// says why not.
    pub fn typed<T: DeserializeOwned>(
        &self,
        bytes: &[u8],
        opened: &Opened,
        findings: &mut Findings,
    ) -> Option<(T, Vec<String>)> {
        let mut unknown = Vec::new();
        let mut track = serde_path_to_error::Track::new();
        let mut json = serde_json::Deserializer::from_slice(bytes);
        let tracked = serde_path_to_error::Deserializer::new(&mut json, &mut track);
        let result = serde_ignored::deserialize(tracked, |path| {
            unknown.push(ignored_pointer(&path, &opened.value));
        });
        match result {
            Ok(value) => Some((value, unknown)),
            Err(error) => {
                let message = format!("{error}; correct it or add what is missing");
                findings.add(
                    self.rules.wrong_type,
                    tracked_pointer(&track.path()),
                    message,
                );
                None
            }
        }
    }
}

/// Greatest number of arrays and objects open at once.
fn depth(bytes: &[u8]) -> usize {
    let (mut open, mut deepest) = (0usize, 0);
    let (mut in_string, mut escaped) = (false, false);
    for &byte in bytes {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_string => escaped = true,
            b'"' => in_string = !in_string,
            b'[' | b'{' if !in_string => open += 1,
            b']' | b'}' if !in_string => open = open.saturating_sub(1),
            _ => {}
        }
        deepest = deepest.max(open);
    }
    deepest
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

fn tracked_pointer(path: &serde_path_to_error::Path) -> String {
    use serde_path_to_error::Segment;
    let part = |segment: &Segment| match segment {
        Segment::Seq { index } => format!("/{index}"),
        Segment::Map { key } => format!("/{}", escape(key)),
        Segment::Enum { variant } => format!("/{}", escape(variant)),
        Segment::Unknown => String::new(),
    };
    path.iter().map(part).collect()
}

fn ignored_pointer(path: &serde_ignored::Path<'_>, root: &Value) -> String {
    use serde_ignored::Path;
    match path {
        Path::Root => String::new(),
        Path::Seq { parent, index } => format!("{}/{index}", ignored_pointer(parent, root)),
        Path::Map { parent, key } => format!("{}/{}", ignored_pointer(parent, root), escape(key)),
        Path::NewtypeVariant { parent } => variant_pointer(ignored_pointer(parent, root), root),
        Path::Some { parent } | Path::NewtypeStruct { parent } => ignored_pointer(parent, root),
    }
}

/// The pointer into a variant, which is the only key of its object and which the path does not name.
fn variant_pointer(parent: String, root: &Value) -> String {
    let object = root.pointer(&parent).and_then(Value::as_object);
    match object.and_then(|object| object.keys().next()) {
        Some(variant) => format!("{parent}/{}", escape(variant)),
        None => parent,
    }
}

/// A key as a part of a JSON pointer (RFC 6901, section 3).
pub fn escape(key: &str) -> String {
    key.replace('~', "~0").replace('/', "~1")
}
