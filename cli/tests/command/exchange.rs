//! `htex import`, `htex export` and `htex formats`, as a user runs them.

use std::sync::LazyLock;

use serde_json::{Value, json};

use crate::common::{Files, Place, words};

/// Half a second of a hum that grows.
const HAPTIC: &str = include_str!("../../../sdk/make/exchange/tests/hum.haptic");

/// A model file of the Penn Haptic Texture Toolkit with four nodes, of which two are silent.
const HATT: &str = include_str!("../../../sdk/make/exchange/tests/felt.xml");

const GIVEN: &str = "--full-scale 0.2 --speed 80 --force 0.4";

/// Runs a line, and expects a status.
fn run(place: &Place, line: &str, code: i32) -> (String, String) {
    let run = place.run(&words(line));
    assert_eq!(run.code(), code, "{line}: {}{}", run.text(), run.error());
    (run.text(), run.error())
}

fn imported() -> Place {
    static IMPORTED: LazyLock<Files> = LazyLock::new(import);
    Place::with(&IMPORTED)
}

fn import() -> Files {
    let place = Place::new();
    place.write("hum.haptic", HAPTIC);
    run(
        &place,
        &format!("import hum.haptic {GIVEN} --model bands --license CC0-1.0 -o hum.htex"),
        0,
    );
    place.files()
}

#[test]
fn a_signal_is_imported_with_what_it_does_not_say() {
    let place = Place::new();
    place.write("hum.haptic", HAPTIC);
    let line = format!(
        "import hum.haptic {GIVEN} --model bands --option bands.bands=12 --license CC0-1.0 -o hum.htex"
    );
    let (text, error) = run(&place, &line, 0);
    assert!(text.starts_with("imported hum.haptic\nhum.htex: "), "{text}");
    assert!(error.contains("Its 0.500 s are repeated 8 times."), "{error}");
    let made = place.json(&words(&format!("{line} --json")));
    assert_eq!(made["manifest"]["license"], "CC0-1.0");
    assert_eq!(made["manifest"]["conditions"], json!([{"speed_mm_s": 80.0, "force_n": 0.4}]));
    assert_eq!(made["representations"].as_array().unwrap().len(), 1);
    let warnings = &made["manifest"]["provenance"]["warnings"];
    assert!(warnings.to_string().contains("repeated 8 times"), "{made}");
    run(&place, "validate hum.htex", 0);

    // A licence is asked for.
    assert!(!error.contains("no licence"), "{error}");
    let (_, error) =
        run(&place, &format!("import hum.haptic {GIVEN} --model bands -o bare.htex"), 0);
    assert!(error.contains("It states no licence") && error.contains("--license"), "{error}");

    // What the file does not say is asked for, by flags.
    let (_, error) = run(&place, "import hum.haptic --speed 80 -o other.htex", 2);
    assert!(
        error.contains(
            "does not say how strong 1 is and at which force; give --full-scale and --force"
        ),
        "{error}"
    );
    let (_, error) =
        run(&place, "import hum.haptic --full-scale 0 --speed 80 --force 1 -o other.htex", 2);
    assert!(error.contains("--full-scale 0: more than 0, at most 1e6"), "{error}");
    assert!(!place.path("other.htex").exists());
}

/// A file of the toolkit begins at rest. What is not told a motion plays the strongest condition:
/// 240 mm/s and 3 N.
#[test]
fn a_silent_first_condition_gives_way_to_the_strongest() {
    let place = Place::new();
    place.write("felt.xml", HATT);
    run(&place, "import felt.xml --license CC0-1.0 -o felt.htex", 0);
    let spectrum = |given: &str| run(&place, &format!("spectrum felt.htex {given}"), 0).0;
    assert_eq!(spectrum(""), spectrum("--speed 240 --force 3"));
    assert_eq!(spectrum("--speed 120"), spectrum("--speed 120 --force 3"));
    assert_eq!(spectrum("--force 2"), spectrum("--speed 240 --force 2"));
    let largest = |file: &str| place.samples(file).iter().fold(0.0f32, |most, x| most.max(x.abs()));
    let (_, error) = run(&place, "synth felt.htex --seconds 0.5 -o felt.wav", 0);
    assert!(!error.contains("all samples are 0"), "{error}");
    assert!(largest("felt.wav") > 0.3);
    for format in ["ahap", "haptic", "hjif", "android", "wav", "png"] {
        run(&place, &format!("export felt.htex --to {format} -o out.{format}"), 0);
    }
    let baked = place.json(&words("bake felt.htex -o felt.bin --json"));
    assert_eq!(baked["speeds_mm_s"][0], 240.0);
    assert_eq!(baked["forces_n"][0], 3.0);
    run(
        &place,
        "play felt.htex --device file --set path=played.wav --set quantity=acceleration --seconds 0.5",
        0,
    );
    assert!(largest("played.wav") > 0.0);

    // Nothing to feel is said.
    let (_, error) = run(&place, "synth felt.htex --speed 0 --seconds 0.1 -o rest.wav", 0);
    assert!(error.contains("rest.wav: all samples are 0"), "{error}");
    run(&place, "export felt.htex --speed 0 --to ahap -o rest.ahap", 1);
    assert!(!place.path("rest.ahap").exists());
}

