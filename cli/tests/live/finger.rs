//! Attacks on a finger by scenes and studies of strangers, on the simulated card: direct voltage, a
//! carrier that is taken away, a zero that is late.

#[path = "finger/random.rs"]
mod random;
#[path = "finger/volts.rs"]
mod volts;

use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use crate::bench::{Bench, PAPER, RATE_HZ, RECORD, SCENE};
use crate::common::{Place, signal};
use serde_json::{Value, json};
use volts::{Volts, volts};

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A scene of a second on the paper's rig, with more keys of the device.
fn scene(device: Value) -> Bench {
    let mut all = json!({ "adapter": "daq", "drive_v": 150 });
    for (key, value) in device.as_object().unwrap() {
        all[key] = value.clone();
    }
    Bench::new(json!({ "device": all, "duration_s": 1 }))
}

#[test]
fn a_rate_that_takes_the_carrier_away_is_refused() {
    let bench = scene(json!({ "rate_hz": 7_001 }));
    let words = ["DEVICE_RATE", "2.5 times", "7000 Hz"];
    bench.fails(&mut bench.command(&["play"]), &words);
    assert!(!bench.0.path(RECORD).exists());
}

/// A file's settings of carrier and direct voltage are not used, whatever they say.
#[test]
fn a_setting_takes_no_carrier_away() {
    for (name, value) in
        [("carrier_hz", json!(0)), ("carrier_hz", json!(20)), ("dc_limit_v", json!(150))]
    {
        let bench = scene(json!({ "settings": { name: value } }));
        let done = bench.command(&["play"]).output().unwrap();
        let error = text(&done);
        assert!(done.status.success(), "{error}");
        assert!(error.contains("DEVICE_HARDWARE"), "{error}");
        assert!(error.contains(name), "{error}");
        let Volts { dc_v, peak_v, .. } = volts(&bench.card_v(), RATE_HZ);
        println!("{name}: {dc_v:.3} V direct voltage, {peak_v:.1} V at most");
        assert!(dc_v <= 1.0 && peak_v > 60.0, "{dc_v} V, {peak_v} V");
    }
}

/// The same by a study.
#[test]
fn a_study_takes_no_carrier_away() {
    let device = |more: &str| format!("device = {{ adapter = 'daq', drive_v = 150, {more} }}");
    let file = "device = { adapter = 'file' }";
    let run = |more: &str| {
        let place =
            crate::studies::short(&[(file, &device(more)), ("trial_s = 0.05", "trial_s = 0.5")]);
        let driver = format!("driver={}", crate::simulated::built().display());
        let run = ["study", "run", "study.toml", "--simulated", "11", "--fast"];
        let card = ["--participant", "Ann", "--profile", PAPER, "--set", &driver];
        let mut command = place.command(&[&run[..], &card].concat());
        (recorded(&mut command, &place).output().unwrap(), place)
    };
    let (done, place) = run("rate_hz = 7000");
    let error = text(&done);
    assert_eq!(done.status.code(), Some(1), "{error}");
    assert!(error.contains("2.5 times"), "{error}");
    assert!(!place.path(RECORD).exists());
    let (done, place) = run("settings = { carrier_hz = 0 }");
    assert!(done.status.success(), "{}", text(&done));
    let Volts { dc_v, peak_v, .. } = volts(&crate::bench::card_v(&place), RATE_HZ);
    // A study begins 20 dB below the drive.
    assert!(dc_v <= 1.0 && peak_v > 15.0, "{dc_v} V, {peak_v} V");
}

/// A command whose card is recorded in a folder, with a clock that advances by calls.
fn recorded<'a>(command: &'a mut Command, place: &Place) -> &'a mut Command {
    command
        .env("NIDAQMX_SIM_RECORD", place.path(""))
        .env("NIDAQMX_SIM_CLOCK", "calls")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
}

/// Clipping at the drive makes direct voltage where the rate is three times the carrier: whatever
/// produces it, the output goes to zero.
#[test]
fn direct_voltage_goes_to_zero_whatever_produced_it() {
    // A person who says that the rig has no carrier, and does not say that it may have direct
    // voltage.
    let bench = scene(json!({}));
    let mut play = bench.command(&["play"]);
    let words = ["direct voltage", "100 ms", "dc_limit_v", "the output is at zero"];
    bench.fails(play.args(["--set", "carrier_hz=0"]), &words);
    let Volts { dc_v, .. } = volts(&bench.card_v(), RATE_HZ);
    println!("{dc_v:.3} V direct voltage");
    assert!(dc_v <= 1.0, "{dc_v} V");
    assert_eq!(bench.card_v().last(), Some(&0.0));
    // One who says both.
    let bench = scene(json!({}));
    let mut play = bench.command(&["play"]);
    play.args(["--set", "carrier_hz=0", "--set", "dc_limit_v=150"]);
    let done = play.output().unwrap();
    assert!(done.status.success(), "{}", text(&done));
    assert!(volts(&bench.card_v(), RATE_HZ).dc_v > 10.0);
}

/// A card without an amplifier has no carrier, and says that its direct voltage is not limited
/// below its range.
#[test]
fn the_generic_profile_states_its_direct_voltage() {
    let bench = Bench::new(json!({ "device": { "adapter": "daq" }, "duration_s": 1 }));
    let driver = format!("driver={}", crate::simulated::built().display());
    let play = ["play", SCENE, "--profile", "generic", "--set", &driver];
    let done = recorded(&mut bench.0.command(&play), &bench.0).output().unwrap();
    assert!(done.status.success(), "{}", text(&done));
    let info = bench.0.run(&["device", "info", "daq"]);
    assert!(info.text().contains("direct voltage"), "{}", info.text());
}

/// Ends a player, and returns the seconds until its output stays at zero, by the card's clock.
fn seconds_to_zero(bench: &Bench, mut child: Child, name: &str) -> f64 {
    let before = bench.card_v().len();
    signal(&child, name);
    child.wait().unwrap();
    bench.comes_to_zero();
    let card_v = bench.card_v();
    let felt = card_v.iter().rposition(|v| *v != 0.0).unwrap() + 1;
    felt.saturating_sub(before) as f64 / RATE_HZ
}

#[test]
fn no_file_delays_the_zero() {
    for (buffer_ms, ramp_ms) in [(10_000, 20), (380, 20), (200, 200), (10, 390)] {
        let settings = json!({ "buffer_ms": buffer_ms, "ramp_ms": ramp_ms });
        for name in ["-INT", "-TERM", "-KILL"] {
            let device = json!({ "adapter": "daq", "drive_v": 150, "settings": settings });
            let bench = Bench::new(json!({ "device": device }));
            let mut play = bench.command(&["play"]);
            let Some(child) = started(&bench, play.env("NIDAQMX_SIM_CLOCK", "wall")) else {
                // Refused, or a buffer so short that it ran dry: at zero.
                assert!(bench.card_v().last().is_none_or(|v| *v == 0.0));
                continue;
            };
            let seconds = seconds_to_zero(&bench, child, name);
            println!("{settings} {name}: zero after {seconds:.3} s");
            assert!(seconds <= 0.5, "{settings} {name}: {seconds} s");
        }
    }
}

/// Starts a player, and waits until there is output; `None` if it ends without.
fn started(bench: &Bench, play: &mut Command) -> Option<Child> {
    let mut child = play.spawn().unwrap();
    while child.try_wait().unwrap().is_none() {
        if bench.card_v().iter().any(|v| *v != 0.0) {
            return Some(child);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    None
}
