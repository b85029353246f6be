//! Models of third parties: an asset that a newer version fitted, where older versions are
//! installed, and a model that fails. Version 1.1.0 has a field more, which is fitted at its bound,
//! 0.2.

use std::path::Path;

use crate::common::{Place, Run};
use crate::model::{ID, with_descriptor};
use htex::model::Search;
use htex::{Registry, Texture, VoiceOptions};
use serde_json::json;

pub(crate) const FIELDS: &str = concat!(
    r#"{"name":"centre_hz","unit":"Hz","kind":{"type":"scalar"},"min":5,"max":2000,"store":{"type":"f32"},"description":"C."},"#,
    r#"{"name":"bandwidth_hz","unit":"Hz","kind":{"type":"scalar"},"min":20,"max":2000,"store":{"type":"f32"},"description":"B."}"#
);

fn descriptor(version: &str, has_tilt: bool) -> String {
    let tilt = if has_tilt {
        r#",{"name":"tilt","unit":"1","kind":{"type":"scalar"},"min":0,"max":0.2,"store":{"type":"f32"},"default":0,"description":"T."}"#
    } else {
        ""
    };
    format!(
        r#"{{"id":"{ID}","name":"H","version":"{version}","summary":"S.","fields":[{FIELDS}{tilt}]}}"#
    )
}

/// White noise, as a module.
fn module(version: &str, has_tilt: bool) -> Vec<u8> {
    noise(&descriptor(version, has_tilt), has_tilt)
}

/// White noise with two parameters, or three if it has a tilt, as a module with this descriptor.
pub(crate) fn noise(descriptor: &str, has_tilt: bool) -> Vec<u8> {
    let count = if has_tilt { 3 } else { 2 };
    let fit = format!(
        "(f64.store (local.get 10) (f64.const 200)) (f64.store offset=8 (local.get 10) (f64.const 100))
         (if (i32.ge_u (local.get 11) (i32.const 3)) (then (f64.store offset=16 (local.get 10) (f64.const 0.2))))
         (f64.store (local.get 12) (f64.const 0.1)) (i64.const {count})"
    );
    let interpolate = format!(
        "(memory.copy (local.get 4) (local.get 0) (i32.const {})) (i64.const {count})",
        8 * count
    );
    let changed = [
        ("fit", &fit[..]),
        (
            "magnitude",
            "(block $done (loop $next (br_if $done (i32.eqz (local.get 6)))
               (f64.store (local.get 5) (select (f64.const 0.1234) (f64.const 0) (i32.and
                 (f64.ge (f64.load (local.get 4)) (local.get 2)) (f64.le (f64.load (local.get 4)) (local.get 3)))))
               (local.set 4 (i32.add (local.get 4) (i32.const 8)))
               (local.set 5 (i32.add (local.get 5) (i32.const 8)))
               (local.set 6 (i32.sub (local.get 6) (i32.const 1))) (br $next)))
             (i64.const 0)",
        ),
        ("interpolate", &interpolate),
        (
            "voice_render",
            "(block $done (loop $next (br_if $done (i32.eqz (local.get 2)))
               (global.set $r (i32.add (i32.mul (global.get $r) (i32.const 1664525)) (i32.const 1013904223)))
               (f32.store (local.get 1) (f32.div (f32.convert_i32_s (global.get $r)) (f32.const 1239850262)))
               (local.set 1 (i32.add (local.get 1) (i32.const 4)))
               (local.set 2 (i32.sub (local.get 2) (i32.const 1))) (br $next)))
             (i64.const 0)",
        ),
    ];
    let random = "(global $r (mut i32) (i32.const 1))";
    let text = with_descriptor(descriptor, &changed, random);
    // A recording's signal needs more memory than most tests.
    wat::parse_str(
        text.replace("(memory (export \"memory\") 8)", "(memory (export \"memory\") 80)"),
    )
    .unwrap()
}

