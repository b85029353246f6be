//! Files that commands overwrite, and files that they leave.

use std::process::Stdio;

use crate::common::{Place, until};
use serde_json::json;

const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes");

/// A recording, an asset, a scene of it, and a response.
fn place() -> Place {
    let place = Place::new();
    place.recording("vinyl");
    place.write("cloth.htex", std::fs::read(format!("{EXAMPLES}/vinyl.htex")).unwrap());
    place.write("rig.csv", "frequency_hz,magnitude\n20,1\n1000,1\n");
    let more = json!({ "device": { "response": "rig.csv" }, "duration_s": 1 });
    place.scene("s.scene.json", "cloth.htex", &more);
    place
}

fn entries(place: &Place) -> Vec<(String, Vec<u8>)> {
    let all = std::fs::read_dir(place.path("")).unwrap().map(Result::unwrap);
    let mut all: Vec<_> = all
        .filter(|entry| entry.path().is_file())
        .map(|entry| {
            (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap())
        })
        .collect();
    all.sort();
    all
}

/// Under its own name, another spelling of it, a second name and a link.
#[cfg(unix)]
#[test]
fn no_command_writes_over_what_it_reads() {
    let place = place();
    // Second names have no extension, since the extension of another format would be refused first.
    for (file, second) in [("vinyl.csv", "second"), ("rig.csv", "rig"), ("s.scene.json", "scene")] {
        std::fs::hard_link(place.path(file), place.path(second)).unwrap();
    }
    std::os::unix::fs::symlink("cloth.htex", place.path("link.wav")).unwrap();
    std::os::unix::fs::symlink("cloth.htex", place.path("link.htex")).unwrap();
    std::fs::create_dir(place.path("sub")).unwrap();
    let before = entries(&place);
    for arguments in [
        &["fit", "second", "-o", "second"][..],
        &["fit", "second", "-o", "./sub/../second"],
        &["fit", "vinyl.csv", "-o", "second"],
        &["fit", "vinyl.csv", "--frf", "rig.csv", "-o", "rig"],
        &["process", "vinyl.csv", "--svg", "second"],
        &["process", "vinyl.csv", "--frf", "rig.csv", "--svg", "rig"],
        &["synth", "link.wav", "-o", "link.wav"],
        &["synth", "cloth.htex", "-o", "link.wav"],
        &["mix", "link.htex", "cloth.htex", "--weight", "0.5", "-o", "cloth.htex"],
        &["tradeoff", "vinyl.csv", "-o", "vinyl.html", "--quick"],
        &["tradeoff", "vinyl.csv", "--frf", "rig.csv", "-o", "rig.html", "--quick"],
        &["plan", "s.scene.json", "--svg", "scene"],
        &["plan", "s.scene.json", "--svg", "rig"],
        &["render", "s.scene.json", "-o", "rig.csv"],
        &["render", "s.scene.json", "-o", "link.wav"],
        &["play", "s.scene.json", "--set", "path=link.wav"],
        &["play", "cloth.htex", "--device", "file", "--set", "path=link.wav"],
        &["simulate", "--surface", "vinyl", "-o", "new.csv", "--frf", "new.csv"],
    ] {
        let run = place.run(arguments);
        assert_eq!(run.code(), 2, "{arguments:?}: {}", run.error());
        let words = ["it is read here, and would be lost", "two outputs would be written to it"];
        assert!(words.iter().any(|w| run.error().contains(w)), "{arguments:?}: {}", run.error());
        assert!(entries(&place) == before, "{arguments:?}");
    }
}

/// A file without a given name has the scene's name and the format's extension, and is not hidden.
#[test]
fn an_unnamed_file_is_called_as_its_scene_and_format() {
    let place = place();
    let display = json!({ "adapter": "daq", "profile": "pcie-6321_tabor-9200a_sct3250" });
    for (scene, device, file) in [
        ("one.two.scene.json", json!({ "settings": { "format": "csv" } }), "one.two.csv"),
        (".cloth.scene.json", json!({}), "cloth.wav"),
        (".display.v2.scene.json", display, "display.v2.wav"),
    ] {
        place.scene(scene, "cloth.htex", &json!({ "device": device, "duration_s": 0.1 }));
        let run = place.run(&["render", scene]);
        assert_eq!(run.code(), 0, "{}", run.error());
        assert!(entries(&place).iter().any(|(name, _)| name == file), "{file}");
    }
}

