//! Tests the blocks of `spec/baked-conformance`: a player renders the listed samples, or refuses a
//! block for the listed reason.

use crate::common::cases;

use std::collections::BTreeSet;

use xtask::generated::{file, only};

/// The bits are the same on every processor: `sdk/runtime/play/tests/it/bake_board.rs` compares blocks of
/// models with a Cortex-M4F.
#[test]
fn generated_blocks_and_samples_are_fresh() {
    let files = cases::files();
    for (path, bytes) in &files {
        file(path, bytes);
    }
    only(cases::FOLDER, files.iter().map(|(path, _)| path.as_str()));
}

#[test]
fn each_rule_refuses_a_block() {
    let files = cases::files().into_iter();
    let texts = files.filter(|(path, _)| path.ends_with(".json"));
    let mut rules = BTreeSet::new();
    for (path, text) in texts {
        let case: serde_json::Value = serde_json::from_slice(&text).unwrap();
        let rule = case["rule"].as_str();
        assert_eq!(case["valid"], rule.is_none(), "{path}");
        assert_eq!(path.contains("refused"), rule.is_some(), "{path}");
        rules.extend(rule.map(str::to_owned));
    }
    assert_eq!(rules.len(), 8, "{rules:?}");
}
