//! Reads and validates `study.toml`.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use htex_base::finding::{Finding, Findings, Rule};
use htex_format::{Document, DocumentRules};
use htex_scene::file::Motion;
use htex_scene::{DeviceOverride, Scene, SceneError, Surroundings};
use serde_json::Value;

use crate::study::file::{Matching, Participants, Phase, Study};
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
        // This limit is not needed, because `MOST_BYTES` limits a study to few bytes.
        too_large: None,
        syntax: rule::STUDY_SYNTAX,
        wrong_type: rule::STUDY_TYPE,
        version_missing: rule::STUDY_VERSION_MISSING,
        version_invalid: rule::STUDY_VERSION_INVALID,
        version_unsupported: rule::STUDY_VERSION_UNSUPPORTED,
        version_newer: rule::STUDY_VERSION_UNSUPPORTED,
    },
};

/// Reads a study and checks its values. The files that the study names are not checked. If the
/// study cannot be used, adds a finding with the reason and returns `None`. Never panics.
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
    // The study is converted to JSON, so that the same code checks studies and scenes.
    let json = serde_json::to_vec(&value).ok()?;
    let opened = DOCUMENT.open(&json, MOST_DEPTH, usize::MAX, findings)?;
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

/// Adds findings for settings of phases that do not take place.
fn check_phase_tables(study: &Study, value: &Value, findings: &mut Findings) {
    for (key, phase) in [("training", Phase::Training), ("gain", Phase::Gain)] {
        let unused = value.get(key).is_some() && !study.has(phase);
        let pointer = format!("/{key}");
        findings.require(!unused, rule::STUDY_PHASE_UNUSED, pointer, || {
            format!("{key} has settings and is not in phases; add it there, or remove them")
        });
    }
}