/// The journal of a sweep does not take the name of another file.
#[test]
fn a_file_that_is_no_journal_is_left_alone() {
    let place = place();
    place.write("vinyl-2.part", "my notes\n");
    let run = place.run(&["tradeoff", "vinyl.csv", "-o", "vinyl-2.html", "--quick"]);
    assert_eq!(run.code(), 1);
    assert!(run.error().contains("not the journal of an interrupted sweep"), "{}", run.error());
    assert_eq!(std::fs::read(place.path("vinyl-2.part")).unwrap(), b"my notes\n");
}

/// A scene cannot name an output file. Output that the user did not name goes to a new, visible
/// file with the ending of its format.
#[test]
fn a_scene_names_no_output() {
    let place = place();
    let text = std::fs::read_to_string(place.path("s.scene.json")).unwrap();
    let mut scene: serde_json::Value = serde_json::from_str(&text).unwrap();
    std::fs::create_dir(place.path("deep")).unwrap();
    for path in [".bashrc", "deep/.git-config", "../out.wav", "/tmp/out.wav", "link"] {
        scene["device"]["settings"] = json!({ "path": path, "format": "raw" });
        place.write(".s.scene.json", scene.to_string());
        let before = entries(&place);
        let run = place.run(&["play", ".s.scene.json"]);
        assert_eq!(run.code(), 0, "{path}: {}", run.error());
        assert!(run.error().contains("DEVICE_PATH_UNUSED"), "{path}: {}", run.error());
        let mut after = entries(&place);
        after.retain(|entry| !before.contains(entry));
        let names: Vec<&str> = after.iter().map(|(name, _)| &name[..]).collect();
        assert_eq!(names, ["s.raw"], "{path}");
        assert!(std::fs::read_dir(place.path("deep")).unwrap().next().is_none());
        // The second time it exists.
        let again = place.run(&["play", ".s.scene.json"]);
        assert_eq!(again.code(), 2, "{}", again.error());
        assert!(again.error().contains("s.raw exists"), "{}", again.error());
        std::fs::remove_file(place.path("s.raw")).unwrap();
    }
    let rendered = ["render", "s.scene.json"];
    assert_eq!(place.run(&rendered).code(), 0);
    assert_eq!(place.run(&rendered).code(), 2);
    assert_eq!(place.run(&[&rendered[..], &["-o", "s.wav"]].concat()).code(), 0);
}

/// A program that is asked to end, by any signal, leaves no unfinished file.
#[cfg(unix)]
#[test]
fn an_ended_program_leaves_no_part() {
    for signal in ["-TERM", "-HUP", "-INT"] {
        let place = place();
        let before = entries(&place);
        let arguments = ["synth", "cloth.htex", "--seconds", "20000", "-o", "long.wav"];
        let mut child = place.command(&arguments).stderr(Stdio::piped()).spawn().unwrap();
        until("something is written", || entries(&place).len() > before.len());
        crate::common::signal(&child, signal);
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
        assert!(entries(&place) == before, "{signal}");
    }
}

/// An argument that is a path of this machine takes no URI, and an output no extension of another
/// format: nothing is written.
#[test]
fn no_output_is_another_place_or_format_than_its_name_says() {
    let place = place();
    let before = entries(&place);
    let uris: [&[&str]; 10] = [
        &["lib", "unpack", "a.htexlib", "-o", "s3://bucket/key"],
        &["demo", "s3://bucket/key"],
        &["man", "gs://bucket/key"],
        &["tradeoff", "vinyl.csv", "-o", "s3://bucket/t.html"],
        &["study", "export", "s3://bucket/answers", "-o", "a.csv"],
        &["study", "run", "s.toml", "--participant", "P01", "-o", "az://container/answers"],
        &["study", "plan", "https://example.org/study.toml"],
        &["plugin", "new", "felt", "--lang", "rust", "--dir", "s3://bucket/key"],
        &["device", "new", "felt", "--lang", "c", "--dir", "s3://bucket/key"],
        &["record", "--source", "file:vinyl.csv", "--take", "x", "-o", "ftp://host/d"],
    ];
    for arguments in uris {
        let run = place.run(arguments);
        assert_eq!(run.code(), 2, "{arguments:?}: {}", run.error());
        let said = run.error();
        let is_named = said.contains("takes a path of this machine, not a URI")
            || said.contains("its scheme is none of");
        assert!(is_named, "{arguments:?}: {said}");
    }
    let formats: [(&[&str], &str); 8] = [
        (&["tradeoff", "vinyl.csv", "-o", "t.json"], "ends in .html"),
        (&["study", "export", "answers", "-o", "a.parquet"], "ends in .csv"),
        (&["study", "export", "answers", "-o", "a.jsonl"], "ends in .csv"),
        (&["study", "plan", "s.toml", "-o", "plan.csv"], "ends in .json"),
        (&["simulate", "--surface", "vinyl", "-o", "v.json"], "ends in .csv"),
        (&["synth", "cloth.htex", "-o", "v.FLAC"], "ends in .wav"),
        (&["fit", "vinyl.csv", "-o", "v.htexlib"], "ends in .htex"),
        (&["lib", "pack", "v.htex", "cloth.htex"], "ends in .htexlib"),
    ];
    for (arguments, end) in formats {
        let run = place.run(arguments);
        assert_eq!(run.code(), 2, "{arguments:?}: {}", run.error());
        assert!(run.error().contains(end), "{arguments:?}: {}", run.error());
    }
    assert!(entries(&place) == before);
    for folder in ["s3:", "gs:", "az:", "ftp:"] {
        assert!(!place.path(folder).exists(), "{folder}");
    }
    // A name without a known format is the user's.
    place.json(&["info", "cloth.htex", "--json"]);
    let run = place.run(&["synth", "cloth.htex", "--seconds", "0.1", "-o", "sound.dat"]);
    assert_eq!(run.code(), 0, "{}", run.error());
}

