//! Reads and validates `study.toml`.

use std::path::{Path, PathBuf};

use htex_base::finding::{Finding, Findings};
use htex_format::{Document, DocumentRules};
use htex_scene::file::Motion;
use htex_scene::{DeviceOverride, Scene, SceneError, Surroundings};
use serde_json::Value;

use crate::study::check::check;
use crate::study::file::{Phase, Study};
use crate::study::rules as rule;
use crate::study::stimulus::scene_of;

/// Largest size of a study file, bytes.
const MOST_BYTES: usize = 1 << 20;
/// Largest nesting depth.
const MOST_DEPTH: usize = 16;

const DOCUMENT: Document = Document {
    text: "study",
    file: "the study",
    thing: "study",
    version_key: "htex_study",
    major: 1,
    minor: 0,
    rules: DocumentRules {
        too_deep: rule::STUDY_TOO_DEEP,
        syntax: rule::STUDY_SYNTAX,
        wrong_type: rule::STUDY_TYPE,
        version_missing: rule::STUDY_VERSION_MISSING,
        version_invalid: rule::STUDY_VERSION_INVALID,
        version_unsupported: rule::STUDY_VERSION_UNSUPPORTED,
        version_newer: rule::STUDY_VERSION_UNSUPPORTED,
    },
};

/// Reads a study and checks it without the files it names. If it cannot be used, adds a finding
/// with the reason and returns `None`. Never panics.
pub fn read_study(bytes: &[u8], findings: &mut Findings) -> Option<Study> {
    if bytes.len() > MOST_BYTES {
        let message = format!("the study has more than {MOST_BYTES} bytes");
        findings.add(rule::STUDY_FILE_TOO_LARGE, "", message);
        return None;
    }
    let value = parse(bytes, findings)?;
    if value.get("htex_study").is_none() {
        let message = "there is no key htex_study; add htex_study = \"1.0\" as the first line";
        findings.add(rule::STUDY_VERSION_MISSING, "", message.to_owned());
        return None;
    }
    // As JSON, the study is checked by the same code as a scene.
    let json = serde_json::to_vec(&value).ok()?;
    let opened = DOCUMENT.open(&json, MOST_DEPTH, findings)?;
    if opened.newer {
        return None;
    }
    let (study, unknown) = DOCUMENT.typed::<Study>(&opened, findings)?;
    for pointer in unknown {
        let message = "version 1.0 has no such key; correct it or remove it".to_owned();
        findings.add(rule::STUDY_UNKNOWN_KEY, pointer, message);
    }
    check_phase_tables(&study, &value, findings);
    check(&study, findings);
    (!findings.has_errors()).then_some(study)
}

fn parse(bytes: &[u8], findings: &mut Findings) -> Option<Value> {
    let problem = match std::str::from_utf8(bytes) {
        Err(error) => format!("the study is not UTF-8 after byte {}", error.valid_up_to()),
        Ok(text) => match htex_base::files::toml::from_str(text) {
            Ok(table) => return Some(table),
            Err(error) => error.to_string(),
        },
    };
    findings.add(rule::STUDY_SYNTAX, "", format!("{problem}; correct it"));
    None
}

/// Reports settings for phases that do not take place.
fn check_phase_tables(study: &Study, value: &Value, findings: &mut Findings) {
    for (key, phase) in [("training", Phase::Training), ("gain", Phase::Gain)] {
        let unused = value.get(key).is_some() && !study.has(phase);
        let pointer = format!("/{key}");
        findings.require(!unused, rule::STUDY_PHASE_UNUSED, pointer, || {
            format!("{key} has settings and is not in phases; add it there, or remove them")
        });
    }
}

/// Checks the files, motion and device of a study by the rules of scenes: each texture is opened in
/// each model as it will be played. `path` is the study's file. `device` is the device with which
/// the study is run; a rehearsal checks the study's own.
pub fn check_files(
    study: &Study,
    path: &Path,
    around: &Surroundings<'_>,
    device: &DeviceOverride,
    findings: &mut Vec<Finding>,
) {
    for (texture, asset) in study.textures.iter().enumerate() {
        for (pointer, model) in models(study) {
            let scene = scene_of(study, &asset.asset, model);
            let found = match Scene::from_bytes(path, &scene, around, device) {
                Ok(loaded) => loaded.notes,
                Err(SceneError::Invalid { findings }) => findings,
                // This is a scene in memory, so no file can fail to be read.
                Err(_) => Vec::new(),
            };
            for mut finding in found {
                finding.pointer = match &finding.pointer[..] {
                    "/surfaces/0/representation" => pointer.clone(),
                    "/duration_s" => "/trial_s".to_owned(),
                    other => other.replacen("/surfaces/0", &format!("/textures/{texture}"), 1),
                };
                if !findings.contains(&finding) {
                    findings.push(finding);
                }
            }
        }
    }
}

/// Returns all models of a study with their pointers, including the model of the gain matching.
fn models(study: &Study) -> Vec<(String, &str)> {
    let listed =
        study.models.iter().enumerate().map(|(i, model)| (format!("/models/{i}"), &model[..]));
    let reference =
        study.hidden_reference.iter().map(|model| ("/hidden_reference".to_owned(), &model[..]));
    let gain = study.has(Phase::Gain);
    let gain = gain.then(|| ("/gain/model".to_owned(), &study.gain.model[..]));
    listed.chain(reference).chain(gain).collect()
}

/// Returns the files that determine what a study plays, as the study names them: assets, the trace,
/// and the response of the device.
pub fn files_of(study: &Study) -> Vec<PathBuf> {
    let assets = study.textures.iter().map(|texture| texture.asset.clone());
    let trace = match &study.motion {
        Motion::Trace(path) => Some(path.clone()),
        _ => None,
    };
    let response = study.device.response.clone();
    let mut all: Vec<PathBuf> = assets.chain(trace).chain(response).collect();
    all.sort();
    all.dedup();
    all
}

/// Returns the JSON Schema of studies, version 1.0: `spec/schemas/study-1.json`.
pub fn study_schema() -> Value {
    htex_base::schema::document::<Study>("study-1.json", "Study of htex 1")
}
