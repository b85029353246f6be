//! Parser of `manifest.json`.

use serde_json::Value;

use crate::document::{Document, DocumentRules};
use crate::limits::Limits;
use crate::rules as rule;
use crate::table::expand_tables;
use crate::{Manifest, Quantity, VERSION};
use htex_base::finding::Findings;
use htex_base::finding::escape;

const DOCUMENT: Document = Document {
    text: "manifest",
    file: "manifest.json",
    thing: "asset",
    version_key: "htex",
    major: 1,
    minor: 1,
    rules: DocumentRules {
        too_deep: rule::JSON_TOO_DEEP,
        too_large: Some(rule::JSON_TOO_LARGE),
        syntax: rule::JSON_SYNTAX,
        wrong_type: rule::JSON_TYPE,
        version_missing: rule::VERSION_MISSING,
        version_invalid: rule::VERSION_INVALID,
        version_unsupported: rule::VERSION_UNSUPPORTED,
        version_newer: rule::VERSION_NEWER,
    },
};

/// Parses a manifest. If that fails, adds a finding that says why and returns `None`.
pub(crate) fn parse(bytes: &[u8], limits: &Limits, findings: &mut Findings) -> Option<Manifest> {
    let mut opened = DOCUMENT.open(bytes, limits.json_depth, limits.json_nodes, findings)?;
    if let Err((pointer, problem)) = expand_tables(&mut opened.value) {
        let message = format!("{problem}; correct the table or write an array of objects");
        findings.add(rule::JSON_TYPE, pointer, message);
        return None;
    }
    check_quantity(&opened.value, findings)?;
    let (manifest, unknown) = DOCUMENT.typed::<Manifest>(&opened, findings)?;
    let (count, most) = (manifest.conditions.len(), limits.conditions);
    if count > most {
        let message = format!("there are {count} conditions and the limit is {most}");
        findings.add(rule::CONDITIONS_TOO_MANY, "/conditions", message);
        return None;
    }
    if !opened.newer {
        let other = manifest.other.keys().map(|key| format!("/{}", escape(key)));
        let mut pointers: Vec<String> = other.chain(unknown).collect();
        pointers.sort_unstable();
        for pointer in pointers {
            let message =
                format!("version {VERSION} has no such key; correct it or use an extension");
            findings.add(rule::JSON_UNKNOWN_KEY, pointer, message);
        }
    }
    Some(manifest)
}

/// Checks the quantity. Returns `None` if this version does not know the quantity.
fn check_quantity(manifest: &Value, findings: &mut Findings) -> Option<()> {
    let Some(Value::String(name)) = manifest.get("quantity") else {
        return Some(());
    };
    let Err(unknown) = name.parse::<Quantity>() else {
        return Some(());
    };
    let names = unknown.known.join(", ");
    let message = format!("{name:?} is not a quantity of version 1; write one of {names}");
    findings.add(rule::QUANTITY_UNKNOWN, "/quantity", message);
    None
}
