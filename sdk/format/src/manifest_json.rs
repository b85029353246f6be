//! From the bytes of `manifest.json` to a manifest.

use serde_json::Value;

use crate::Manifest;
use crate::limits::Limits;
use crate::report::Findings;
use crate::rules as rule;

const MAJOR: u64 = 1;
const MINOR: u64 = 0;

/// Reads a manifest; none when a finding says why not.
pub(crate) fn parse(bytes: &[u8], limits: &Limits, findings: &mut Findings) -> Option<Manifest> {
    let (depth, limit) = (depth(bytes), limits.json_depth);
    if depth > limit {
        let message = format!("the manifest nests {depth} deep and the limit is {limit}");
        findings.add(rule::JSON_TOO_DEEP, "", message);
        return None;
    }
    let value = match serde_json::from_slice::<Value>(bytes) {
        Ok(value) => value,
        Err(error) => {
            let message = format!("manifest.json is not JSON: {error}; correct it there");
            findings.add(rule::JSON_SYNTAX, "", message);
            return None;
        }
    };
    let newer = check_version(&value, findings)?;
    let (manifest, unknown) = typed(bytes, findings)?;
    if !newer {
        let other = manifest.other.keys().map(|key| format!("/{}", escape(key)));
        for pointer in other.chain(unknown) {
            let message = "version 1.0 has no such key; correct it or use an extension".to_owned();
            findings.add(rule::JSON_UNKNOWN_KEY, pointer, message);
        }
    }
    Some(manifest)
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

/// Whether the minor version is newer than this crate's; none when the asset cannot be read.
fn check_version(manifest: &Value, findings: &mut Findings) -> Option<bool> {
    let Some(object) = manifest.as_object() else {
        let message = "the manifest is not an object; write { ... }".to_owned();
        findings.add(rule::JSON_TYPE, "", message);
        return None;
    };
    let Some(version) = object.get("htex") else {
        let message = "there is no key htex; add \"htex\": \"1.0\"".to_owned();
        findings.add(rule::VERSION_MISSING, "", message);
        return None;
    };
    let Some((major, minor)) = version.as_str().and_then(numbers) else {
        let message = "htex is not a version; write \"1.0\"".to_owned();
        findings.add(rule::VERSION_INVALID, "/htex", message);
        return None;
    };
    if major != MAJOR {
        let message = format!("the asset is of version {major}.{minor} and this reader of {MAJOR}");
        findings.add(rule::VERSION_UNSUPPORTED, "/htex", message);
        return None;
    }
    if minor > MINOR {
        let message = format!(
            "the asset is of version {major}.{minor} and this reader of {MAJOR}.{MINOR}; \
             update to see all of it"
        );
        findings.add(rule::VERSION_NEWER, "/htex", message);
    }
    Some(minor > MINOR)
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

/// The manifest, and pointers to the keys inside it that no type knows.
fn typed(bytes: &[u8], findings: &mut Findings) -> Option<(Manifest, Vec<String>)> {
    let mut unknown = Vec::new();
    let mut track = serde_path_to_error::Track::new();
    let mut json = serde_json::Deserializer::from_slice(bytes);
    let tracked = serde_path_to_error::Deserializer::new(&mut json, &mut track);
    let result: Result<Manifest, _> =
        serde_ignored::deserialize(tracked, |path| unknown.push(ignored_pointer(&path)));
    match result {
        Ok(manifest) => Some((manifest, unknown)),
        Err(error) => {
            let message = format!("{error}; correct it or add what is missing");
            findings.add(rule::JSON_TYPE, tracked_pointer(&track.path()), message);
            None
        }
    }
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

fn ignored_pointer(path: &serde_ignored::Path<'_>) -> String {
    use serde_ignored::Path;
    match path {
        Path::Root => String::new(),
        Path::Seq { parent, index } => format!("{}/{index}", ignored_pointer(parent)),
        Path::Map { parent, key } => format!("{}/{}", ignored_pointer(parent), escape(key)),
        Path::Some { parent }
        | Path::NewtypeStruct { parent }
        | Path::NewtypeVariant { parent } => ignored_pointer(parent),
    }
}

/// A key as a part of a JSON pointer (RFC 6901, section 3).
pub(crate) fn escape(key: &str) -> String {
    key.replace('~', "~0").replace('/', "~1")
}
