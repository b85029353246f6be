//! Scenes played by `htex` on the simulated card, and the card's output.
#![allow(dead_code)] // Each suite uses a part of it.

use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::common::{Place, until};
use crate::simulated;

pub const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes");
pub const PAPER: &str = "pcie-6321_tabor-9200a_sct3250";
/// Gain of the paper's amplifier.
pub const GAIN: f64 = 50.0;
pub const RATE_HZ: f64 = 20_000.0;
pub const SCENE: &str = "s.scene.json";
pub const RECORD: &str = "Dev1_ao0.txt";

/// A folder with a card, a scene for it, and the card's recorded output.
pub struct Bench(pub Place);

impl Bench {
    /// With a scene of one surface on the paper's rig, with `more` over it.
    pub fn new(more: Value) -> Self {
        let place = Place::new();
        for name in ["coarse-fabric.htex", "vinyl.htex", "hand.csv"] {
            place.write(name, std::fs::read(format!("{EXAMPLES}/{name}")).unwrap());
        }
        let mut all = json!({ "device": { "adapter": "daq", "profile": PAPER }, "seed": 1 });
        all.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        place.scene(SCENE, "coarse-fabric.htex", &all);
        Self(place)
    }

    /// A command with the simulated driver, whose clock advances by calls, so that tests do not
    /// depend on time.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let driver = format!("driver={}", simulated::built().display());
        let mut command =
            self.0.command(&[arguments, &[SCENE, "--profile", PAPER, "--set", &driver]].concat());
        command
            .env("NIDAQMX_SIM_RECORD", self.0.path(""))
            .env("NIDAQMX_SIM_CLOCK", "calls")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    /// Plays without end in real time, and waits until there is output.
    pub fn start(&self) -> Child {
        self.started(&mut self.command(&["play"]))
    }

    /// As [`Self::start`], by a command.
    pub fn started(&self, command: &mut Command) -> Child {
        let child = command.env("NIDAQMX_SIM_CLOCK", "wall").spawn().unwrap();
        until("something comes out", || self.card_v().iter().any(|v| *v != 0.0));
        child
    }

    /// Plays and expects a failure whose one sentence contains this text.
    pub fn fails(&self, command: &mut Command, words: &[&str]) {
        check_failed(&command.output().unwrap(), words);
    }

    /// Volts of the card that came out so far; empty when it was never used. A line that is
    /// being written is left out.
    pub fn card_v(&self) -> Vec<f64> {
        card_v(&self.0)
    }

    /// Waits until the output is zero and stays so, however busy the machine is.
    pub fn comes_to_zero(&self) {
        let (start, mut length) = (Instant::now(), 0);
        while start.elapsed() < Duration::from_secs(30) {
            let card_v = self.card_v();
            if card_v.last() == Some(&0.0) && card_v.len() == length {
                break;
            }
            length = card_v.len();
            std::thread::sleep(Duration::from_millis(500));
        }
        self.is_at_zero();
    }

    /// There was output, and its last value is zero.
    pub fn is_at_zero(&self) {
        let card_v = self.card_v();
        assert!(card_v.iter().any(|v| *v != 0.0), "it was never felt");
        assert_eq!(card_v.last(), Some(&0.0));
    }
}

/// As [`Bench::card_v`], of a folder.
pub fn card_v(place: &Place) -> Vec<f64> {
    let text = std::fs::read_to_string(place.path(RECORD)).unwrap_or_default();
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    whole.lines().map(|line| line.parse().unwrap()).collect()
}

/// Exit status 1, and one sentence with these words.
pub fn check_failed(done: &Output, words: &[&str]) {
    let error = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(1), "{error}");
    let mut sentences: Vec<&str> = error.lines().filter(|l| l.starts_with("htex: ")).collect();
    // The process that holds the output warns at once of a remaining voltage; the player repeats
    // it.
    sentences.dedup();
    assert_eq!(sentences.len(), 1, "{error}");
    for word in words {
        assert!(error.contains(word), "{word}: {error}");
    }
}
