//! A file of every feature of the format through every command that takes an asset: an exit status
//! that is expected, no number that is infinite or none, and one choice of the model in all
//! commands.

use std::fs::File;
use std::process::Stdio;
use std::sync::LazyLock;

use crate::common::{Files, Place, Run, entries};
use htex_format::{Asset, Fluctuation};
use serde_json::json;

const COMPAT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/compat/0.2.0");

/// One condition, four, a filter with zeros, a friction map, an embedded module, a mixture; three
/// speeds with computed conditions, the same without measures, with a silent first condition, and with a
/// fluctuation in time.
const FILES: [&str; 10] = [
    "one.htex",
    "grid.htex",
    "arma.htex",
    "map.htex",
    "embedded.htex",
    "mixed.htex",
    "three.htex",
    "unmeasured.htex",
    "silent.htex",
    "fluctuating.htex",
];

/// What may be refused, with the reason: a file, a command and words of its error.
const REFUSED: [(&str, &str, &str); 8] = [
    ("arma.htex", "mix", "no model describes both"),
    ("map.htex", "mix", "no model describes both"),
    ("embedded.htex", "mix", "no model describes both"),
    ("map.htex", "bake", "plays from the position of the finger"),
    ("embedded.htex", "bake", "plays from the position of the finger"),
    ("mixed.htex", "lib", "states no licence"),
    ("silent.htex", "bake", "the speeds of the grid: [0.0]"),
    ("silent.htex", "export", "silent"),
];

fn place() -> Place {
    static MADE: LazyLock<Files> = LazyLock::new(files);
    Place::with(&MADE)
}

