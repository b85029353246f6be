//! Checks of the manifest's plugins.

use std::collections::BTreeSet;
use std::fmt::Arguments;

use htex_model::is_model_id;

use crate::rules as rule;
use crate::{Manifest, Plugin};
use htex_base::finding::Findings;

/// Adds a finding for each rule that the manifest's plugins break, without looking at the modules.
pub(crate) fn check_plugins(manifest: &Manifest, findings: &mut Findings) {
    let mut seen = BTreeSet::new();
    for (i, plugin) in manifest.plugins.iter().enumerate() {
        let at = format_args!("/plugins/{i}");
        check_words(plugin, at, findings);
        let model = format_args!("{at}/model");
        let new = seen.insert(plugin.model.as_str());
        findings.require(new, rule::PLUGIN_DUPLICATE, model, || {
            format!("{} has two modules; keep one", plugin.model)
        });
        let used = manifest.representations.iter().any(|r| r.model == plugin.model);
        findings.require(used, rule::PLUGIN_UNUSED, model, || {
            format!("no representation uses {}; remove its module", plugin.model)
        });
        let valid = plugin.is_signature_valid();
        let pointer = format_args!("{at}/signature");
        findings.require(valid, rule::PLUGIN_SIGNATURE_INVALID, pointer, || {
            "the signature does not match its key and this plugin; do not trust it".to_owned()
        });
    }
}

fn check_words(plugin: &Plugin, at: Arguments<'_>, findings: &mut Findings) {
    let digit = |b: u8| b.is_ascii_digit() || (b'a'..=b'f').contains(&b);
    let hash = plugin.blake3.len() == 64 && plugin.blake3.bytes().all(digit);
    let words = [
        ("model", is_model_id(&plugin.model), "a reverse-DNS id"),
        ("version", semver::Version::parse(&plugin.version).is_ok(), "a semantic version"),
        (
            "file",
            plugin.file == Plugin::file_of(&plugin.model),
            "plugins/ID.wasm with the model's id",
        ),
        ("blake3", hash, "64 lower-case hexadecimal digits"),
    ];
    for (key, holds, form) in words {
        findings.require(holds, rule::PLUGIN_INVALID, format_args!("{at}/{key}"), || {
            format!("`{key}` is not {form}; embed the module again")
        });
    }
}
