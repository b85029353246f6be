//! `htex lib`: packing, looking into and unpacking libraries.

use std::path::Path;
use std::sync::LazyLock;

use crate::common::{Files, Place, entries};
use serde_json::{Value, json};

const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes");
const CONFORMANCE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/library-conformance");

fn example(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(EXAMPLES).join(name)).unwrap()
}

/// A folder `all` with three textures, one of them in a folder below.
fn place() -> Place {
    let place = Place::new();
    std::fs::create_dir_all(place.path("all/cloth")).unwrap();
    place.write("all/vinyl.htex", example("vinyl.htex"));
    place.write("all/cloth/coarse.htex", example("coarse-fabric.htex"));
    place.write("all/cloth/notes.txt", "no texture");
    let edit = ["edit", "all/vinyl.htex", "-o", "all/cloth/red vinyl.htex", "--tag", "Red"];
    assert_eq!(place.run(&edit).code(), 0);
    place
}

fn packed() -> Place {
    static PACKED: LazyLock<Files> = LazyLock::new(pack);
    Place::with(&PACKED)
}

fn pack() -> Files {
    let place = place();
    let run = place.run(&["lib", "pack", "all.htexlib", "all"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    assert!(run.text().starts_with("all.htexlib: 3 textures in "), "{}", run.text());
    place.files()
}

fn names(listed: &Value) -> Vec<&str> {
    listed.as_array().unwrap().iter().map(|entry| entry["name"].as_str().unwrap()).collect()
}

#[test]
fn a_folder_is_packed_listed_and_unpacked_byte_for_byte() {
    let place = packed();
    let listed = place.json(&["lib", "ls", "all.htexlib", "--json"]);
    assert_eq!(names(&listed), ["cloth/coarse", "cloth/red vinyl", "vinyl"]);
    let vinyl = &listed[2];
    let info = place.json(&["info", "all/vinyl.htex", "--json"]);
    let models = info["representations"].as_array().unwrap().iter();
    let models: Vec<&Value> = models.map(|r| &r["model"]).collect();
    assert_eq!(vinyl["models"], json!(models));
    assert_eq!(vinyl["bytes"], info["bytes"]);
    let tags = info["manifest"].get("tags").cloned();
    assert_eq!(vinyl["tags"], tags.unwrap_or(json!([])));
    let hash = blake3::hash(&example("vinyl.htex")).to_hex().to_string();
    assert_eq!(vinyl["blake3"], json!(hash));
    let contact = info["manifest"].get("contact").cloned();
    assert_eq!(vinyl["contact"], contact.unwrap_or(json!("unknown")));
    for key in ["frequency_speed", "level_speed", "level_force"] {
        for part in ["exponent", "source"] {
            assert_eq!(vinyl["law"][key][part], info["law"][key][part]);
        }
    }
    let speed = &info["manifest"]["conditions"][0]["speed_mm_s"];
    assert_eq!(vinyl["conditions"]["speed_mm_s"], json!({ "min": speed, "max": speed }));
    let text = place.run(&["lib", "ls", "all.htexlib"]).text();
    assert_eq!(text.lines().count(), 3);
    assert!(text.contains("red vinyl") && text.contains("speak"), "{text}");
    // Frequencies over the speed, level over speed and force, up to three decimals.
    let exponent =
        |key: &str| (vinyl["law"][key]["exponent"].as_f64().unwrap() * 1e3).round() / 1e3;
    let keys = ["frequency_speed", "level_speed", "level_force"];
    let [a, b, c] = keys.map(exponent);
    assert!(text.contains(&format!("  f^{a} v^{b} F^{c}  ")), "{text}");

    let run = place.run(&["lib", "unpack", "all.htexlib", "-o", "out/here"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    assert_eq!(entries(&place.path("out/here")), ["cloth", "vinyl.htex"]);
    for name in ["vinyl.htex", "cloth/coarse.htex", "cloth/red vinyl.htex"] {
        let read = |folder: &str| std::fs::read(place.path(&format!("{folder}/{name}"))).unwrap();
        assert_eq!(read("all"), read("out/here"), "{name}");
    }
    let again = place.run(&["lib", "unpack", "all.htexlib", "-o", "out/here", "vinyl"]);
    assert_eq!(again.code(), 1);
    assert!(again.error().contains("it is there already"), "{}", again.error());
    let forced = place.run(&["lib", "unpack", "all.htexlib", "-o", "out/here", "vinyl", "--force"]);
    assert_eq!(forced.code(), 0, "{}", forced.error());
}

#[test]
fn the_order_of_inputs_does_not_change_the_file_and_the_name_does() {
    let place = packed();
    let pack = |output: &str, rest: &[&str]| {
        let summary = place.json(&[&["lib", "pack", output, "--json"], rest].concat());
        let file = std::fs::read(place.path(output)).unwrap();
        assert_eq!(summary["bytes"], file.len());
        file
    };
    let files = ["all/vinyl.htex", "all/cloth/coarse.htex"];
    let first = pack("a.htexlib", &[&files[..], &["--name", "Some"]].concat());
    let second = pack("b.htexlib", &[files[1], files[0], "--name", "Some"]);
    assert_eq!(first, second);
    assert_ne!(first, pack("c.htexlib", &files));
    let listed = place.json(&["lib", "ls", "a.htexlib", "--json"]);
    assert_eq!(names(&listed), ["coarse", "vinyl"]);
    let same = place.json(&["lib", "diff", "a.htexlib", "c.htexlib", "--json"]);
    assert_eq!(same, json!({ "only_in_a": [], "only_in_b": [], "changed": [] }));
}

#[test]
fn one_texture_is_taken_out_and_opened() {
    let place = packed();
    let run = place.run(&["lib", "cat", "all.htexlib", "vinyl", "-o", "taken.htex"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    assert_eq!(std::fs::read(place.path("taken.htex")).unwrap(), example("vinyl.htex"));
    let mut piped = place.command(&["lib", "cat", "all.htexlib", "cloth/coarse"]);
    assert_eq!(piped.output().unwrap().stdout, example("coarse-fabric.htex"));
    let absent = place.run(&["lib", "cat", "all.htexlib", "velvet"]);
    assert_eq!(absent.code(), 1);
    assert!(absent.error().contains("there is no texture velvet"), "{}", absent.error());
    let over = place.run(&["lib", "cat", "all.htexlib", "vinyl", "-o", "all.htexlib"]);
    assert_eq!(over.code(), 2, "{}", over.error());
}

#[test]
fn searches_need_all_that_is_asked_for() {
    let place = packed();
    let found = |rest: &[&str]| {
        let listed = place.json(&[&["lib", "find", "all.htexlib", "--json"], rest].concat());
        names(&listed).join("; ")
    };
    assert_eq!(found(&["VINYL"]), "cloth/red vinyl; vinyl");
    assert_eq!(found(&["vinyl", "--tag", "red"]), "cloth/red vinyl");
    assert_eq!(found(&["--tag", "re"]), "");
    let info = place.json(&["info", "all/cloth/coarse.htex", "--json"]);
    let speed = info["manifest"]["conditions"][0]["speed_mm_s"].to_string();
    assert!(found(&["coarse", "--speed", &speed, "--model", "speak"]).contains("cloth/coarse"));
    assert_eq!(found(&["--speed", "100000"]), "");
    assert_eq!(found(&["--model", "org.example.none"]), "");
    let wrong = place.run(&["lib", "find", "all.htexlib", "--force=-1"]);
    assert_eq!(wrong.code(), 2);
    let none = place.run(&["lib", "find", "all.htexlib", "velvet"]);
    assert_eq!((none.code(), none.text().as_str()), (0, ""));
    assert!(none.error().contains("no texture"), "{}", none.error());
}

#[test]
fn differences_are_named_and_exit_with_1() {
    let place = packed();
    std::fs::create_dir(place.path("other")).unwrap();
    place.write("other/vinyl.htex", example("coarse-fabric.htex"));
    place.write("other/wood.htex", example("vinyl.htex"));
    assert_eq!(place.run(&["lib", "pack", "other.htexlib", "other"]).code(), 0);
    let run = place.run(&["lib", "diff", "all.htexlib", "other.htexlib"]);
    assert_eq!(run.code(), 1);
    assert_eq!(run.text(), "- cloth/coarse\n- cloth/red vinyl\n+ wood\n~ vinyl\n");
    assert_eq!(place.run(&["lib", "diff", "all.htexlib", "all.htexlib"]).code(), 0);
}

#[test]
fn a_library_is_recognised_by_its_first_bytes() {
    let place = packed();
    std::fs::rename(place.path("all.htexlib"), place.path("all.bin")).unwrap();
    let run = place.run(&["validate", "all.bin"]);
    assert_eq!((run.code(), run.text().as_str()), (0, "all.bin: valid\n"));
}

#[test]
fn what_cannot_be_packed_is_refused_and_nothing_is_left() {
    let place = packed();
    let kept = std::fs::read(place.path("all.htexlib")).unwrap();
    place.write("broken.htex", "no texture");
    place.write("big.htex", vec![0; (16 << 20) + 1]);
    std::fs::create_dir(place.path("empty")).unwrap();
    let before = entries(&place.path(""));
    for (inputs, code, words) in [
        (&["all", "broken.htex"][..], 1, "broken.htex: not a valid asset"),
        (&["big.htex"], 1, "big.htex: not a valid asset: FILE_TOO_LARGE"),
        (&["nowhere.htex"], 1, "nowhere.htex"),
        (&["empty"], 1, "no .htex file"),
        (&["all", "all/vinyl.htex"], 2, "would both be called \"vinyl\""),
    ] {
        let run = place.run(&[&["lib", "pack", "all.htexlib"], inputs].concat());
        assert_eq!(run.code(), code, "{inputs:?}: {}", run.error());
        assert!(run.error().contains(words), "{inputs:?}: {}", run.error());
        assert_eq!(run.error().lines().count(), 1, "{}", run.error());
    }
    let swapped = place.run(&["lib", "pack", "all/vinyl.htex", "all"]);
    assert_eq!(swapped.code(), 2, "{}", swapped.error());
    assert_eq!(entries(&place.path("")), before);
    assert_eq!(std::fs::read(place.path("all.htexlib")).unwrap(), kept);
}

/// A texture without a licence is packed only if the user allows it. The message names the texture
/// and says what to do.
#[test]
fn textures_without_a_licence_are_not_packed() {
    let place = packed();
    for name in ["all/bare.htex", "all/cloth/bare.htex"] {
        let edit = ["edit", "all/vinyl.htex", "-o", name, "--license", ""];
        assert_eq!(place.run(&edit).code(), 0);
    }
    let before = entries(&place.path(""));
    let pack = ["lib", "pack", "more.htexlib", "all"];
    let run = place.run(&pack);
    assert_eq!(run.code(), 1);
    let error = run.error();
    assert!(error.contains("bare and another texture state no licence"), "{error}");
    assert!(error.contains("htex edit all/bare.htex --license SPDX, or --unlicensed"));
    let one = ["lib", "pack", "one.htexlib", "all/bare.htex"];
    let error = place.run(&one).error();
    assert!(error.contains("bare states no licence"), "{error}");
    assert_eq!(entries(&place.path("")), before);
    let run = place.run(&[&pack[..], &["--unlicensed"]].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
    assert!(run.text().starts_with("more.htexlib: 5 textures in "));
    let edit = ["edit", "all/bare.htex", "--license", "MIT"];
    assert_eq!(place.run(&edit).code(), 0);
    assert_eq!(place.run(&one).code(), 0);
}

/// `htex validate` and `lib verify` refuse everything in a file that `lib unpack` refuses (sizes,
/// names, hashes). So a valid file unpacks whole.
#[test]
fn what_is_valid_unpacks() {
    let place = Place::new();
    let mut names = entries(Path::new(CONFORMANCE));
    names.retain(|name| name.ends_with(".htexlib"));
    let libraries: Vec<String> = names.iter().map(|n| format!("{CONFORMANCE}/{n}")).collect();
    let libraries: Vec<&str> = libraries.iter().map(String::as_str).collect();
    let [validated, verified] = [&["validate", "--json"][..], &["lib", "verify", "--json"]]
        .map(|command| place.run(&[command, &libraries].concat()).text());
    assert_eq!(validated, verified);
    let reports: Vec<Value> = serde_json::from_str(&validated).unwrap();
    let mut refused = 0;
    for ((name, library), report) in names.iter().zip(libraries).zip(&reports) {
        let unpacked = place.run(&["lib", "unpack", library, "-o", &format!("out/{name}")]);
        if unpacked.code() != 0 {
            assert_eq!(report["valid"], false, "{name}: {}", unpacked.error());
            refused += 1;
        }
    }
    assert!(refused > 30, "{refused}");
}