/// An effect that exists, but that nobody can feel.
#[test]
fn an_effect_below_the_detection_threshold_is_not_exported() {
    let place = Place::new();
    place.write("hum.haptic", HAPTIC);
    let import = "import hum.haptic --speed 80 --force 0.5 --model bands --license CC0-1.0";
    run(&place, &format!("{import} --full-scale 1e-7 -o faint.htex"), 0);
    for format in ["ahap", "haptic", "hjif", "android", "wav"] {
        let (_, error) =
            run(&place, &format!("export faint.htex --to {format} -o faint.{format}"), 1);
        assert!(error.contains("below the detection threshold"), "{error}");
        assert!(!place.path(&format!("faint.{format}")).exists());
    }
}

#[test]
fn a_model_file_states_all_and_takes_no_flag_of_a_signal() {
    let place = Place::new();
    place.write("felt.xml", HATT);
    let made = place.json(&words("import felt.xml --license CC-BY-4.0 -o felt.htex --json"));
    let manifest = &made["manifest"];
    assert_eq!(manifest["license"], "CC-BY-4.0");
    assert_eq!(manifest["quantity"], "acceleration");
    assert_eq!(manifest["conditions"].as_array().unwrap().len(), 4);
    run(&place, "validate felt.htex", 0);
    for flag in [
        "--full-scale 1",
        "--speed 80",
        "--force 1",
        "--quantity acceleration",
        "--profile quest",
        "--model arma",
        "--model all",
        "--level recording",
        "--keep-reference",
        "--option arma.poles=2",
        "--grid auto",
    ] {
        let (_, error) = run(&place, &format!("import felt.xml {flag} -o other.htex"), 2);
        let name = flag.split(' ').next().unwrap();
        assert!(error.contains(&format!("its import takes no {name}; leave it out")), "{error}");
    }
    assert!(!place.path("other.htex").exists());

    // A silent node is not exported.
    let line = "export felt.htex --to wav --speed 240 --force 0 -o felt.wav";
    let (_, error) = run(&place, line, 1);
    assert!(error.contains("silent at this motion"), "{error}");
    assert!(!place.path("felt.wav").exists());
    let line = "export felt.htex --to wav --speed 240 --force 3 -o felt.wav";
    run(&place, line, 0);
}

#[test]
fn an_import_takes_no_flag_that_the_format_has_no_use_for() {
    let place = Place::new();
    place.write("hum.haptic", HAPTIC);
    let (_, error) = run(&place, &format!("import hum.haptic {GIVEN} --grid auto -o hum.htex"), 2);
    assert!(
        error.contains("takes no --grid; leave it out (it takes --full-scale, --quantity"),
        "{error}"
    );
}

#[test]
fn files_that_are_none_are_refused_with_their_place() {
    let place = Place::new();
    place.write("loud.haptic", HAPTIC.replace("0.6", "1.6"));
    place.write("hum.mp3", "");
    let (_, error) = run(&place, &format!("import loud.haptic {GIVEN} -o out.htex"), 1);
    let pointer = "loud.haptic: /signals/continuous/envelopes/amplitude/1/amplitude: ";
    assert!(error.contains(pointer), "{error}");
    let (_, error) = run(&place, "import hum.mp3 -o out.htex", 2);
    assert!(error.contains("hum.mp3: no format that is read has this extension; there are .xml, .haptic, .ahap, .hjif, .png, .glb and .gltf"), "{error}");
    let (_, error) = run(&place, &format!("import loud.haptic {GIVEN} -o loud.haptic"), 2);
    assert!(error.contains("loud.haptic"), "{error}");
    assert!(!place.path("out.htex").exists());
}

