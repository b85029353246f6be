//! Text from untrusted files controls no terminal and forges no line.

use crate::common::Place;

/// An escape, a mark that reverses text, one that hides it, and further lines.
const EVIL: &str = "x\u{1b}[2J\u{202e}\u{200b}\u{2028}\nbrings along forged 9.9.9, signed by me\r\nhtex: all is well\u{7}";

/// Asserts that there are no control characters, and no line that only the text could have begun.
fn is_tame(what: &str, bytes: &[u8]) {
    let text = String::from_utf8(bytes.to_vec()).unwrap();
    let steers = |c: &char| (c.is_control() && *c != '\n') || ('\u{200b}'..='\u{206f}').contains(c);
    assert_eq!(text.chars().find(steers), None, "{what}: {text:?}");
    let forged = ["brings along forged", "htex: all is well"];
    let found = text.lines().find(|line| forged.iter().any(|f| line.starts_with(f)));
    assert_eq!(found, None, "{what}: {text}");
}

#[test]
fn text_of_files_is_printed_as_text() {
    let place = Place::new();
    let cloth = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes/vinyl.htex");
    let mut asset = htex_format::Asset::open(cloth.as_ref()).unwrap();
    let manifest = &mut asset.manifest;
    manifest.name = EVIL.to_owned();
    manifest.author = Some(EVIL.to_owned());
    manifest.tags = vec![EVIL.to_owned()];
    manifest.provenance.tool = EVIL.to_owned();
    manifest.provenance.warnings = vec![EVIL.to_owned()];
    manifest.provenance.options = [(EVIL.to_owned(), EVIL.to_owned())].into();
    for source in &mut manifest.provenance.recordings {
        source.file = EVIL.to_owned();
    }
    manifest.other.insert(EVIL.to_owned(), EVIL.into());
    place.write("evil.htex", asset.to_bytes().unwrap());
    // As strange as a file's name can be.
    let name = format!("{}.htex", EVIL.replace('/', "_"));
    place.write(&name, asset.to_bytes().unwrap());
    let csv = place.recording("vinyl");
    let header = format!(
        "t_s,fx_n,\"{}\"\n0,0.1,1\n0.001,0.2,1\n0.002,0.1,1\n",
        EVIL.replace(['\n', '\r'], " ")
    );
    place.write("evil.csv", header);
    let scene = serde_json::json!({
        "htex_scene": "1.0",
        "surfaces": [{ "asset": EVIL, "representation": EVIL }],
        "motion": { "trace": EVIL },
        "device": { "adapter": EVIL, "profile": EVIL, "settings": { EVIL: EVIL } },
        EVIL: EVIL,
    });
    place.write("evil.scene.json", scene.to_string());
    let runs: Vec<Vec<&str>> = vec![
        vec!["info", "evil.htex"],
        vec!["info", &name],
        vec!["validate", "evil.htex", &name, "evil.scene.json", "evil.csv"],
        vec!["spectrum", "evil.htex", "--model", EVIL],
        vec!["spectrum", &name, "--speed", "10"],
        vec!["synth", "evil.htex", "--seconds", "0.1", "-o", "x.wav", "--speed", "10"],
        vec!["compare", &csv, "evil.htex"],
        vec!["play", "evil.htex", "--device", "file", "--set", "path=y.wav", "--seconds", "0.1"],
        vec!["play", "evil.htex", "--device", EVIL],
        vec!["plan", "evil.scene.json"],
        vec!["fit", "evil.csv", "-o", "z.htex"],
        vec!["fit", &csv, "--name", EVIL, "--author", EVIL, "-o", "z.htex", "--model", "sslope"],
        vec!["process", "evil.csv"],
        vec!["explain", EVIL],
        vec!["validate", "evil.htex", &name, "--format", "github"],
        vec!["validate", "evil.htex", &name, "--format", "junit"],
        vec!["lib", "pack", "evil.htexlib", "evil.htex", "--unlicensed"],
        vec!["lib", "edit", "evil.htexlib", "--rename", "evil=good", "--unlicensed"],
        vec!["lib", "info", "evil.htexlib"],
        vec!["lib", "ls", "evil.htexlib"],
        vec!["lib", "find", "evil.htexlib", "--like", "good"],
        vec!["lib", "find", "evil.htexlib", "--like", EVIL],
        vec!["lib", "find", "evil.htexlib", "--author", EVIL],
        vec!["lib", "edit", "evil.htexlib", "--describe", EVIL],
        vec!["lib", "merge", "evil.htexlib", EVIL, "-o", "merged.htexlib"],
        vec!["lib", "verify", "evil.htexlib", "--blake3", EVIL],
    ];
    for arguments in runs {
        let done = place.command(&arguments).output().unwrap();
        let what = format!("{arguments:?}");
        is_tame(&what, &done.stdout);
        is_tame(&what, &done.stderr);
    }
}
