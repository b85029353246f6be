//! Short studies and studies on the simulated card, and what their folders hold.
#![allow(dead_code, reason = "each suite uses its part")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::Place;
use crate::simulated;

pub const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes");
pub const PAPER: &str = "pcie-6321_tabor-9200a_sct3250";

/// A run of simulated participants on the simulated card, whose input feels its output.
pub fn on_card(place: &Place, folder: &str, more: &[&str]) -> Command {
    static RUNS: AtomicUsize = AtomicUsize::new(0);
    let wire = place.path(&format!("wire-{}", RUNS.fetch_add(1, Ordering::Relaxed)));
    fs::create_dir(&wire).unwrap();
    let driver = format!("driver={}", simulated::built().display());
    let run = ["study", "run", "study.toml", "--simulated", "11", "--fast", "-o", folder];
    let card = ["--profile", PAPER, "--set", &driver];
    let felt = ["--source", "daq:Dev1/ai0", "--source-set", &driver, "--map", "lateral=ai0:0.1"];
    let mut command = place.command(&[&run, &card[..], &felt, more].concat());
    command
        .env("NIDAQMX_SIM_CLOCK", "calls")
        .env("NIDAQMX_SIM_LOOPBACK", wire)
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    command
}

/// The answers of a folder by file name.
pub fn answers(folder: &Path) -> BTreeMap<String, String> {
    let files = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .map(Result::unwrap)
        .filter(|file| file.file_name().to_string_lossy().ends_with(".jsonl"));
    let read = |file: fs::DirEntry| {
        let name = file.file_name().to_string_lossy().into_owned();
        (name, fs::read_to_string(file.path()).unwrap())
    };
    files.map(read).collect()
}

/// The answers of a folder as if nothing had been stopped: without the lines of stops, and without
/// their number in other lines.
pub fn unstopped(folder: &Path) -> BTreeMap<String, String> {
    let unstopped = |text: String| {
        let lines = text.lines().filter(|line| !line.starts_with("{\"kind\":\"stopped\""));
        let number = |line: &str| {
            (1..9).fold(line.to_owned(), |line, stops| {
                line.replace(&format!("\"stops\":{stops}"), "\"stops\":0")
            })
        };
        lines.map(|line| number(line) + "\n").collect::<String>()
    };
    let all = answers(folder).into_iter();
    all.map(|(name, text)| (name, unstopped(text))).collect()
}

/// The recordings of a participant and what is beside them, by file name.
pub fn felt(folder: &Path, participant: &str) -> BTreeMap<String, Vec<u8>> {
    let files = fs::read_dir(folder.join(participant).join("felt")).unwrap();
    let read = |file: std::io::Result<fs::DirEntry>| {
        let file = file.unwrap();
        let name = file.file_name().to_string_lossy().into_owned();
        (name, fs::read(file.path()).unwrap())
    };
    files.map(read).collect()
}

pub fn lines(folder: &Path) -> usize {
    answers(folder).values().map(|text| text.lines().count()).sum()
}

/// The arguments of an export with the spectra of the demonstration's recordings.
pub fn exported<'a>(folder: &'a str, spectra: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let recorded = [
        "coarse-fabric=coarse-fabric.csv",
        "corrugated-paper=corrugated-paper.csv",
        "fine-fabric=fine-fabric.csv",
        "sandpaper=sandpaper.csv",
        "vinyl=vinyl.csv",
    ];
    let mut run = vec!["study", "export", folder, "--spectra", spectra, "--frf", "rig.csv"];
    for text in recorded {
        run.extend(["--recorded", text]);
    }
    run.extend(more);
    run
}

/// A line of the table of spectra: participant, texture, model, and the magnitudes.
pub fn row(line: &str) -> (Vec<&str>, Vec<f64>) {
    let names: Vec<&str> = line.split(',').take(3).collect();
    let magnitudes = line.split(',').skip(3).map(|field| field.parse().unwrap());
    (names, magnitudes.collect())
}

pub const SHORT: &str = "
htex_study = '1.0'
participants = ['Ann', 'Bob']
models = ['ar', 'sbeta']
repetitions = 1
trial_s = 0.05
phases = ['gain', 'testing']
gain = { method = 'adjustment' }
motion = { constant = { speed_mm_s = 80, force_n = 0.4 } }
device = { adapter = 'file' }
[[textures]]
asset = 'vinyl.htex'
";

/// Texts, and what replaces them.
pub type Edits<'a> = &'a [(&'a str, &'a str)];

/// Two attributes that are rated, before the textures.
pub const RATED: &str = "[[attributes]]
name = 'similarity'
question = 'How similar is it?'
[[attributes]]
name = 'roughness'
question = 'How rough is it?'
[[textures]]";

/// A study of one texture; `more` replaces texts of it.
pub fn short(more: Edits<'_>) -> Place {
    let place = Place::new();
    write(&place, more);
    place
}

pub fn write(place: &Place, more: Edits<'_>) {
    place.write("vinyl.htex", fs::read(format!("{EXAMPLES}/vinyl.htex")).unwrap());
    let replaced = |text: String, (from, to): &(&str, &str)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    };
    place.write("study.toml", more.iter().fold(SHORT.to_owned(), replaced));
}