#[test]
fn an_export_says_what_is_lost() {
    let place = imported();
    for (to, file) in [
        ("haptic", "out.haptic"),
        ("ahap", "out.ahap"),
        ("android", "out.json"),
        ("android", "out.kt"),
        ("hjif", "out.hjif"),
        ("wav", "out.wav"),
    ] {
        let line = format!("export hum.htex --to {to} -o {file}");
        let (text, error) = run(&place, &line, 0);
        let rights = "\nIt states the licence CC0-1.0 (";
        for part in ["lost: felt ", "nine bands ", "level ", "the format loses ", rights] {
            assert!(text.contains(part), "{to}: {text}");
        }
        assert!(error.contains("are assumed, not measured"), "{to}: {error}");
        let first = std::fs::read(place.path(file)).unwrap();
        let told = place.json(&words(&format!("{line} --json")));
        assert_eq!(told["format"], to);
        assert_eq!(told["bytes"], first.len());
        assert!(text.ends_with(&format!("{}\n", told["rights"].as_str().unwrap())), "{text}");
        assert_eq!(told["seconds"], 2.0);
        assert!(told["lost"]["level_db"].is_f64() && told["limited"].is_number());
        assert!(told["lost"]["band_error_rms_db"].is_f64(), "{told}");
        assert_eq!(std::fs::read(place.path(file)).unwrap(), first, "{to}");
    }
    let kotlin = std::fs::read_to_string(place.path("out.kt")).unwrap();
    assert!(
        kotlin.starts_with(
            "// SPDX-License-Identifier: CC0-1.0\nimport android.os.VibrationEffect\n"
        ),
        "{kotlin}"
    );
    // What was written comes in again.
    for file in ["out.haptic", "out.ahap", "out.hjif"] {
        run(&place, &format!("import {file} {GIVEN} --model bands -o again.htex"), 0);
    }
}

/// The file comes back bit for bit, unless metadata is given.
#[test]
fn a_mesh_carries_the_file_there_and_back() {
    let place = imported();
    let file = std::fs::read(place.path("hum.htex")).unwrap();
    for mesh in ["hum.glb", "hum.gltf"] {
        let (text, error) = run(&place, &format!("export hum.htex --to gltf -o {mesh}"), 0);
        assert!(text.contains("the format loses nothing of a texture"), "{text}");
        assert!(!text.contains("lost: felt") && error.is_empty(), "{text}{error}");
        let told = place.json(&words(&format!("import {mesh} -o again.htex --json")));
        assert_eq!(told["manifest"]["license"], "CC0-1.0");
        assert_eq!(std::fs::read(place.path("again.htex")).unwrap(), file);
    }
    let told = place.json(&words("export hum.htex --to gltf -o hum.gltf --json"));
    assert_eq!(told["format"], "gltf");
    run(&place, "import hum.glb --license CC-BY-4.0 -o other.htex", 0);
    assert_ne!(std::fs::read(place.path("other.htex")).unwrap(), file);

    for flag in ["--speed 80 --force 0.4", "--profile quest", "--seed 1"] {
        let (_, error) = run(&place, &format!("export hum.htex --to gltf {flag} -o none.glb"), 2);
        let name = flag.split(' ').next().unwrap();
        assert!(error.contains(&format!("its export takes no {name}; leave it out")), "{error}");
    }
    let (_, error) = run(&place, "import hum.glb --speed 80 -o none.htex", 2);
    assert!(error.contains("its import takes no --speed"), "{error}");
    assert!(!place.path("none.htex").exists() && !place.path("none.glb").exists());
}

