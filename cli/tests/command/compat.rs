//! `tests/compat`: files that each version wrote are read and play the same samples.
//!
//! A folder of a version is made once, by that version (`HTEX_GENERATE=1`), and never changed.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use htex_player::{Block, Player};

use crate::common::Place;

/// What makes the files of a version.
const MAKE: &str = include_str!("../../../tests/compat/make.txt");

/// What plays them into a file named `out.wav`.
const PLAY: &str = include_str!("../../../tests/compat/play.txt");

/// The command lines of a version with the hashes of what they wrote.
const PLAYED: &str = "played.txt";

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/compat")
}

fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter(|line| !line.is_empty() && !line.starts_with('#'))
}

/// A place with copies of a folder's files.
fn copy_of(folder: &Path) -> Place {
    let place = Place::new();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        place.write(&entry.file_name().to_string_lossy(), fs::read(entry.path()).unwrap());
    }
    place
}

fn run(place: &Place, line: &str) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let run = place.run(&words);
    assert_eq!(run.code(), 0, "htex {line}: {}", run.error());
}

/// A WAV file without the list of its licence and author, which is its last chunk.
fn without_rights(mut wav: Vec<u8>) -> Vec<u8> {
    if let Some(at) = wav.windows(4).rposition(|name| name == b"LIST") {
        let length = u32::from_le_bytes(wav[at + 4..at + 8].try_into().unwrap());
        assert_eq!(at + 8 + length as usize, wav.len());
        wav.truncate(at);
        let size = u32::try_from(wav.len() - 8).unwrap();
        wav[4..8].copy_from_slice(&size.to_le_bytes());
    }
    wav
}

/// The hash of what a line plays. `player FILE` plays a baked block.
fn played(place: &Place, line: &str) -> String {
    let bytes = match line.strip_prefix("player ") {
        Some(block) => of_block(&fs::read(place.path(block)).unwrap()),
        None => {
            // An asset is written to a file of its own extension.
            let out = if line.starts_with("lib cat") { "out.htex" } else { "out.wav" };
            run(place, &line.replace("out.wav", out));
            let bytes = fs::read(place.path(out)).unwrap();
            fs::remove_file(place.path(out)).unwrap();
            without_rights(bytes)
        }
    };
    blake3::hash(&bytes).to_hex()[..32].to_owned()
}

/// Two seconds of a block, at two motions.
fn of_block(bytes: &[u8]) -> Vec<u8> {
    let mut player = Player::new(Block::open(bytes).unwrap(), 7);
    let mut samples = vec![0.0; 16_000];
    for (half, speed) in samples.chunks_mut(8000).zip([60.0, 120.0]) {
        player.set_motion(speed, 0.4);
        player.render(half);
    }
    samples.iter().flat_map(|x: &f32| x.to_le_bytes()).collect()
}

#[test]
fn generated_files_of_this_version_are_there() {
    let version = folder().join(env!("CARGO_PKG_VERSION"));
    let is_asked = std::env::var_os("HTEX_GENERATE").is_some_and(|v| v == "1");
    if !is_asked || version.exists() {
        return;
    }
    let place = copy_of(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/scenes"));
    let module = place.path("bursts.wasm");
    xtask::c_module::build("examples/model-c-bursts/bursts.c", &module).unwrap();
    lines(MAKE).for_each(|line| run(&place, line));
    let mut hashes = String::new();
    for line in lines(PLAY) {
        writeln!(hashes, "{} {line}", played(&place, line)).unwrap();
    }
    fs::create_dir_all(&version).unwrap();
    for entry in fs::read_dir(place.path("")).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().to_string_lossy().into_owned();
        // Not the recordings that it was made of, which are large.
        let is_recording = name.ends_with(".csv") && MAKE.contains(&format!("-o {name}\n"));
        if !is_recording && name != "README.md" {
            fs::write(version.join(name), fs::read(entry.path()).unwrap()).unwrap();
        }
    }
    fs::write(version.join(PLAYED), hashes).unwrap();
}

#[test]
fn files_of_every_version_play_the_same() {
    let mut versions = 0;
    for entry in fs::read_dir(folder()).unwrap() {
        let version = entry.unwrap().path();
        if !version.is_dir() {
            continue;
        }
        let (place, name) = (copy_of(&version), version.file_name().unwrap());
        let kept = fs::read_to_string(version.join(PLAYED)).unwrap();
        for line in lines(&kept) {
            let (hash, line) = line.split_once(' ').unwrap();
            assert_eq!(played(&place, line), hash, "{name:?}: {line}");
        }
        versions += 1;
    }
    assert!(versions > 0);
}
