//! Validates every conformance file against the published schemas, with the `jsonschema` crate and,
//! if Node and the package are installed, with Ajv.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::node::{packages, ran};
use htex_base::schema::Schema;
use htex_format::{Limits, manifest_json};
use htex_tests::workspace;
use serde_json::{Value, json};

/// Invalid files that a schema refuses. A schema cannot check rules across objects or in other
/// entries.
const REFUSED: &[&str] = &[
    "at_empty",
    "band_invalid_above",
    "band_invalid_zero",
    "condition_duplicate",
    "condition_duplicate_with_triangles",
    "condition_index_duplicate",
    "condition_invalid",
    "condition_invalid_all",
    "condition_invalid_each",
    "condition_invalid_hundred",
    "condition_invalid_third_octaves",
    "condition_invalid_with_triangles",
    "conditions_empty",
    "conditions_too_many",
    "doi_invalid",
    "doi_invalid_letter",
    "doi_invalid_no_name",
    "doi_invalid_space",
    "doi_invalid_ten_digits",
    "doi_invalid_three_digits",
    "field_duplicate",
    "field_name_empty",
    "findings_truncated",
    "fluctuation_invalid",
    "fluctuation_invalid_each",
    "json_too_deep",
    "json_type",
    "json_type_array",
    "json_type_fluctuation",
    "json_type_fluctuation_missing",
    "json_type_fraction",
    "json_type_integer_above",
    "json_type_integer_negative",
    "json_type_integer_of_digits",
    "json_type_missing",
    "json_type_missing_last",
    "json_type_null",
    "json_type_object_as_word",
    "json_type_order",
    "json_type_table_in_plain",
    "json_type_triangle",
    "json_type_two_stores",
    "json_type_word_as_object",
    "law_invalid",
    "law_invalid_each",
    "level_invalid",
    "level_invalid_displacement",
    "level_invalid_in_table",
    "level_invalid_velocity",
    "made_invalid",
    "mimetype_wrong_and_others",
    "model_duplicate",
    "model_id_invalid",
    "model_id_invalid_and_version",
    "model_id_invalid_each",
    "model_version_invalid",
    "name_empty",
    "name_empty_and_one_of_each_stage",
    "name_empty_and_others",
    "name_empty_unicode",
    "parameters_entry_invalid",
    "parameters_entry_invalid_mimetype",
    "plugin_duplicate",
    "plugin_duplicate_and_invalid",
    "plugin_invalid",
    "plugin_invalid_each",
    "plugin_signature_invalid_each",
    "quality_invalid",
    "quality_invalid_distance",
    "quality_invalid_each",
    "quality_invalid_left_out",
    "quantity_unknown",
    "quantity_unknown_and_type",
    "representations_empty",
    "source_invalid",
    "source_invalid_each",
    "store_invalid",
    "unit_unknown",
    "unit_unknown_acceleration",
    "version_invalid",
    "version_invalid_major",
    "version_invalid_number",
    "version_invalid_zeros",
    "version_missing",
    "version_unsupported",
    "version_unsupported_largest",
];

/// Invalid scenes that a schema refuses.
const REFUSED_SCENES: &[&str] = &[
    "budget_invalid",
    "device_field_invalid",
    "duration_invalid",
    "motion_invalid",
    "region_invalid",
    "representation_name_empty",
    "scene_json_too_deep",
    "scene_json_type",
    "scene_json_type_motion",
    "scene_json_type_seed",
    "scene_json_type_switch",
    "scene_unknown_key",
    "scene_version_invalid",
    "scene_version_missing",
    "scene_version_unsupported",
    "surface_gain_invalid",
    "surfaces_empty",
    "surfaces_too_many",
];

fn spec(path: &str) -> PathBuf {
    workspace().join("spec").join(path)
}