#[test]
fn an_export_follows_condition_stroke_and_profile() {
    let place = imported();
    let mut stroke = String::from("t_s,speed_mm_s,force_n\n");
    for i in 0..=20 {
        stroke += &format!("{},{},0.4\n", 0.1 * f64::from(i), 40 + 4 * i);
    }
    place.write("stroke.csv", stroke);
    let bytes = |rest: &str| {
        let told =
            place.json(&words(&format!("export hum.htex --to haptic {rest} -o out.haptic --json")));
        let file: Value =
            serde_json::from_slice(&std::fs::read(place.path("out.haptic")).unwrap()).unwrap();
        (told, file)
    };
    let (_, plain) = bytes("");
    let (told, fast) = bytes("--speed 160 --force 0.4 --seconds 1");
    assert_eq!(told["seconds"], 1.0);
    assert!(told["notes"].to_string().contains("160 mm/s, where "), "{told}");
    assert_ne!(plain, fast);
    let (told, along) = bytes("--stroke stroke.csv");
    assert_eq!(told["seconds"], 2.0);
    assert_ne!(plain, along);
    let (told, _) = bytes("--profile erm --model bands");
    assert_eq!(told["profile"], "erm");
    let (_, error) =
        run(&place, "export hum.htex --to haptic --stroke stroke.csv --speed 80 -o out.haptic", 2);
    assert!(error.contains("cannot be used with"), "{error}");
}

/// A scene is exported as what it plays, for as long as it lasts: one with the texture alone as the
/// texture, others with what their own render plays.
#[test]
fn a_scene_goes_out_as_it_plays() {
    let place = imported();
    let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/scenes");
    let scene = |name: &str| scenes.join(name).display().to_string();
    let told = |line: String| place.json(&words(&format!("export {line} --json")));
    let asset = scene("coarse-fabric.htex");
    let surfaces = json!([{ "asset": asset, "representation": "sslope" }]);
    place.scene("one.scene.json", "", &json!({ "surfaces": surfaces, "duration_s": 5 }));
    let at = "--to wav --model sslope --speed 80 --force 0.4 --seconds 5";
    let alone = told(format!("{asset} {at} -o alone.wav"));
    let constant = told("one.scene.json --to wav -o scene.wav".to_owned());
    assert_eq!(constant["seconds"], 5.0);
    for name in ["level_db", "third_octave_error_rms_db"] {
        let [a, b] = [&alone, &constant].map(|told| told["lost"][name].as_f64().unwrap());
        assert!((a - b).abs() < 0.5, "{name}: {a} dB and {b} dB");
    }
    for to in ["haptic", "ahap", "android", "hjif", "wav"] {
        let several = told(format!("{} --to {to} -o out.bin", scene("two-swatches.scene.json")));
        assert!(several["lost"]["level_db"].is_f64(), "{to}: {several}");
        assert!(several["seconds"].as_f64().unwrap() > 1.0, "{to}: {several}");
    }
    let short = told(format!("{} --to hjif --seconds 1 -o out.hjif", scene("constant.scene.json")));
    assert_eq!(short["seconds"], 1.0);
    for (name, rest, part) in [
        (
            "constant.scene.json",
            "--to wav --speed 40 --force 0.4",
            "its export of a scene takes no --speed",
        ),
        ("constant.scene.json", "--to wav --seed 0", "its export of a scene takes no --seed"),
        ("constant.scene.json", "--to gltf", "export the scene's assets"),
        ("live.scene.json", "--to wav", "its motion is live"),
        ("no.scene.json", "--to wav", "no.scene.json"),
    ] {
        let run = place.run(&words(&format!("export {} {rest} -o none.bin", scene(name))));
        assert_ne!(run.code(), 0, "{name} {rest}");
        assert!(run.error().contains(part), "{name} {rest}: {}", run.error());
    }
    assert!(!place.path("none.bin").exists());
}