/// A relative folder in a variable of htex is an error; one in a variable of all programs is
/// ignored, and said.
#[test]
fn a_relative_folder_of_the_environment_is_not_ignored_in_silence() {
    let place = place();
    for variable in ["HTEX_CONFIG_DIR", "HTEX_CACHE_DIR"] {
        let mut command = place.command(&["info", "cloth.htex"]);
        let run = command.env(variable, "relative").output().unwrap();
        let said = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(2), "{said}");
        let expected = format!("{variable} is relative, which is no absolute path; give one");
        assert!(said.contains(&expected), "{said}");
    }
    let mut command = place.command(&["info", "cloth.htex"]);
    let run = command.env("XDG_CONFIG_HOME", "relative").output().unwrap();
    let said = String::from_utf8(run.stderr).unwrap();
    assert!(run.status.success(), "{said}");
    assert!(said.contains("XDG_CONFIG_HOME is relative"), "{said}");
    assert!(said.contains("it is ignored"), "{said}");
}

/// An output that is not a regular file is kept, and a closed standard error is not a failure.
#[cfg(unix)]
#[test]
fn devices_stay_devices_and_a_closed_standard_error_is_no_panic() {
    use std::os::unix::fs::FileTypeExt;
    let place = place();
    let run = place.run(&["fit", "vinyl.csv", "--model", "sslope", "-o", "/dev/null"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    let htex = env!("CARGO_BIN_EXE_htex");
    for (words, code) in
        [("fit vinyl.csv -o x.htex", 0), ("info nothing.htex", 1), ("validate vinyl.csv", 0)]
    {
        let shell = format!("'{htex}' {words} 2>&-");
        let done = std::process::Command::new("sh")
            .args(["-c", &shell])
            .current_dir(place.path(""))
            .stdout(Stdio::null())
            .status()
            .unwrap();
        assert_eq!(done.code(), Some(code), "{words}");
    }
}

/// Files with names that are not Unicode are read and written.
#[cfg(target_os = "linux")]
#[test]
fn names_that_are_no_unicode_are_kept() {
    use std::ffi::{OsStr, OsString};
    use std::os::unix::ffi::OsStrExt;
    let place = place();
    let named = |ending: &str| -> OsString {
        [OsStr::from_bytes(b"caf\xe9"), OsStr::new(ending)].into_iter().collect()
    };
    let before = std::fs::read_dir(place.path(".")).unwrap().count();
    std::fs::copy(place.path("vinyl.csv"), place.path(".").join(named(".csv"))).unwrap();
    place.scene("own.scene.json", "cloth.htex", &json!({ "duration_s": 0.2 }));
    for (command, input, output) in [
        ("fit", named(".csv"), named(".htex")),
        ("info", named(".htex"), OsString::new()),
        ("validate", named(".htex"), OsString::new()),
        ("process", named(".csv"), OsString::new()),
        ("synth", named(".htex"), named(".wav")),
        ("render", "own.scene.json".into(), named(".npy")),
    ] {
        let mut run = place.command(&[command]);
        run.arg(&input);
        if !output.is_empty() {
            run.arg("-o").arg(&output);
        }
        let run = run.output().unwrap();
        let error = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(0), "{command}: {error}");
        assert!(output.is_empty() || place.path(".").join(&output).is_file(), "{command}");
    }
    // The four, the scene, and the licence beside what has no place for it.
    let after = std::fs::read_dir(place.path(".")).unwrap().count();
    assert_eq!(after, before + 6, "no file of another name");
}