/// Checks the files, motion and device of a study by the rules for scenes. To check the files,
/// opens each texture with each model as in the trials. `path` is the study file. `device` replaces
/// settings of the study's own device; the default value changes nothing.
///
/// # Errors
/// Returns [`SceneError::Unsigned`] if a texture is not signed as `around` requires.
pub fn check_files(
    study: &Study,
    path: &Path,
    around: &Surroundings<'_>,
    device: &DeviceOverride,
    findings: &mut Vec<Finding>,
) -> Result<(), SceneError> {
    for (texture, asset) in study.textures.iter().enumerate() {
        for (pointer, model) in models(study) {
            let scene = scene_of(study, &asset.asset, model);
            let found = match Scene::from_bytes(path, &scene, around, device) {
                Ok(loaded) => loaded.notes,
                Err(SceneError::Invalid { findings }) => findings,
                Err(error) => return Err(error),
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
    Ok(())
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
pub(crate) fn files_of(study: &Study) -> Vec<PathBuf> {
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

/// Largest number of trials in one session, and in the whole study.
const MOST_TRIALS: usize = 100_000;
const MOST_IN_ALL: usize = 1_000_000;
const MOST_PARTICIPANTS: usize = 1000;

pub(crate) fn check(study: &Study, findings: &mut Findings) {
    check_participants(&study.participants, findings);
    check_textures(study, findings);
    check_models(study, findings);
    check_names("attributes", attributes(study), findings);
    let count = study.attributes.len();
    let range = |what: &str| format!("{count} {what}; write 1 to 32");
    let fits = (1..=32).contains(&count);
    findings.require(fits, rule::STUDY_NUMBER_INVALID, "/attributes", || range("attributes"));
    check_numbers(study, findings);
    check_matching(&study.gain, findings);
    let scale = &study.scale;
    // Participants answer by pressing one digit key.
    let sound = scale.min < scale.max && scale.max <= 9;
    findings.require(sound, rule::STUDY_SCALE_INVALID, "/scale", || {
        let (min, max) = (scale.min, scale.max);
        format!(
            "the scale is {min} to {max}; write two digits, the lower one as min, such as 0 and 6"
        )
    });
    check_phases(study, findings);
    check_size(study, findings);
}

fn check_participants(participants: &Participants, findings: &mut Findings) {
    let count = participants.count();
    let fits = (1..=MOST_PARTICIPANTS).contains(&count);
    findings.require(fits, rule::STUDY_PARTICIPANTS_INVALID, "/participants", || {
        format!("there are {count} participants; write 1 to {MOST_PARTICIPANTS}")
    });
    let Participants::Names(names) = participants else {
        return;
    };
    let mut seen = BTreeSet::new();
    for (i, name) in names.iter().enumerate() {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        let sound = !name.is_empty() && name.len() <= 64 && name.chars().all(plain);
        // Each participant has a file, and some file systems ignore case.
        let is_new = seen.insert(name.to_ascii_lowercase());
        let pointer = format!("/participants/{i}");
        let rule = rule::STUDY_PARTICIPANTS_INVALID;
        findings.require(sound, rule, &pointer, || {
            format!(
                "{name:?} is no name of a participant; use letters, digits, - and _, at most 64"
            )
        });
        findings.require(is_new, rule, &pointer, || {
            format!("{name:?} occurs twice, perhaps in another case; name each participant once")
        });
    }
}

fn check_textures(study: &Study, findings: &mut Findings) {
    let count = study.textures.len();
    let fits = (1..=256).contains(&count);
    findings.require(fits, rule::STUDY_TEXTURES_INVALID, "/textures", || {
        format!("there are {count} textures; write 1 to 256")
    });
    let names = study.textures.iter().map(|texture| texture.name());
    check_names("textures", names, findings);
}

fn check_models(study: &Study, findings: &mut Findings) {
    let count = study.models.len();
    let rule = rule::STUDY_MODELS_INVALID;
    let fits = (1..=64).contains(&count);
    findings.require(fits, rule, "/models", || format!("there are {count} models; write 1 to 64"));
    check_names("models", study.models.iter().cloned(), findings);
    let named = study.models.iter().enumerate().map(|(i, model)| (format!("/models/{i}"), model));
    let reference =
        study.hidden_reference.iter().map(|model| ("/hidden_reference".to_owned(), model));
    let gain = [("/gain/model".to_owned(), &study.gain.model)];
    for (pointer, model) in named.chain(reference).chain(gain) {
        // With `auto`, the planner would choose the model, and two conditions could get the same
        // model.
        findings.require(model != "auto", rule, pointer, || {
            "auto is no model of a study; name one".to_owned()
        });
    }
    if let Some(reference) = &study.hidden_reference {
        let apart = !study.models.contains(reference) && !reference.trim().is_empty();
        findings.require(apart, rule, "/hidden_reference", || {
            format!("the hidden reference {reference:?} is empty or also in models; name another")
        });
    }
}

fn attributes(study: &Study) -> impl Iterator<Item = String> {
    study.attributes.iter().map(|a| a.name.clone())
}

fn check_names(key: &str, names: impl Iterator<Item = String>, findings: &mut Findings) {
    let mut seen = BTreeSet::new();
    for (i, name) in names.enumerate() {
        let sound = !name.trim().is_empty()
            && name.chars().count() <= 100
            && !name.chars().any(char::is_control);
        let is_new = seen.insert(name.clone());
        let pointer = format!("/{key}/{i}");
        findings.require(sound, rule::STUDY_NAME_INVALID, &pointer, || {
            format!("the name {name:?} is empty, too long, or has control characters; correct it")
        });
        findings.require(is_new, rule::STUDY_NAME_INVALID, &pointer, || {
            format!("the name {name:?} occurs twice; give each another name")
        });
    }
}

/// Checks that a number is in a range. `pointer` names it in findings.
fn require_in(value: f64, pointer: &str, from: f64, to: f64, findings: &mut Findings) {
    let rule: &Rule = rule::STUDY_NUMBER_INVALID;
    findings.require((from..=to).contains(&value), rule, pointer, || {
        format!("{value} is out of range; write {from} to {to}")
    });
}

fn check_numbers(study: &Study, findings: &mut Findings) {
    let repetitions = f64::from(study.repetitions);
    require_in(repetitions, "/repetitions", 1.0, 1000.0, findings);
    require_in(study.trial_s, "/trial_s", 0.01, 3600.0, findings);
    let trials = f64::from(study.training.trials);
    require_in(trials, "/training/trials", 1.0, 1000.0, findings);
    require_in(study.start_db, "/start_db", -120.0, 0.0, findings);
    if let Some(noise) = &study.masking_noise {
        let level = noise.level_dbfs;
        require_in(level, "/masking_noise/level_dbfs", -80.0, -10.0, findings);
    }
    if let Some(rests) = &study.rests {
        let every = f64::from(rests.every);
        require_in(every, "/rests/every", 1.0, 1e5, findings);
        require_in(rests.seconds, "/rests/seconds", 0.0, 3600.0, findings);
    }
}

fn check_matching(gain: &Matching, findings: &mut Findings) {
    require_in(gain.step_db, "/gain/step_db", 0.01, 20.0, findings);
    let large = gain.large_step_db;
    require_in(large, "/gain/large_step_db", 0.01, 40.0, findings);
    require_in(gain.lowest_db, "/gain/lowest_db", -120.0, -1.0, findings);
    let reversals = f64::from(gain.reversals);
    require_in(reversals, "/gain/reversals", 3.0, 50.0, findings);
}

fn check_phases(study: &Study, findings: &mut Findings) {
    let once = |phase| study.phases.iter().filter(|p| **p == phase).count() <= 1;
    let all = [Phase::Training, Phase::Gain, Phase::Testing];
    let sound = all.into_iter().all(once) && study.has(Phase::Testing);
    findings.require(sound, rule::STUDY_PHASES_INVALID, "/phases", || {
        "each phase is listed once, and testing among them; correct the list".to_owned()
    });
}

fn check_size(study: &Study, findings: &mut Findings) {
    let conditions = study.textures.len() * study.all_models().len();
    let trials = conditions.saturating_mul(study.repetitions as usize);
    let all = trials.saturating_mul(study.participants.count().max(1));
    let fits = trials <= MOST_TRIALS && all <= MOST_IN_ALL;
    findings.require(fits, rule::STUDY_TOO_LARGE, "", || {
        format!(
            "a session has {trials} trials and the study {all}; at most {MOST_TRIALS} and {MOST_IN_ALL}"
        )
    });
}