/// A row of a texture, which comes in as a map, is played, and goes out as the same row.
#[test]
fn a_map_goes_out_and_comes_in() {
    let place = imported();
    let (text, error) =
        run(&place, "export hum.htex --to png --speed 80 --force 0.4 -o row.png", 0);
    assert!(text.contains("lost: felt ") && text.contains("level +0.0 dB"), "{text}");
    let (_, white) = error.split_once("White is ").unwrap();
    let (white, _) = white.split_once(' ').unwrap();
    let given = format!("--full-scale {white} --speed 80 --force 0.4");
    run(&place, &format!("import row.png {given} -o map.htex"), 0);
    run(&place, "export map.htex --to png -o again.png", 0);
    let read = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert_eq!(read("row.png"), read("again.png"));
    let level = |name: &str| {
        let told = place.json(&words(&format!("spectrum {name} --speed 80 --force 0.4 --json")));
        let magnitude = told["magnitude"].as_array().unwrap();
        let power: f64 = magnitude.iter().map(|m| m.as_f64().unwrap().powi(2)).sum();
        power.sqrt()
    };
    let level_db = 20.0 * (level("map.htex") / level("hum.htex")).log10();
    assert!(level_db.abs() < 0.1, "{level_db} dB");
    run(&place, "synth map.htex --speed 160 --force 0.4 --seconds 1 -o map.wav", 0);
    let (_, error) = run(&place, "export map.htex --to png --speed 80 -o none.png", 1);
    assert!(error.contains("the same at every motion; leave out speed and force"), "{error}");
    let (_, error) = run(&place, "import row.png -o none.htex", 2);
    assert!(error.contains("give --full-scale, --speed and --force"), "{error}");
    let (_, error) = run(&place, &format!("import row.png {given} --pitch 0 -o none.htex"), 2);
    assert!(error.contains("--pitch 0: more than 0 mm"), "{error}");
}

#[test]
fn an_export_takes_no_flag_that_the_format_has_no_use_for() {
    let place = imported();
    for (to, flag) in [
        ("wav", "--coding wavelet"),
        ("haptic", "--coding vectorial"),
        ("haptic", "--rate 8000"),
        ("hjif", "--rate 8000"),
        ("android", "--rate 8000"),
        ("png", "--seconds 3"),
        ("png", "--profile quest"),
    ] {
        let (_, error) = run(&place, &format!("export hum.htex --to {to} {flag} -o out.bin"), 2);
        let name = flag.split(' ').next().unwrap();
        assert!(error.contains(&format!("its export takes no {name}; leave it out")), "{error}");
    }
    for (rest, expected) in [
        ("--to hatt", "invalid value 'hatt'"),
        ("--to bmp", "invalid value 'bmp'"),
        ("--to wav --profile phone", "invalid value 'phone'"),
        ("--to wav --profile erm", "choose haptic, ahap or android"),
        ("--to wav --seconds 0.1", "--seconds 0.1: 0.5 to 600 s"),
        ("--to wav --rate 1000", "--rate 1000: twice the texture's highest frequency"),
    ] {
        let (_, error) = run(&place, &format!("export hum.htex {rest} -o out.bin"), 2);
        assert!(error.contains(expected), "{rest}: {error}");
    }
    let (_, error) = run(&place, "export hum.htex --to wav --model nothing -o out.bin", 1);
    assert!(error.contains("no representation `nothing`"), "{error}");
    run(&place, "export hum.htex --to wav -o hum.htex", 2);
    assert!(!place.path("out.bin").exists());
}