/// A resonance, as a library: the template of `htex plugin new`, in its own folder.
#[cfg(unix)]
fn library(place: &Place, version: &str, has_tilt: bool) -> std::path::PathBuf {
    let name = format!("native-{version}");
    let new = ["plugin", "new", "resonance", "--lang", "c", "--dir", &name];
    assert_eq!(place.run(&new).code(), 0);
    let file = place.path(&name).join("model.c");
    let mut text = std::fs::read_to_string(&file).unwrap();
    let start = text.find("static const char DESCRIPTOR[]").unwrap();
    let end = start + text[start..].find(";\n").unwrap();
    let json = descriptor(version, has_tilt).replace('"', "\\\"");
    text.replace_range(start..end, &format!("static const char DESCRIPTOR[] = \"{json}\""));
    if has_tilt {
        text = text
            .replace("BANDWIDTH, PARAMETERS", "BANDWIDTH, TILT, PARAMETERS")
            .replace("MIN[PARAMETERS] = {5.0, 20.0}", "MIN[PARAMETERS] = {5.0, 20.0, 0.0}")
            .replace("{2000.0, 2000.0};", "{2000.0, 2000.0, 0.2};")
            .replace(
                "    for (size_t i = 0; i < PARAMETERS && i < capacity; i++)\n        parameters[i] = p[i];",
                "    p[TILT] = 0.2;\n    for (size_t i = 0; i < PARAMETERS && i < capacity; i++)\n        parameters[i] = p[i];",
            )
            .replace(
                "    return HTEX_OK;\n}\n\nstatic int64_t check_parameters",
                "    if (!within(p[TILT], 0.0, 0.2))\n        return fail(HTEX_INVALID_PARAMETERS, \"tilt: 0 to 0.2\");\n    \
                 return HTEX_OK;\n}\n\nstatic int64_t check_parameters",
            );
    }
    std::fs::write(&file, text).unwrap();
    let built =
        std::process::Command::new("sh").arg(place.path(&name).join("build.sh")).output().unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    place.path(&name).join(format!("resonance{}", std::env::consts::DLL_SUFFIX))
}

/// A folder of plugins by their file names.
fn folder(place: &Place, name: &str, files: &[(&str, &Path)]) -> String {
    std::fs::create_dir(place.path(name)).unwrap();
    for (file, from) in files {
        std::fs::copy(from, place.path(name).join(file)).unwrap();
    }
    place.path(name).to_str().unwrap().to_owned()
}

/// Runs with a folder of installed models.
fn run_with(place: &Place, installed: &str, arguments: &[&str]) -> Run {
    let mut command = place.command(arguments);
    command.env("HTEX_PLUGIN_PATH", installed);
    command.env("HTEX_CACHE_DIR", place.path("cache"));
    Run::of(command.output().unwrap())
}

/// Everything that is done with an asset, of the model.
fn all_commands<'a>(recording: &'a str, asset: &'a str) -> Vec<Vec<&'a str>> {
    vec![
        vec!["info", asset],
        vec!["validate", asset],
        vec!["validate", "--embedded-plugins", asset],
        vec!["synth", asset, "--model", "hostile", "--seconds", "0.2", "-o", "a.wav"],
        vec!["spectrum", asset, "--model", "hostile"],
        vec!["edit", asset, "--name", "Other", "-o", "edited.htex"],
        vec!["export", asset, "--model", "hostile", "--to", "wav", "-o", "b.wav"],
        vec!["bake", asset, "--model", "hostile", "-o", "c.bin"],
        vec!["compare", recording, asset],
        vec!["plan", "scene.json"],
        vec!["render", "scene.json", "-o", "d.wav"],
    ]
}

