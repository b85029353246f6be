//! From the bytes of `manifest.json` to a manifest.

use crate::Manifest;
use crate::document::{Document, DocumentRules, escape};
use crate::limits::Limits;
use crate::report::Findings;
use crate::rules as rule;

const DOCUMENT: Document = Document {
    text: "manifest",
    file: "manifest.json",
    thing: "asset",
    version_key: "htex",
    major: 1,
    minor: 0,
    rules: DocumentRules {
        too_deep: rule::JSON_TOO_DEEP,
        syntax: rule::JSON_SYNTAX,
        wrong_type: rule::JSON_TYPE,
        version_missing: rule::VERSION_MISSING,
        version_invalid: rule::VERSION_INVALID,
        version_unsupported: rule::VERSION_UNSUPPORTED,
        version_newer: rule::VERSION_NEWER,
    },
};

/// Reads a manifest; none when a finding says why not.
pub(crate) fn parse(bytes: &[u8], limits: &Limits, findings: &mut Findings) -> Option<Manifest> {
    let opened = DOCUMENT.open(bytes, limits.json_depth, findings)?;
    let (manifest, unknown) = DOCUMENT.typed::<Manifest>(bytes, &opened, findings)?;
    if !opened.newer {
        let other = manifest.other.keys().map(|key| format!("/{}", escape(key)));
        for pointer in other.chain(unknown) {
            let message = "version 1.0 has no such key; correct it or use an extension".to_owned();
            findings.add(rule::JSON_UNKNOWN_KEY, pointer, message);
        }
    }
    Some(manifest)
}
