//! glTF files that carry an asset, checked by the Khronos validator and, by Ajv, against the
//! extension's schema, if Node and the packages are installed.

use std::path::{Path, PathBuf};

use crate::common::node::{packages, ran};
use htex::Texture;
use htex_exchange::gltf::EXTENSION;
use htex_exchange::{Export, Format, export};
use htex_tests::workspace;
use serde_json::{Value, json};

fn written(extension: &str) -> Vec<u8> {
    let seed = workspace().join("fuzz/seeds/open_asset/vinyl");
    let file = std::fs::read(seed).unwrap();
    let mut how = Export::new(Format::find("gltf").unwrap());
    how.extension = Some(extension);
    how.file = Some(&file);
    export(&Texture::from_bytes(&file).unwrap(), &how).unwrap().bytes
}

/// The files have the same text except for the place of the buffer.
fn document() -> Value {
    serde_json::from_slice(&written("gltf")).unwrap()
}

fn texture() -> Value {
    document()["materials"][0]["extensions"][EXTENSION].clone()
}

fn save(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// The validator knows no third-party extensions, and reports objects that only they use as unused.
/// It finds nothing else, and it does find errors.
#[test]
fn the_validator_of_khronos_finds_nothing() {
    if !xtask::needs::GLTF_VALIDATOR.met(packages().join("gltf-validator").exists()) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut wrong = document();
    wrong["bufferViews"][4]["byteLength"] = json!(10_000_000);
    let files = [
        save(folder.path(), "a.glb", &written("glb")),
        save(folder.path(), "a.gltf", &written("gltf")),
        save(folder.path(), "wrong.gltf", wrong.to_string().as_bytes()),
    ];
    let reports = ran("gltf.cjs", &files);
    for report in &reports.as_array().unwrap()[..2] {
        let issues = &report["issues"];
        assert_eq!(issues["numErrors"], 0, "{issues:#}");
        assert_eq!(issues["numWarnings"], 0, "{issues:#}");
        let codes = issues["messages"].as_array().unwrap().iter();
        let known = ["UNSUPPORTED_EXTENSION", "UNUSED_OBJECT"];
        assert!(
            codes.into_iter().all(|m| known.iter().any(|code| m["code"] == *code)),
            "{issues:#}"
        );
        assert_eq!(report["info"]["extensionsUsed"], json!([EXTENSION]));
        assert_eq!(report["info"]["totalTriangleCount"], 2);
    }
    assert_ne!(reports[2]["issues"]["numErrors"], 0, "{reports:#}");
}

/// Properties of the extension, and whether each is valid.
fn textures() -> Vec<(String, Value, bool)> {
    let changed = |key: &str, value: Value, is_valid: bool| {
        let mut texture = texture();
        texture[key] = value.clone();
        (format!("{key} {value}"), texture, is_valid)
    };
    vec![
        ("as written".to_owned(), texture(), true),
        ("empty".to_owned(), json!({}), false),
        changed("texCoord", json!(1), true),
        changed("extras", json!([]), true),
        changed("texCoord", json!(-1), false),
        changed("bufferView", json!(0.5), false),
        changed("mimeType", json!("application/zip"), false),
        changed("texCoordSizeMm", json!([0, 100]), false),
        changed("texCoordSizeMm", json!([100]), false),
        changed("texCoordSizeMm", json!([100, 100, 100]), false),
    ]
}

fn schema() -> Value {
    let file = workspace().join("spec/schemas/gltf-material-1.json");
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

#[test]
fn ajv_says_the_same_of_the_extension() {
    if !xtask::needs::AJV.met(packages().join("ajv").exists()) {
        return;
    }
    let schema = schema();
    let ask = |(name, document, _): &(String, Value, bool)| json!({"schema": schema["$id"], "name": name, "document": document});
    let documents: Vec<Value> = textures().iter().map(ask).collect();
    let questions = json!({"schemas": [schema], "documents": documents});
    let folder = tempfile::tempdir().unwrap();
    let file = save(folder.path(), "questions.json", questions.to_string().as_bytes());
    let wrong = textures().into_iter().filter(|(_, _, is_valid)| !is_valid);
    let names: Vec<String> = wrong.map(|(name, ..)| name).collect();
    assert_eq!(ran("ajv.cjs", &[file]), json!(names));
}
