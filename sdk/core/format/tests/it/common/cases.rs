//! The conformance files: valid assets, and files that each break a rule.

use std::collections::BTreeMap;

use htex_format::*;
use htex_host::Registry;
use serde_json::json;

use super::archive_cases::{archives, entries};
use super::edge_cases::{self, edges};
use super::manifest_cases::manifests;
use super::plugin_cases::plugins;
use super::text_cases::texts;
use super::triangle_cases::triangles;
use super::valid_cases::valid;
use super::{asset, sbeta};

/// A conformance file.
pub struct Case {
    pub name: String,
    pub bytes: Vec<u8>,
    pub limits: Limits,
}

impl Case {
    /// Returns the report of a reader that has the models of the specification.
    pub fn report(&self) -> Report {
        let models = Registry::builtin();
        // A model of another major version is another model.
        let major = |version: &str| semver::Version::parse(version).ok().map(|v| v.major);
        let known = |r: &Representation| {
            let model = models.find(&r.model).ok()?.descriptor();
            (major(&r.model_version) == major(&model.version)).then_some(model)
        };
        validate_with(&self.bytes, &self.limits, &known)
    }

    /// Returns the expected report as pretty JSON.
    pub fn golden(&self) -> String {
        let report = FileReport {
            limits: overrides(&self.limits),
            ..self.report().of_file(&format!("{}.htex", self.name))
        };
        // Converted to a value first, because that sorts the keys.
        serde_json::to_string_pretty(&json!(report)).unwrap() + "\n"
    }
}

fn overrides(limits: &Limits) -> BTreeMap<String, u64> {
    let pairs = |l: &Limits| {
        [
            ("file_bytes", l.file_bytes),
            ("entries", l.entries as u64),
            ("entry_bytes", l.entry_bytes),
            ("total_bytes", l.total_bytes),
            ("ratio", l.ratio),
            ("json_depth", l.json_depth as u64),
            ("json_nodes", l.json_nodes as u64),
            ("conditions", l.conditions as u64),
            ("values", l.values as u64),
        ]
    };
    let all = pairs(limits).into_iter().zip(pairs(&Limits::default()));
    all.filter(|(ours, default)| ours != default)
        .map(|((name, ours), _)| (name.to_owned(), ours))
        .collect()
}

/// All conformance files.
pub fn cases() -> Vec<Case> {
    let mut all: Vec<Case> = valid().into_iter().map(|(n, b)| case(n, b)).collect();
    let broken = archives()
        .into_iter()
        .chain(entries())
        .chain(texts())
        .chain(manifests())
        .chain(plugins())
        .chain(triangles())
        .chain(edges());
    all.extend(broken.map(|(n, b)| case(n, b)));
    all.extend(limited());
    let edges = edge_cases::limited().into_iter();
    all.extend(edges.map(|(name, bytes, limits)| Case { limits, ..case(name, bytes) }));
    all
}

pub(super) type Named = (&'static str, Vec<u8>);

fn case(name: &str, bytes: Vec<u8>) -> Case {
    Case { name: name.to_owned(), bytes, limits: Limits::default() }
}

/// Valid files, with limits too low for them.
fn limited() -> Vec<Case> {
    let sound = asset(1, vec![sbeta(1)]).to_bytes().unwrap();
    let default = Limits::default();
    let case = |name: &str, limits| Case { name: name.to_owned(), bytes: sound.clone(), limits };
    vec![
        case("file_too_large", Limits { file_bytes: 400, ..default }),
        case("archive_too_many_entries", Limits { entries: 2, ..default }),
        case("archive_too_large", Limits { total_bytes: 500, ..default }),
        case("entry_too_large", Limits { entry_bytes: 500, ..default }),
        case("entry_ratio", Limits { ratio: 1, ..default }),
        case("json_too_deep_limit", Limits { json_depth: 4, ..default }),
        case("values_too_many", Limits { values: 1, ..default }),
    ]
}
