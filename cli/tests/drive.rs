//! Scenes played on a card, the simulated one: the voltage that comes out, and that it is zero after
//! all that can go wrong.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;
#[path = "../../renderer-adapters/daq/tests/simulated/library.rs"]
mod simulated;

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use common::Place;
use serde_json::{Value, json};

const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes");
const PAPER: &str = "pcie-6321_tabor-9200a_sct3250";
/// Of the paper's amplifier.
const GAIN: f64 = 50.0;
const RATE_HZ: f64 = 20_000.0;
const SCENE: &str = "s.scene.json";
const RECORD: &str = "Dev1_ao0.txt";

/// A folder with a card, a scene for it, and what came out of it.
struct Bench(Place);

impl Bench {
    /// With a scene of one surface on the paper's rig, with `more` over it.
    fn new(more: Value) -> Self {
        let place = Place::new();
        for name in ["coarse-fabric.htex", "vinyl.htex", "hand.csv"] {
            place.write(name, std::fs::read(format!("{EXAMPLES}/{name}")).unwrap());
        }
        let mut scene = json!({
            "htex_scene": "1.0",
            "surfaces": [{ "asset": "coarse-fabric.htex" }],
            "motion": { "constant": { "speed_mm_s": 80, "force_n": 0.4 } },
            "device": { "adapter": "daq", "profile": PAPER },
            "seed": 1,
        });
        for (key, value) in more.as_object().unwrap() {
            scene[key] = value.clone();
        }
        place.write(SCENE, scene.to_string());
        Self(place)
    }