fn json_of(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap();
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The names in a folder that end like this, without the ending.
fn stems(folder: &str, end: &str) -> Vec<String> {
    let all = fs::read_dir(spec(folder)).unwrap();
    let names = all.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut stems: Vec<String> =
        names.filter_map(|name| name.strip_suffix(end).map(str::to_owned)).collect();
    stems.sort_unstable();
    stems
}

/// A document, and whether its report calls it valid. Unreadable JSON is left out.
type Documents = BTreeMap<String, (Value, bool)>;

fn manifests() -> Documents {
    let read = |stem: String| {
        let bytes = fs::read(spec(&format!("conformance/{stem}.htex"))).unwrap();
        let manifest = manifest_json(&bytes, &Limits::default())?;
        let report = json_of(&spec(&format!("conformance/{stem}.report.json")));
        Some((stem, (manifest, report["valid"] == true)))
    };
    stems("conformance", ".htex").into_iter().filter_map(read).collect()
}

/// Version 1.0 scenes, which the schema describes.
fn scenes() -> Documents {
    let read = |stem: String| {
        let bytes = fs::read(spec(&format!("scene-conformance/{stem}.scene.json"))).unwrap();
        let scene = htex_format::parse_json(&bytes).ok()?;
        let report = json_of(&spec(&format!("scene-conformance/{stem}.report.json")));
        let newer = stem.starts_with("scene_version_newer");
        (!newer).then(|| (stem, (scene, report["valid"] == true)))
    };
    let stems = stems("scene-conformance", ".scene.json");
    stems.into_iter().filter_map(read).collect()
}

fn reports() -> Vec<Value> {
    ["conformance", "scene-conformance"]
        .iter()
        .flat_map(|folder| {
            let stems = stems(folder, ".report.json").into_iter();
            stems.map(move |stem| json_of(&spec(&format!("{folder}/{stem}.report.json"))))
        })
        .collect()
}

fn published(file: &str) -> Value {
    json_of(&spec(&format!("schemas/{file}")))
}

/// Names of the documents that a schema refuses. Valid documents must pass.
fn refused(schema: &str, documents: &Documents) -> Vec<String> {
    let schema = Schema::new(&published(schema)).unwrap();
    let mut refused = Vec::new();
    for (name, (document, valid)) in documents {
        let violations = schema.violations(document);
        assert!(!valid || violations.is_empty(), "{name}: {violations:?}");
        if !violations.is_empty() {
            refused.push(name.clone());
        }
    }
    refused
}

#[test]
fn valid_files_pass_and_what_a_schema_can_say_is_refused() {
    let (manifests, scenes) = (manifests(), scenes());
    assert!(manifests.len() > 80 && scenes.len() > 40);
    assert_eq!(refused("manifest-1.json", &manifests), REFUSED);
    assert_eq!(refused("scene-1.json", &scenes), REFUSED_SCENES);
    let report = Schema::new(&published("report-1.json")).unwrap();
    for document in reports() {
        assert_eq!(report.violations(&document), [], "{document}");
    }
    let models = htex::Registry::builtin();
    let descriptor = Schema::new(&published("descriptor-1.json")).unwrap();
    for model in models.models() {
        let document = serde_json::to_value(model.descriptor()).unwrap();
        assert_eq!(descriptor.violations(&document), [], "{}", model.id());
    }
}

#[test]
fn schemas_name_themselves_and_use_the_standards_words_alone() {
    for stem in stems("schemas", ".json") {
        let schema = published(&format!("{stem}.json"));
        assert_eq!(schema["$id"], format!("https://htex.org/schemas/{stem}.json"));
        assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
        assert!(!has_format(&schema), "{stem}");
        Schema::new(&schema).unwrap_or_else(|error| panic!("{stem}: {error}"));
    }
}

/// Whether a place in a schema has the keyword `format`, which validators treat differently.
/// Documents may have a key with this name.
fn has_format(schema: &Value) -> bool {
    match schema {
        Value::Object(map) => {
            map.get("format").is_some_and(Value::is_string) || map.values().any(has_format)
        }
        Value::Array(items) => items.iter().any(has_format),
        _ => false,
    }
}

/// The input for Ajv: every schema, compiled in strict mode, and every document with its schema.
fn questions(documents: &[(&str, &Documents)]) -> Value {
    let schemas: BTreeSet<String> = stems("schemas", ".json").into_iter().collect();
    let schemas: Vec<Value> = schemas.iter().map(|s| published(&format!("{s}.json"))).collect();
    let id = |schema: &str| published(schema)["$id"].clone();
    let mut all: Vec<Value> = Vec::new();
    for (schema, documents) in documents {
        for (name, (document, _)) in documents.iter() {
            all.push(json!({ "schema": id(schema), "name": name, "document": document }));
        }
    }
    for document in reports() {
        all.push(json!({ "schema": id("report-1.json"), "name": "report", "document": document }));
    }
    json!({ "schemas": schemas, "documents": all })
}

#[test]
fn ajv_says_the_same_where_it_is() {
    if !xtask::needs::AJV.met(packages().join("ajv").exists()) {
        return;
    }
    let (manifests, scenes) = (manifests(), scenes());
    let asked = [("manifest-1.json", &manifests), ("scene-1.json", &scenes)];
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("questions.json");
    fs::write(&file, questions(&asked).to_string()).unwrap();
    let mut told: Vec<String> = serde_json::from_value(ran("ajv.cjs", &[file])).unwrap();
    told.sort_unstable();
    let mut ours = refused("manifest-1.json", &manifests);
    ours.extend(refused("scene-1.json", &scenes));
    ours.sort_unstable();
    // JavaScript reads 2^53 + 1 as 2^53, which is valid.
    ours.retain(|name| name != "json_type_integer_of_digits");
    assert_eq!(told, ours);
}

/// Laboratory documents that other programs read (takes, answers, gains of persons), and extensions
/// of assets.
#[test]
fn generated_schemas_of_the_laboratory_are_fresh() {
    for (name, schema) in [
        ("take-1", htex_lab::record::take_schema()),
        ("answers-1", htex_lab::study::answers_schema()),
        ("gains-1", htex_scene::gains_schema()),
        ("hatt-1", htex_exchange::hatt::extension_schema()),
        ("appearance-1", htex_format::appearance_schema()),
        ("gltf-material-1", htex_exchange::gltf::material_schema()),
    ] {
        let text = format!("{schema:#}\n");
        xtask::generated::file(format!("spec/schemas/{name}.json"), text.as_bytes());
    }
}