#[test]
fn formats_lists_what_is_kept_and_lost() {
    let place = Place::new();
    let (text, _) = run(&place, "formats", 0);
    for part in [
        "hatt     Penn Haptic Texture Toolkit, XML (.xml): import\n",
        "haptic   Meta .haptic, version 1 (.haptic): import with --full-scale, --speed and --force; export\n",
        "wav      WAV that drives an actuator (.wav): export\n",
        "         keeps level and one frequency over time\n",
        "profiles of actuators:\nquest ",
    ] {
        assert!(text.contains(part), "{text}");
    }
    let told = place.json(&["formats", "--json"]);
    let formats = told["formats"].as_array().unwrap();
    let names: Vec<&str> = formats.iter().map(|f| f["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["hatt", "haptic", "ahap", "android", "hjif", "wav", "png", "gltf"]);
    assert_eq!(formats[7]["export"], "asset");
    assert_eq!(formats[7]["export_settings"], json!([]));
    assert_eq!(formats[0]["import"], "asset");
    assert_eq!(formats[0]["import_settings"], json!([]));
    assert_eq!(formats[0]["export"], Value::Null);
    assert_eq!(formats[4]["export_settings"].as_array().unwrap().last().unwrap(), "coding");
    let profile = &told["profiles"][0];
    assert_eq!(profile["name"], "quest");
    assert!(profile["low_hz"]["source"].as_str().unwrap().contains("MetaQuest.acf"));
}

/// What is written of a texture states its licence and its author: in the file, or beside it. An
/// import reads them again.
#[test]
fn every_way_out_carries_the_licence() {
    let place = Place::new();
    place.write("hum.haptic", HAPTIC);
    let stated = "--license CC-BY-4.0 --author Ada";
    run(&place, &format!("import hum.haptic {GIVEN} --model bands {stated} -o hum.htex"), 0);
    let has_both = |file: &str| {
        let bytes = std::fs::read(place.path(file)).unwrap();
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let tag = "SPDX-License-Identifier: CC-BY-4.0";
        assert!(text.contains(tag) && text.contains("Ada"), "{file}");
    };
    for (format, file, back) in [
        ("haptic", "a.haptic", Some(GIVEN)),
        ("ahap", "a.ahap", Some(GIVEN)),
        ("hjif", "a.hjif", Some(GIVEN)),
        ("png", "a.png", Some(GIVEN)),
        ("gltf", "a.glb", Some("")),
        ("gltf", "b.gltf", Some("")),
        ("android", "a.json", None),
        ("android", "a.kt", None),
        ("wav", "a.wav", None),
    ] {
        run(&place, &format!("export hum.htex --to {format} -o {file}"), 0);
        has_both(file);
        let Some(given) = back else { continue };
        let import = |more: &str| format!("import {file} {given} {more} -o again.htex --json");
        let again = place.json(&words(&import("")));
        assert_eq!(again["manifest"]["license"], "CC-BY-4.0", "{file}");
        assert_eq!(again["manifest"]["author"], "Ada", "{file}");
        // A flag is stronger, and another statement beside the file is an error.
        let other = place.json(&words(&import("--license MIT")));
        assert_eq!(other["manifest"]["license"], "MIT", "{file}");
        place.write(&format!("{file}.license"), "SPDX-License-Identifier: MIT\n");
        let (_, error) = run(&place, &import(""), 2);
        assert!(
            error.contains("\"CC-BY-4.0\" and \"MIT\"") && error.contains("--license"),
            "{error}"
        );
        run(&place, &import("--license MIT"), 0);
    }
    // Samples stay as they are.
    run(&place, "synth hum.htex --seconds 1 -o with.wav", 0);
    has_both("with.wav");
    run(&place, "edit hum.htex --license= --author= -o bare.htex", 0);
    run(&place, "synth bare.htex --seconds 1 -o without.wav", 0);
    assert_eq!(place.samples("with.wav"), place.samples("without.wav"));

    // What has no place has a file beside it, which is an output like the other one.
    run(&place, "bake hum.htex -o hum.h", 0);
    run(&place, "bake hum.htex -o hum.rs", 0);
    run(&place, "bake hum.htex -o hum.bin", 0);
    ["hum.h", "hum.rs", "hum.bin.license"].iter().for_each(|file| has_both(file));
    assert!(!place.path("hum.h.license").exists());
    std::fs::copy(place.path("hum.htex"), place.path("x.bin.license")).unwrap();
    let (_, error) = run(&place, "bake x.bin.license -o x.bin", 2);
    assert!(error.contains("it is read here"), "{error}");
    place.scene("hum.scene.json", "hum.htex", &json!({}));
    run(&place, "render hum.scene.json --seconds 1 -o hum.csv", 0);
    run(&place, "render hum.scene.json --seconds 1 -o scene.wav", 0);
    ["hum.csv.license", "scene.wav"].iter().for_each(|file| has_both(file));

    // A model file has no place either.
    place.write("felt.xml", HATT);
    place.write(
        "felt.xml.license",
        "SPDX-FileCopyrightText: Ada\nSPDX-License-Identifier: CC-BY-4.0\n",
    );
    let felt = &place.json(&words("import felt.xml -o felt.htex --json"))["manifest"];
    assert_eq!((&felt["license"], &felt["author"]), (&json!("CC-BY-4.0"), &json!("Ada")));
    let all = place.json(&["formats", "--json"]);
    let places = all["formats"].as_array().unwrap().iter().map(|f| f["rights"].as_str());
    assert!(places.into_iter().all(|place| place.is_some_and(|place| !place.is_empty())));
}