#[test]
fn an_older_installed_model_does_not_break_an_asset() {
    let place = Place::new();
    let (old, new) = (
        place.write("old.wasm", module("1.0.0", false)),
        place.write("new.wasm", module("1.1.0", true)),
    );
    let recording = place.recording("sandpaper");
    let fit = ["fit", &recording, "--model", "hostile,sbeta", "-o"];
    let embedding = ["embedded.htex", "--embed-plugin", "new.wasm"];
    let run = place.run(&[&fit[..], &embedding].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
    let run = place.run(&[&fit[..], &["plain.htex", "--plugin", "new.wasm"]].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
    let surfaces = json!([{ "asset": "embedded.htex", "representation": "hostile" }]);
    place.scene("scene.json", "", &json!({ "surfaces": surfaces, "duration_s": 0.2 }));

    let mut older = vec![old.clone()];
    #[cfg(unix)]
    older.push(library(&place, "1.0.0", false));
    for (i, older) in older.iter().enumerate() {
        let extension = older.extension().unwrap().to_str().unwrap();
        let file = format!("a.{extension}");
        let installed = folder(&place, &format!("installed-{i}"), &[(&file, older)]);
        let named = format!("--plugin={}", older.display());
        for arguments in all_commands(&recording, "embedded.htex") {
            let run = run_with(&place, &installed, &arguments);
            assert_eq!(run.code(), 0, "{arguments:?}: {}", run.error());
            let takes_plugins = !["info", "validate", "edit"].contains(&arguments[0]);
            if takes_plugins {
                let run = place.run(&[&arguments[..], &[&named]].concat());
                assert_eq!(run.code(), 0, "{arguments:?} {named}: {}", run.error());
            }
        }
        let needed = format!("install version 1.1.0 or newer of {ID}");
        let synth = ["synth", "plain.htex", "--seconds", "0.2", "-o", "a.wav"];
        let run = run_with(&place, &installed, &[&synth[..], &["--model", "hostile"]].concat());
        assert_eq!(run.code(), 1, "{}", run.error());
        assert!(run.error().contains(&needed), "{}", run.error());
        // Another representation is played where none is named.
        let run = run_with(&place, &installed, &synth);
        assert_eq!(run.code(), 0, "{}", run.error());
        let off = ["spectrum", "embedded.htex", "--model", "hostile", "--no-embedded-plugins"];
        let run = run_with(&place, &installed, &off);
        assert_eq!(run.code(), 2, "{}", run.error());
        for words in [&needed[..], "--no-embedded-plugins"] {
            assert!(run.error().contains(words), "{}", run.error());
        }
    }

    // The newest version in a folder plays, whatever its file is called.
    let both = folder(&place, "both", &[("a.wasm", &old), ("b.wasm", &new)]);
    let spectrum = ["spectrum", "plain.htex", "--model", "hostile"];
    let run = run_with(&place, &both, &spectrum);
    assert_eq!(run.code(), 0, "{}", run.error());
    #[cfg(unix)]
    {
        let newer = library(&place, "1.1.0", true);
        let suffix = std::env::consts::DLL_SUFFIX;
        let (a, b) = (format!("a{suffix}"), format!("b{suffix}"));
        let files: [(&str, &Path); 2] = [(&a, &older[1]), (&b, &newer)];
        let both = folder(&place, "both-native", &files);
        let run = run_with(&place, &both, &spectrum);
        assert_eq!(run.code(), 0, "{}", run.error());
    }

    // As programs in C and pages do it, with a model that they were given in memory.
    let mut registry = Registry::search(&Search::builtin()).unwrap();
    let bytes = std::fs::read(&old).unwrap();
    registry.add_wasm_bytes("module 0", &bytes).unwrap();
    let data = htex_format::Asset::open(&place.path("embedded.htex")).unwrap();
    let asset = Texture::with_registry(data, registry);
    let options = VoiceOptions::default();
    let refused = asset.representation(ID).unwrap().voice(&options).unwrap_err().to_string();
    assert!(refused.contains("install version 1.1.0 or newer"), "{refused}");
    assert!(asset.with_embedded().representation(ID).unwrap().voice(&options).is_ok());
}

/// A model that the user names is never left out silently if it fails. Other models may be.
#[test]
fn a_named_model_that_cannot_be_fitted_is_a_failure() {
    let place = Place::new();
    let failing = [("fit", "(i64.const -4)")];
    let module = wat::parse_str(with_descriptor(&descriptor("1.0.0", false), &failing, ""));
    place.write("failing.wasm", module.unwrap());
    let recording = place.recording("sandpaper");
    let fit = ["fit", &recording, "--plugin", "failing.wasm", "-o", "a.htex"];
    let run = place.run(&[&fit[..], &["--model", "hostile,sbeta"]].concat());
    assert_eq!(run.code(), 1, "{}", run.error());
    for words in ["named by `--model`", ID] {
        assert!(run.error().contains(words), "{}", run.error());
    }
    let made = htex_format::Asset::open(&place.path("a.htex")).unwrap();
    assert_eq!(made.manifest.representations.len(), 1, "what could be made was written");
    let run = place.run(&[&fit[..], &["--model", "all"]].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
}
