//! `--only-signed-by`: the command plays, renders and converts what the key signed, and nothing else.

use std::process::Stdio;

use serde_json::json;

use crate::common::{Files, Run, words};
use crate::storage::Bench;

/// Commands that play, render or convert a texture, each from another kind of input in the folder
/// `IN`.
const COMMANDS: [&str; 13] = [
    "synth IN/vinyl.htex --seconds 0.1 -o out.wav",
    "synth IN/all.htexlib#vinyl --seconds 0.1 -o out.wav",
    "synth s3://IN/vinyl.htex --seconds 0.1 -o out.wav",
    "synth s3://IN/all.htexlib#vinyl --seconds 0.1 -o out.wav",
    "play IN/vinyl.htex --device file --set path=out.wav --seconds 0.1",
    "render IN/file.scene.json -o out.wav",
    "render IN/library.scene.json -o out.wav",
    "export IN/library.scene.json --to wav -o out.wav",
    "export IN/all.htexlib#* --to wav --seconds 0.5 -o out/",
    "lib export IN/all.htexlib --to wav --seconds 0.5 -o out",
    "bake IN/vinyl.htex -o out.h",
    "mix IN/vinyl.htex IN/all.htexlib#vinyl --weight 0.5 -o out.htex",
    "compare IN/vinyl.htex s3://IN/vinyl.htex --json",
];

/// Runs a command on the files of a folder, with the keys of this bench.
fn run(bench: &Bench, command: &str, folder: &str, more: &str) -> Run {
    let line = format!("{} {more}", command.replace("IN", folder));
    let mut command = bench.command(&words(&line));
    command.env("HTEX_CONFIG_DIR", bench.place.path("settings"));
    Run::of(command.stdin(Stdio::null()).output().unwrap())
}

fn does(bench: &Bench, command: &str) -> String {
    let done = run(bench, command, "", "");
    assert_eq!(done.code(), 0, "{command}: {}", done.error());
    done.text()
}

/// What a command prints and writes. Removes what it wrote.
fn made(bench: &Bench, done: &Run) -> (String, Files) {
    let mut files = bench.place.files();
    files.retain(|path, _| path.to_string_lossy().starts_with("out"));
    for name in ["out", "out.wav", "out.h", "out.htex"] {
        let path = bench.place.path(name);
        let _ = std::fs::remove_file(&path).or_else(|_| std::fs::remove_dir_all(path));
    }
    (done.text(), files)
}

/// Refused with one sentence, and nothing is written.
fn refused(bench: &Bench, command: &str, folder: &str, key: &str, code: i32, words: &[&str]) {
    let done = run(bench, command, folder, &format!("--only-signed-by {key}"));
    done.failed(code, words);
    // A damaged file is a finding of its scene, on a line of its own.
    let lines = done.error().lines().count();
    assert!(lines == 1 || done.error().contains("ASSET_INVALID"), "{command}: {}", done.error());
    let (printed, files) = made(bench, &done);
    assert!(printed.is_empty() && files.is_empty(), "{command}: {:?}", files.keys());
}

/// Puts files into a folder here, and into the same folder elsewhere.
fn publish(bench: &Bench, folder: &str, files: &[(&str, Vec<u8>)]) {
    std::fs::create_dir(bench.place.path(folder)).unwrap();
    for (name, bytes) in files {
        let name = format!("{folder}/{name}");
        bench.place.write(&name, bytes);
        bench.server.put(&name, bytes);
    }
    let short = json!({ "duration_s": 0.5 });
    for (scene, asset) in [("file", "vinyl.htex"), ("library", "all.htexlib#vinyl")] {
        bench.place.scene(&format!("{folder}/{scene}.scene.json"), asset, &short);
    }
}

/// CRC-32 of the header of a library.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc: u32, _| {
            crc >> 1 ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 }
        })
    })
}

#[test]
fn only_what_the_key_signed_is_played() {
    let bench = Bench::empty();
    let place = &bench.place;
    let examples = |name: &str| {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes");
        std::fs::read(format!("{folder}/{name}")).unwrap()
    };
    let (vinyl, other) = (examples("vinyl.htex"), examples("coarse-fabric.htex"));
    let read = |name: &str| std::fs::read(place.path(name)).unwrap();
    place.write("vinyl.htex", &vinyl);
    for key in ["alice", "mallory"] {
        does(&bench, &format!("key new {key}"));
    }
    does(&bench, "lib pack all.htexlib vinyl.htex");
    does(&bench, "sign vinyl.htex all.htexlib --key alice");
    let library = read("all.htexlib");
    let signatures = || {
        [("vinyl.htex.sig", read("vinyl.htex.sig")), ("all.htexlib.sig", read("all.htexlib.sig"))]
    };
    let files = |vinyl: &[u8], library: &[u8]| {
        [("vinyl.htex", vinyl.to_vec()), ("all.htexlib", library.to_vec())]
    };
    let signed = |vinyl: &[u8], library: &[u8]| {
        files(vinyl, library).into_iter().chain(signatures()).collect::<Vec<_>>()
    };
    publish(&bench, "signed", &signed(&vinyl, &library));
    publish(&bench, "unsigned", &files(&vinyl, &library));
    let mut damaged = library.clone();
    damaged[library.len() - 1] ^= 1;
    publish(&bench, "damaged", &signed(&other, &damaged));
    // Another library that states the hash of the signed index.
    place.write("vinyl.htex", &other);
    does(&bench, "lib pack forged.htexlib vinyl.htex");
    let mut forged = read("forged.htexlib");
    forged[92..124].copy_from_slice(&library[92..124]);
    let crc = crc32(&forged[..124]);
    forged[124..128].copy_from_slice(&crc.to_le_bytes());
    publish(&bench, "forged", &signed(&other, &forged));
    let wrong = [("vinyl.htex.sig", b"{".to_vec()), ("all.htexlib.sig", vec![b' '; 5000])];
    publish(
        &bench,
        "malformed",
        &files(&vinyl, &library).into_iter().chain(wrong).collect::<Vec<_>>(),
    );

    for command in COMMANDS {
        let plain = run(&bench, command, "signed", "");
        assert_eq!(plain.code(), 0, "{command}: {}", plain.error());
        let plain = made(&bench, &plain);
        let with_key = run(&bench, command, "signed", "--only-signed-by alice");
        assert!(made(&bench, &with_key) == plain, "{command}: {}", with_key.error());
        refused(&bench, command, "signed", "mallory", 1, &["signed by another key"]);
        for folder in ["unsigned", "damaged", "forged", "malformed"] {
            refused(&bench, command, folder, "alice", 1, &[folder]);
        }
    }
    for file in ["forged/all.htexlib", "forged/all.htexlib#vinyl", "damaged/vinyl.htex"] {
        let verified = run(&bench, &format!("verify {file} --signed-by alice"), "", "");
        assert_eq!(verified.code(), 1, "{file}: {}", verified.text());
    }
    let digits = does(&bench, "key show alice");
    refused(&bench, "synth - -o out.wav", "", "alice", 1, &["standard input"]);
    refused(&bench, COMMANDS[0], "signed", "nobody", 2, &["no key that you trust"]);
    does(&bench, "key revoke alice");
    for key in ["alice", digits.trim()] {
        for command in COMMANDS {
            refused(&bench, command, "signed", key, 2, &["you revoked the key"]);
        }
    }
}
