//! Parses and validates a scene file, without the files that it names.

use htex_base::finding::{Findings, escape};
use htex_format::{Document, DocumentRules};
use serde_json::Value;

use crate::check::check;
use crate::file::{Effect, SceneFile};
use crate::limits::Limits;
use crate::rules as rule;

const DOCUMENT: Document = Document {
    text: "scene",
    file: "the scene",
    thing: "scene",
    version_key: "htex_scene",
    major: 1,
    minor: 0,
    rules: DocumentRules {
        too_deep: rule::SCENE_JSON_TOO_DEEP,
        // A scene has at most a megabyte.
        too_large: None,
        syntax: rule::SCENE_JSON_SYNTAX,
        wrong_type: rule::SCENE_JSON_TYPE,
        version_missing: rule::SCENE_VERSION_MISSING,
        version_invalid: rule::SCENE_VERSION_INVALID,
        version_unsupported: rule::SCENE_VERSION_UNSUPPORTED,
        version_newer: rule::SCENE_VERSION_NEWER,
    },
};

/// Reads a scene, and checks everything that can be checked without opening the scene's files and
/// device. If the scene cannot be used, adds a finding with the reason and returns `None`. Never
/// panics.
pub fn read_scene(bytes: &[u8], limits: &Limits, findings: &mut Findings) -> Option<SceneFile> {
    if bytes.len() as u64 > limits.file_bytes {
        let message = format!("the scene has more than {} bytes", limits.file_bytes);
        findings.add(rule::SCENE_FILE_TOO_LARGE, "", message);
        return None;
    }
    let mut opened = DOCUMENT.open(bytes, limits.json_depth, usize::MAX, findings)?;
    if opened.newer {
        remove_unknown_effects(&mut opened.value);
    } else {
        check_effect_names(&opened.value, findings)?;
    }
    let (scene, unknown) = DOCUMENT.typed::<SceneFile>(&opened, findings)?;
    if !opened.newer {
        for pointer in unknown {
            let message = "version 1.0 has no such key; correct it or remove it".to_owned();
            findings.add(rule::SCENE_UNKNOWN_KEY, pointer, message);
        }
    }
    check(&scene, limits, findings);
    Some(scene)
}

fn is_effect(name: &str) -> bool {
    Effect::ALL.iter().any(|effect| effect.name() == name)
}

/// Removes effects from a scene that only a newer version of the format has.
fn remove_unknown_effects(scene: &mut Value) {
    let effects = scene.get_mut("effects").and_then(Value::as_object_mut);
    if let Some(effects) = effects {
        effects.retain(|name, _| is_effect(name));
    }
}

/// Checks the names of effects. Returns `None` if a name is unknown.
fn check_effect_names(scene: &Value, findings: &mut Findings) -> Option<()> {
    let effects = scene.get("effects").and_then(Value::as_object);
    let mut all_known = Some(());
    for name in effects.into_iter().flat_map(|map| map.keys()) {
        if !is_effect(name) {
            let names: Vec<&str> = Effect::ALL.iter().map(|effect| effect.name()).collect();
            let message = format!("unknown effect {name}; the effects are {}", names.join(", "));
            findings.add(rule::EFFECT_UNKNOWN, format!("/effects/{}", escape(name)), message);
            // No early return, so that all unknown names are reported.
            all_known = None;
        }
    }
    all_known
}