fn files() -> Files {
    let place = Place::new();
    for name in FILES.iter().take(6) {
        place.write(name, std::fs::read(format!("{COMPAT}/{name}")).unwrap());
    }
    let speeds = ["40", "80", "160"].map(|speed| {
        let name = format!("at-{speed}.csv");
        let surface = ["--surface", "sandpaper", "--seconds", "4"];
        place.simulated(&name, &[&surface[..], &["--speed", speed, "--force", "0.4"]].concat());
        name
    });
    let fit = ["fit", &speeds[0], &speeds[1], &speeds[2]];
    let to = ["--name", "Three", "--license", "CC0-1.0", "-o", "three.htex"];
    let run = place.run(&[&fit[..], &to].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
    let three = Asset::open(&place.path("three.htex")).unwrap();
    let mut unmeasured = three.clone();
    for representation in &mut unmeasured.manifest.representations {
        representation.at.iter_mut().for_each(|at| at.quality = None);
    }
    place.write("unmeasured.htex", unmeasured.to_bytes().unwrap());
    let mut fluctuating = three.clone();
    fluctuating.manifest.fluctuation =
        Some(Fluctuation { slow: 112, fast: 71, ..Fluctuation::default() });
    place.write("fluctuating.htex", fluctuating.to_bytes().unwrap());
    let mut silent = three;
    let first = silent.manifest.representations[0].at[0].condition;
    silent.manifest.conditions[first].speed_mm_s = Some(0.0);
    for representation in &mut silent.manifest.representations {
        representation.at[0].level_rms = 0.0;
        representation.at[0].quality = None;
    }
    place.write("silent.htex", silent.to_bytes().unwrap());
    for name in FILES {
        let effects = match name {
            "fluctuating.htex" => json!({ "fluctuation": "on" }),
            _ => json!({}),
        };
        let more = json!({ "duration_s": 0.2, "effects": effects });
        place.scene(&format!("{name}.scene.json"), name, &more);
    }
    place.files()
}

/// The commands that take an asset or a scene of it; `FILE` is its name.
const COMMANDS: &[&[&str]] = &[
    &["info", "FILE"],
    &["info", "FILE", "--json"],
    &["validate", "FILE", "--json"],
    &["spectrum", "FILE", "--json"],
    &["spectrum", "FILE", "--speed", "500", "--force", "3"],
    &["synth", "FILE", "--seconds", "0.2", "-o", "out.wav"],
    &["synth", "FILE", "--seconds", "0.2", "--fluctuation", "-o", "out.wav"],
    &["synth", "FILE", "--seconds", "0.2", "--quality", "loop", "-o", "out.wav"],
    &["synth", "FILE", "--seconds", "0.2", "--rate", "2000", "-o", "out.wav"],
    &["edit", "FILE", "--name", "Other", "-o", "out.htex"],
    &["compare", "at-80.csv", "FILE", "--json"],
    &["bake", "FILE", "-o", "out.bin", "--json"],
    &["mix", "FILE", "one.htex", "--weight", "0.5", "-o", "out.htex"],
    &["play", "FILE", "--device", "file", "--set", "path=out.wav", "--seconds", "0.1"],
    &[
        "play",
        "FILE",
        "--fluctuation",
        "--device",
        "file",
        "--set",
        "path=out.wav",
        "--seconds",
        "0.1",
    ],
    &["plan", "FILE.scene.json"],
    &["plan", "FILE.scene.json", "--measure"],
    &["render", "FILE.scene.json", "-o", "out.wav"],
    &["lib", "pack", "out.htexlib", "FILE"],
    &["lib", "ls", "out.htexlib", "--json"],
    &["export", "FILE", "--to", "png", "-o", "out.png"],
    &["export", "FILE", "--to", "hjif", "-o", "out.hjif"],
    &["export", "FILE", "--to", "haptic", "-o", "out.haptic"],
    &["export", "FILE", "--to", "ahap", "-o", "out.ahap"],
];

#[test]
fn every_command_takes_a_file_of_every_feature() {
    let place = place();
    let mut wrong = Vec::new();
    for name in FILES {
        // What measures the costs of models does not depend on the file.
        let commands = COMMANDS.iter().filter(|c| name == FILES[0] || !c.contains(&"--measure"));
        for command in commands {
            let arguments: Vec<String> = command.iter().map(|a| a.replace("FILE", name)).collect();
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            let run = place.run(&arguments);
            let reason = REFUSED.iter().find(|(file, of, _)| *file == name && of == &command[0]);
            let refused = reason.is_some_and(|(.., words)| {
                [1, 2].contains(&run.code()) && run.error().contains(words)
            });
            let expected = run.code() == 0 || refused;
            let printed = run.text() + &run.error();
            let words = printed.split(|c: char| !c.is_ascii_alphanumeric());
            let numbers =
                words.filter(|word| ["inf", "nan", "infinity"].contains(&&word.to_lowercase()[..]));
            if !expected || numbers.count() > 0 {
                wrong.push(format!("{arguments:?}: {}: {printed}", run.code()));
            }
            entries_away(&place);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A texture of a library, and standard input, are what a file is.
#[test]
fn every_command_takes_a_texture_of_a_library_and_standard_input() {
    let place = place();
    let pack = ["lib", "pack", "all.htexlib", "one.htex", "three.htex"];
    assert_eq!(place.run(&pack).code(), 0);
    place.scene("in-library.scene.json", "all.htexlib#three", &json!({ "duration_s": 0.2 }));
    let outcome = |arguments: &[&str], input: Option<&str>| {
        let mut command = place.command(arguments);
        command.stdin(
            input.map_or(Stdio::null(), |name| File::open(place.path(name)).unwrap().into()),
        );
        let run = Run::of(command.output().unwrap());
        let files: Vec<_> = entries(place.path("").as_path())
            .into_iter()
            .filter(|name| name.starts_with("out."))
            .map(|name| (std::fs::read(place.path(&name)).unwrap(), name))
            .collect();
        for (_, name) in &files {
            std::fs::remove_file(place.path(name)).unwrap();
        }
        (run.code(), run.text(), files)
    };
    // The output of `lib pack` is read by the next command, and names are those of files.
    let commands = COMMANDS.iter().filter(|c| c.contains(&"FILE") && c[0] != "lib");
    for command in commands {
        let with = |name: &str, input: Option<&str>| {
            let arguments: Vec<&str> =
                command.iter().map(|a| if *a == "FILE" { name } else { a }).collect();
            outcome(&arguments, input)
        };
        let (code, text, files) = with("three.htex", None);
        assert_eq!(code, 0, "{command:?}");
        for (name, input) in [("all.htexlib#three", None), ("-", Some("three.htex"))] {
            let (code, other, made) = with(name, input);
            assert_eq!((code, other), (0, text.replace("three.htex", name)), "{command:?}");
            assert!(made == files, "{command:?} of {name}");
        }
    }
    let render = |scene: &str| outcome(&["render", scene, "-o", "out.wav"], None).2;
    assert!(render("in-library.scene.json") == render("three.htex.scene.json"));

    let two = place.json(&["info", "all.htexlib#*", "--json"]);
    let names = ["all.htexlib#one", "all.htexlib#three"];
    assert_eq!([&two[0]["asset"], &two[1]["asset"]], names);
    let valid = place.json(&["validate", "all.htexlib#t*", "--json"]);
    assert_eq!(valid[0]["file"], names[1], "{valid}");
    for (arguments, words) in [
        (
            &["info", "all.htexlib#thre"][..],
            "all.htexlib: there is no texture thre in the library; its most similar names are three",
        ),
        (&["info", "all.htexlib#x*"], "all.htexlib#x*: no texture has such a name"),
        (&["synth", "all.htexlib#*", "-o", "out.wav"], "one texture is needed here"),
        (&["info", "none.htexlib#one"], "none.htexlib"),
        (&["edit", "all.htexlib#one", "--name", "Other"], "name another file to write by -o"),
        (&["info", "all.htexlib"], "all.htexlib#NAME"),
    ] {
        let run = place.run(arguments);
        assert!(run.code() != 0 && run.error().contains(words), "{arguments:?}: {}", run.error());
    }
}

/// Results of a command, which the next one would not overwrite.
fn entries_away(place: &Place) {
    for name in ["out.htex", "out.png", "out.bin"] {
        let _ = std::fs::remove_file(place.path(name));
    }
}

/// A scene, a voice and the spectrum play one model.
#[test]
fn all_commands_choose_one_model() {
    let place = place();
    for name in FILES {
        let plan = place.json(&["plan", &format!("{name}.scene.json"), "--json"]);
        let in_scene = plan["representation"][0]["model"].as_str().unwrap().to_owned();
        let wav = |arguments: &[&str]| {
            assert_eq!(place.run(arguments).code(), 0, "{arguments:?}");
            std::fs::read(place.path("out.wav")).unwrap()
        };
        let synth = ["synth", name, "--seconds", "0.2", "-o", "out.wav"];
        let named = [&synth[..], &["--model", &in_scene]].concat();
        assert!(wav(&synth) == wav(&named), "{name}: {in_scene}");
    }
}
