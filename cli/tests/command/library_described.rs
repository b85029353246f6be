//! What a library says about itself, searches by rights and spectra, and libraries of version 1.0.

use serde_json::Value;

use crate::common::Place;

const OLD: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/library-conformance/valid_version_1_0.htexlib");

fn make(place: &Place, name: &str, alpha: &str, level: &str, rights: [&str; 2]) {
    let by = ["make", "--model", "sbeta", "--set", alpha, "beta=5", "--level", level];
    let at = ["--at", "speed=80,force=0.5", "--license", rights[0], "--author", rights[1]];
    let file = format!("textures/{name}.htex");
    let run = place.run(&[&by[..], &at, &["--name", name, "-o", &file]].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
}

/// Four textures: two of them are nearly the same, and one is far from all others.
fn place() -> Place {
    let place = Place::new();
    std::fs::create_dir(place.path("textures")).unwrap();
    make(&place, "cotton", "alpha=2", "0.02", ["CC-BY-4.0", "Ana"]);
    make(&place, "cotton again", "alpha=2", "0.0201", ["CC-BY-4.0", "Ben"]);
    make(&place, "linen", "alpha=2.2", "0.025", ["CC0-1.0", "Ana"]);
    make(&place, "stone", "alpha=6", "0.2", ["CC0-1.0", "Ben"]);
    let described = ["--describe", "version=1.2", "--describe", "authors=Ana; Ben"];
    let pack = ["lib", "pack", "all.htexlib", "textures", "--name", "All"];
    assert_eq!(place.run(&[&pack[..], &described].concat()).code(), 0);
    place
}

fn names(listed: &Value) -> Vec<&str> {
    listed.as_array().unwrap().iter().map(|entry| entry["name"].as_str().unwrap()).collect()
}

fn find(place: &Place, more: &[&str]) -> Value {
    place.json(&[&["lib", "find", "all.htexlib", "--json"], more].concat())
}

#[test]
fn a_library_says_what_it_is() {
    let place = place();
    let info = |library: &str| place.json(&["lib", "info", library, "--json"]);
    let said = info("all.htexlib");
    assert_eq!(
        [&said["name"], &said["version"], &said["textures"]],
        [&Value::from("All"), &"1.2".into(), &4.into()]
    );
    assert_eq!(said["authors"], serde_json::json!(["Ana", "Ben"]));
    assert_eq!(said["licenses"], serde_json::json!({ "CC-BY-4.0": 2, "CC0-1.0": 2 }));
    assert_eq!(said["quantities"], serde_json::json!({ "lateral_force": 4 }));
    let text = place.run(&["lib", "info", "all.htexlib"]).text();
    assert!(text.starts_with("All 1.2\nauthors      Ana, Ben\n"), "{text}");

    let describe = ["--describe", "version=1.3", "--describe", "authors="];
    let date = ["--describe", "date=2026-11-30", "--describe", "description=Two\nlines"];
    let edit = ["lib", "edit", "all.htexlib", "--json"];
    let edited = place.json(&[&edit[..], &describe, &date].concat());
    assert_eq!(edited["edited"], 0);
    let new = info("all.htexlib");
    assert_eq!(
        [&new["version"], &new["date"], &new["authors"]],
        [&"1.3".into(), &"2026-11-30".into(), &Value::Null]
    );
    assert!(new["blake3"] != said["blake3"] && new["bytes"].as_u64() > said["bytes"].as_u64());
    // Other edits keep it, and a merged library is another one.
    place.json(&["lib", "edit", "all.htexlib", "--add-tag", "x", "--json"]);
    assert_eq!(info("all.htexlib")["version"], "1.3");
    let merge = ["lib", "merge", "all.htexlib", "-o", "merged.htexlib", "--describe", "version=2"];
    assert_eq!(place.run(&merge).code(), 0);
    let merged = info("merged.htexlib");
    assert_eq!([&merged["version"], &merged["date"]], [&"2".into(), &Value::Null]);

    for (wrong, words) in [
        ("date=yesterday", "date is no date"),
        ("licence=CC0-1.0", "a library has no entry licence"),
        ("version", "give ENTRY=TEXT"),
    ] {
        let run = place.run(&["lib", "edit", "all.htexlib", "--describe", wrong]);
        assert!(run.code() == 2 && run.error().contains(words), "{}", run.error());
    }
}

#[test]
fn a_library_is_the_one_that_was_published() {
    let place = place();
    let hash = place.json(&["lib", "info", "all.htexlib", "--json"])["blake3"].clone();
    let verify = |hash: &str| place.run(&["lib", "verify", "all.htexlib", "--blake3", hash]);
    assert_eq!(verify(hash.as_str().unwrap()).code(), 0);
    let other = verify(&"0".repeat(64));
    assert!(other.code() == 1 && other.error().contains("it is another library"));
    assert_eq!(verify("abc").code(), 2);
}

#[test]
fn textures_are_found_by_rights_quantity_and_felt_difference() {
    let place = place();
    assert_eq!(names(&find(&place, &["--license", "cc-*"])), ["cotton", "cotton again"]);
    assert_eq!(names(&find(&place, &["--author", "ben", "--license", "CC0*"])), ["stone"]);
    assert_eq!(names(&find(&place, &["--quantity", "lateral_force"])).len(), 4);
    assert_eq!(names(&find(&place, &["--quantity", "acceleration"])).len(), 0);
    // What was made by hand has no recording to differ from.
    assert_eq!(names(&find(&place, &["--max-felt", "9"])).len(), 0);
    let exists = |license: &str| {
        place.run(&["lib", "find", "all.htexlib", "--license", license, "--exists"]).code()
    };
    assert_eq!([exists("CC0-1.0"), exists("MIT")], [0, 1]);
    let wrong = place.run(&["lib", "find", "all.htexlib", "--quantity", "weight"]);
    assert!(wrong.code() == 2 && wrong.error().contains("lateral-force"), "{}", wrong.error());
}

/// The held-out error of the index is the one that the texture states.
#[test]
fn textures_are_found_by_their_held_out_error() {
    let place = Place::new();
    place.simulated("vinyl.csv", &["--surface", "vinyl", "--seconds", "10"]);
    for line in [
        "fit vinyl.csv --model bands --license CC0-1.0 -o vinyl.htex",
        "lib pack all.htexlib vinyl.htex",
    ] {
        let run = place.run(&line.split_whitespace().collect::<Vec<_>>());
        assert_eq!(run.code(), 0, "{}", run.error());
    }
    let info = place.json(&["info", "vinyl.htex", "--json"]);
    let stated = info["representations"][0]["at"][0]["held_out_error_db"].as_f64().unwrap();
    let known = find(&place, &[])[0]["held_out_error_db"].as_f64().unwrap();
    // Rounded up to hundredths.
    assert!(known >= stated && known < stated + 0.0101, "{known}, {stated}");
    let found = |most: f64| find(&place, &["--max-held-out", &most.to_string()]);
    assert_eq!([names(&found(known)).len(), names(&found(known - 0.01)).len()], [1, 0]);
}

#[test]
fn textures_are_found_by_their_spectra() {
    let place = place();
    let near = find(&place, &["--like", "cotton", "-n", "3"]);
    assert_eq!(names(&near), ["cotton", "cotton again", "linen"]);
    let distances: Vec<f64> =
        near.as_array().unwrap().iter().map(|one| one["distance_db"].as_f64().unwrap()).collect();
    // Both differ only by their levels, 20 log10(0.0201 / 0.02).
    assert_eq!(distances[0], 0.0);
    assert!((distances[1] - 0.043).abs() < 0.02, "{distances:?}");
    let by_file = find(&place, &["--like", "textures/cotton.htex", "-n", "3"]);
    assert_eq!(by_file, near);
    assert_eq!(find(&place, &["--like", "all.htexlib#cotton", "-n", "3"]), near);
    assert_eq!(
        names(&find(&place, &["--like", "cotton", "-n", "1", "--author", "Ben"])),
        ["cotton again"]
    );

    // The texture of a recording is nearest to it.
    let recording = place.recording("vinyl");
    let fit = ["fit", &recording, "-o", "vinyl.htex", "--model", "bands", "--license", "MIT"];
    assert_eq!(place.run(&fit).code(), 0);
    let add = ["lib", "edit", "all.htexlib", "--add", "vinyl.htex"];
    assert_eq!(place.run(&add).code(), 0);
    let near = find(&place, &["--like", &recording, "-n", "2"]);
    assert_eq!(names(&near)[0], "vinyl");
    let distance = |i: usize| near[i]["distance_db"].as_f64().unwrap();
    assert!(distance(0) < 2.0 && distance(1) > 2.0 * distance(0), "{near}");
    assert_eq!(place.run(&["lib", "edit", "all.htexlib", "--remove", "vinyl"]).code(), 0);

    let twice = find(&place, &["--duplicates", "--within", "0.1"]);
    assert_eq!(names(&twice), ["cotton again"]);
    assert_eq!(twice[0]["duplicate_of"], "cotton");
    assert_eq!(names(&find(&place, &["--duplicates", "--within", "60"])).len(), 3);
    let absent = place.run(&["lib", "find", "all.htexlib", "--like", "coton"]);
    assert!(absent.code() != 0 && absent.error().contains("cotton"), "{}", absent.error());
    assert_eq!(place.run(&["lib", "find", "all.htexlib", "-n", "3"]).code(), 2);
}

/// Every command takes a library of version 1.0, and packing it gives one of version 1.1.
#[test]
fn libraries_of_version_1_0_are_read_and_packed_again() {
    let place = Place::new();
    let old = OLD;
    let info = |library: &str| place.json(&["lib", "info", library, "--json"]);
    let said = info(old);
    assert_eq!([&said["format"], &said["textures"]], [&Value::from("1.0"), &4.into()]);
    assert_eq!(said["licenses"], serde_json::json!({}));
    let asked = place.run(&["lib", "find", old, "--license", "CC0-1.0"]);
    assert!(asked.error().contains("version 1.0") && asked.text().is_empty(), "{}", asked.error());
    for command in [
        &["lib", "ls", old][..],
        &["lib", "verify", old],
        &["lib", "find", old, "--duplicates"],
        &["lib", "diff", old, old],
        &["lib", "unpack", old, "-o", "out"],
        &["info", &format!("{old}#felt")],
        &["lib", "export", old, "--to", "wav", "-o", "exported"],
        &["lib", "edit", old, "-o", "edited.htexlib", "--add-tag", "x", "--where", "license=CC0*"],
        &["lib", "merge", old, "-o", "merged.htexlib"],
        &["lib", "pack", "new.htexlib", old, "--name", "Raw"],
        &["lib", "pack", "files.htexlib", "out", "--name", "Raw"],
    ] {
        let run = place.run(command);
        assert_eq!(run.code(), 0, "{command:?}: {}", run.error());
    }
    for library in ["edited.htexlib", "merged.htexlib", "new.htexlib"] {
        let new = info(library);
        assert_eq!([&new["format"], &new["licenses"]["CC0-1.0"]], [&Value::from("1.1"), &4.into()]);
        let like = place.json(&["lib", "find", library, "--like", "felt", "-n", "9", "--json"]);
        assert_eq!(names(&like).len(), 4, "{library}");
    }
    let bytes = |file: &str| std::fs::read(place.path(file)).unwrap();
    assert!(bytes("new.htexlib") == bytes("files.htexlib"));
}

/// A page like the one that the studio's build makes.
const PAGE: &str = "<meta content=\"connect-src 'self'; base-uri 'none'\"><title>__TITLE__</title>\
    <script id=\"textures\">__TEXTURES__</script><script id=\"options\">__OPTIONS__</script>";

#[test]
fn a_catalogue_is_a_filled_page_beside_the_library() {
    let place = place();
    place.json(&["lib", "edit", "all.htexlib", "-o", "odd #1.htexlib", "--add-tag", "x", "--json"]);
    let catalogue = |more: &[&str]| {
        place.run(&[&["lib", "catalogue", "odd #1.htexlib", "--folder", "page"], more].concat())
    };
    let missing = catalogue(&["-o", "site"]);
    assert!(missing.code() == 1 && missing.error().contains("cargo xtask studio"));
    std::fs::create_dir(place.path("page")).unwrap();
    place.write("page/catalogue.html", "no places");
    let other = catalogue(&["-o", "site"]);
    assert!(other.code() == 1 && other.error().contains("it is not the page of catalogues"));
    assert!(!place.path("site").exists());

    place.write("page/catalogue.html", PAGE);
    let report = r#"{"report":"htex-build-report/1","program":"</script>","library":{"name":"a","file":"a","bytes":1,"blake3":"","textures":1,"left_out":1},"felt_shares":{},"findings":{},"textures":[{"name":"gone","status":"left_out","key":"","recordings":[],"missed":[{"gate":"fit","reason":"it is clipped"}]}]}"#;
    place.write("report.json", report);
    let written = catalogue(&["-o", "site", "--report", "report.json"]);
    assert_eq!(written.code(), 0, "{}", written.error());
    let page = std::fs::read_to_string(place.path("site/index.html")).unwrap();
    assert!(page.contains("<title>All</title>") && page.contains("connect-src 'self';"), "{page}");
    assert!(page.contains(r#""library":"odd%20%231.htexlib""#), "{page}");
    assert!(page.contains(r#""leftOut":[{"name":"gone","reasons":["it is clipped"]}]"#), "{page}");
    assert_eq!(page.matches("</script>").count(), 2);
    // As base64.
    assert!(page.contains("<script id=\"textures\">iUhUTA0KGgoB"), "{page}");
    let copied = std::fs::read(place.path("site/odd #1.htexlib")).unwrap();
    assert!(copied == std::fs::read(place.path("odd #1.htexlib")).unwrap());

    // A name that is a place of the page stays a name.
    let pack = ["lib", "pack", "place.htexlib", "textures", "--name", "__TEXTURES__"];
    assert_eq!(place.run(&pack).code(), 0);
    let fill = ["lib", "catalogue", "place.htexlib", "--folder", "page", "-o", "placed"];
    assert_eq!(place.run(&fill).code(), 0);
    let page = std::fs::read_to_string(place.path("placed/index.html")).unwrap();
    assert!(page.contains("<title>__TEXTURES__</title>"), "{page}");
    assert!(page.contains("<script id=\"textures\">iUhUTA0KGgoB"), "{page}");

    let url = ["--url", "https://textures.example:8443/a/b.htexlib?v=1"];
    assert_eq!(catalogue(&[&["-o", "remote"], &url[..]].concat()).code(), 0);
    let page = std::fs::read_to_string(place.path("remote/index.html")).unwrap();
    assert!(page.contains("connect-src 'self' https://textures.example:8443;"), "{page}");
    assert!(page.contains("<script id=\"textures\"></script>"), "{page}");
    assert!(!place.path("remote/odd #1.htexlib").exists());
    for url in ["ftp://a/b.htexlib", "https://a'; x/b", "b.htexlib"] {
        assert_eq!(catalogue(&["-o", "remote", "--url", url]).code(), 2, "{url}");
    }
}

#[test]
fn several_textures_are_exported_to_a_folder() {
    let place = place();
    let export = |asset: &str, output: &str| {
        place.run(&["export", asset, "--to", "haptic", "-o", output, "--json"])
    };
    let several: Value =
        serde_json::from_str(&export("all.htexlib#cotton*", "out").text()).unwrap();
    assert_eq!(several.as_array().unwrap().len(), 2, "{several}");
    assert_eq!(export("all.htexlib#cotton", "one.haptic").code(), 0);
    let bytes = |file: &str| std::fs::read(place.path(file)).unwrap();
    assert!(bytes("out/cotton.haptic") == bytes("one.haptic"));
    assert!(place.path("out/cotton again.haptic").exists());
    assert_eq!(export("all.htexlib#none*", "none").code(), 1);
}