    /// A command with the simulated driver; its clock goes by calls, so that no test hangs on time.
    fn command(&self, arguments: &[&str]) -> Command {
        let driver = format!("driver={}", simulated::built().display());
        let mut command = self
            .0
            .command(&[arguments, &[SCENE, "--set", &driver]].concat());
        command
            .env("NIDAQMX_SIM_RECORD", self.0.path(""))
            .env("NIDAQMX_SIM_CLOCK", "calls")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    /// Plays without end by the clock on the wall, and waits until it can be felt.
    fn start(&self) -> Child {
        let mut command = self.command(&["play"]);
        let child = command.env("NIDAQMX_SIM_CLOCK", "wall").spawn().unwrap();
        let start = Instant::now();
        while self.card_v().iter().all(|v| *v == 0.0) {
            assert!(
                start.elapsed() < Duration::from_secs(60),
                "nothing comes out"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
        child
    }

    /// Plays and expects that it fails, with this in its one sentence.
    fn fails(&self, command: &mut Command, words: &[&str]) {
        check_failed(&command.output().unwrap(), words);
    }

    /// Volts of the card that came out so far; nothing when it was never touched. A line that is
    /// being written is not there yet.
    fn card_v(&self) -> Vec<f64> {
        let text = std::fs::read_to_string(self.0.path(RECORD)).unwrap_or_default();
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        whole.lines().map(|line| line.parse().unwrap()).collect()
    }

    /// Something came out, and zero is the last of it.
    fn is_at_zero(&self) {
        let card_v = self.card_v();
        assert!(card_v.iter().any(|v| *v != 0.0), "it was never felt");
        assert_eq!(card_v.last(), Some(&0.0));
    }
}

/// Exit status 1, and one sentence with these words.
fn check_failed(done: &Output, words: &[&str]) {
    let error = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(1), "{error}");
    let sentences: Vec<&str> = error.lines().filter(|l| l.starts_with("htex: ")).collect();
    assert_eq!(sentences.len(), 1, "{error}");
    for word in words {
        assert!(error.contains(word), "{word}: {error}");
    }
}

fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    let sent = Command::new("kill").args([name, &id]).status();
    assert!(sent.unwrap().success());
}

/// Volts at the display, as a file has them.
fn samples(file: &Path) -> Vec<f32> {
    let mut wav = hound::WavReader::open(file).unwrap();
    assert_eq!(f64::from(wav.spec().sample_rate), RATE_HZ);
    wav.samples::<f32>().map(Result::unwrap).collect()
}

#[test]
fn the_card_puts_out_what_the_file_holds() {
    let mut swatches: Value = {
        let text = std::fs::read_to_string(format!("{EXAMPLES}/two-swatches.scene.json"));
        serde_json::from_str(&text.unwrap()).unwrap()
    };
    swatches["device"] = json!({ "adapter": "daq", "profile": PAPER, "drive_v": 150 });
    let steady = json!({ "duration_s": 3 });
    for scene in [steady, swatches] {
        let bench = Bench::new(scene);
        let file = bench.command(&["render", "-o", "drive.wav"]).output();
        let card = bench.command(&["play"]).output();
        for done in [file.unwrap(), card.unwrap()] {
            let error = String::from_utf8_lossy(&done.stderr);
            assert!(done.status.success(), "{error}");
        }
        let file_v = samples(&bench.0.path("drive.wav"));
        let peak_v = file_v.iter().fold(0.0f32, |peak, v| peak.max(v.abs()));
        assert!(peak_v > 60.0, "{peak_v} V");
        // One zero when it is opened, and half a buffer (200 ms) that leads to the first sample.
        let card_v = bench.card_v();
        let (before, rest) = card_v.split_at(1 + 2_000);
        let (played, after) = rest.split_at(file_v.len());
        let same = |(card, file): (&f64, &f32)| (card * GAIN) as f32 == *file;
        let differ = played.iter().zip(&file_v).filter(|pair| !same(*pair));
        println!("{} samples, peak {peak_v} V", file_v.len());
        assert_eq!(differ.count(), 0);
        assert!(before.is_sorted_by(|a, b| a.abs() <= b.abs()) && before[0] == 0.0);
        assert!(before[2_000].abs() <= played[0].abs(), "{before:?}");
        assert!(!after.is_empty() && after.iter().all(|v| *v == 0.0));
    }
}

#[test]
fn what_cannot_be_played_never_touches_the_card() {
    let device = |more: (&str, f64)| {
        let mut device = json!({ "adapter": "daq", "profile": PAPER });
        device[more.0] = more.1.into();
        Bench::new(json!({ "device": device, "duration_s": 1 }))
    };
    let fast = device(("rate_hz", 1e6));
    fast.fails(&mut fast.command(&["play"]), &["DEVICE_RATE", "900000 Hz"]);
    let high = device(("drive_v", 151.0));
    let words = ["DEVICE_DRIVE_TOO_HIGH", "151 V", "150 V"];
    high.fails(&mut high.command(&["play"]), &words);
    // Nor does a scene without what makes its newtons volts.
    let raw = Bench::new(json!({ "duration_s": 1, "effects": { "square_root": "off" } }));
    raw.fails(&mut raw.command(&["play"]), &["`square_root` is off"]);
    let none = Bench::new(json!({ "duration_s": 1 }));
    let mut play = none
        .0
        .command(&["play", SCENE, "--set", "driver=/no/such.so"]);
    none.fails(&mut play, &["`driver`", "/no/such.so is no NI-DAQmx"]);
    for bench in [fast, high, raw, none] {
        assert!(!bench.0.path(RECORD).exists());
    }
}

#[test]
fn a_voltage_over_the_limit_is_stopped_by_the_device() {
    // Nothing but the device is left to hold it: noise goes beyond 4.5 times its RMS at last, with this
    // seed within two seconds.
    let bench = Bench::new(json!({
        "surfaces": [{ "asset": "coarse-fabric.htex", "representation": "ar" }],
        "device": { "adapter": "daq", "profile": PAPER, "drive_v": 150 },
        "effects": { "limiter": "off", "quantisation": "off" },
        "seed": 74,
        "duration_s": 10,
    }));
    let words = ["the limit is 150 V; the output is at zero"];
    bench.fails(&mut bench.command(&["play"]), &words);
    bench.is_at_zero();
    let most = bench
        .card_v()
        .iter()
        .fold(0.0, |most: f64, v| most.max(v.abs()));
    assert!(most > 2.0 && most <= 150.0 / GAIN, "{most} V of the card");
}

#[test]
fn a_card_pulled_out_is_told() {
    let bench = Bench::new(json!({ "duration_s": 5 }));
    let mut play = bench.command(&["play"]);
    let words = [
        "-88705",
        "could not be set to zero: switch the amplifier off",
    ];
    bench.fails(play.env("NIDAQMX_SIM_UNPLUG_AFTER", "9000"), &words);
    assert_eq!(bench.card_v().len(), 9_000, "nothing more comes out");
}

#[cfg(unix)]
#[test]
fn a_program_that_stands_still_ends_at_zero() {
    let bench = Bench::new(json!({}));
    let child = bench.start();
    signal(&child, "-STOP");
    // Longer than the buffer lasts.
    std::thread::sleep(Duration::from_millis(400));
    signal(&child, "-CONT");
    let done = child.wait_with_output().unwrap();
    check_failed(&done, &["ran dry", "buffer_ms"]);
    bench.is_at_zero();
}

#[cfg(unix)]
#[test]
fn an_interrupted_play_goes_down_to_zero() {
    let bench = Bench::new(json!({}));
    let child = bench.start();
    signal(&child, "-INT");
    let done = child.wait_with_output().unwrap();
    let error = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{error}");
    bench.is_at_zero();
    // The scene's own ramp of 20 ms: each quarter below the one before.
    let card_v = bench.card_v();
    let felt = card_v.iter().rposition(|v| *v != 0.0).unwrap() + 1;
    let peak = |v: &[f64]| v.iter().fold(0.0, |peak: f64, v| peak.max(v.abs()));
    let before = peak(&card_v[..felt]);
    let ramp: Vec<f64> = card_v[felt - 400..felt].chunks(100).map(peak).collect();
    println!("{before} V, then {ramp:?}");
    assert!(ramp.is_sorted_by(|a, b| a > b), "{ramp:?}");
    assert!(ramp[3] < 0.3 * before, "{before} V, then {ramp:?}");
}

#[test]
fn the_adapter_keeps_what_devices_promise() {
    let place = Place::new();
    let driver = format!("driver={}", simulated::built().display());
    let check = ["device", "check", "daq", "--profile", PAPER, "--json"];
    let mut check = place.command(&[&check[..], &["--set", &driver]].concat());
    let done = check.env("NIDAQMX_SIM_CLOCK", "calls").output().unwrap();
    let report: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert!(done.status.success(), "{report:#}");
    let all = report["checks"].as_array().unwrap().iter();
    let passed = all.filter(|check| check["outcome"] == "passed").count();
    // Built in there is no library (5), and the installed driver, which lists outputs, may be absent.
    assert!(passed >= htex_device_check::CHECKS.len() - 6, "{report:#}");
}
