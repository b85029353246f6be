//! Scenes and studies that ask for anything a stranger could, drawn by a seed, played on the
//! paper's rig.

use std::time::Instant;

use serde_json::{Map, Value, json};

use super::volts::{Volts, volts};
use super::*;
use crate::common::Random;

/// Scenes and studies in a test, and with `HTEX_WHOLE`.
const SAMPLE: u64 = 20;
const WHOLE: u64 = 1_000;
/// The rig's limit, volts.
const LIMIT_V: f64 = 150.0;
/// Longest time to zero, seconds.
const MOST_S: f64 = 0.5;

/// Settings of the rig that a file may ask for, with extreme values.
fn settings(dice: &mut Random) -> Value {
    let all: [(&str, &[f64]); 8] = [
        ("carrier_hz", &[0.0, 1.0, 20.0, 7_000.0, 10_000.0]),
        ("dc_limit_v", &[0.01, 1.0, 10.0, 1_000.0]),
        ("limit_v", &[0.1, 40.0, 150.0, 1_000.0]),
        ("buffer_ms", &[10.0, 50.0, 380.0, 10_000.0]),
        ("ramp_ms", &[1.0, 20.0, 180.0, 390.0, 1_000.0]),
        ("amplifier_gain", &[0.001, 1.0, 50.0]),
        ("dac_full_scale_v", &[0.1, 100.0]),
        ("dac_bits", &[1.0, 16.0]),
    ];
    let mut settings = Map::new();
    for (name, values) in all {
        if dice.one_in(10) {
            settings.insert(name.to_owned(), dice.of(values).into());
        }
    }
    settings.into()
}

fn device(dice: &mut Random) -> Value {
    let mut device = json!({ "adapter": "daq", "settings": settings(dice) });
    device["drive_v"] = dice.of(&[1.0, 75.0, 150.0]).into();
    if dice.one_in(3) {
        let rates = [
            100.0, 3_500.0, 7_000.0, 7_001.0, 14_000.0, 17_500.0, 20_000.0, 20_999.0, 21_000.0,
            28_000.0, 35_000.0, 100_000.0,
        ];
        device["rate_hz"] = dice.of(&rates).into();
    }
    if dice.one_in(3) {
        device["levels"] = "own".into();
        device["reference_rms"] = dice.of(&[1e-6, 0.003, 0.01, 1.0]).into();
    }
    device
}

fn motion(dice: &mut Random) -> Value {
    if dice.one_in(4) {
        json!({ "trace": "hand.csv" })
    } else {
        json!({ "constant": {
            "speed_mm_s": dice.of(&[0.0, 5.0, 80.0, 80.0, 300.0, 999.0, 10_000.0]),
            "force_n": dice.of(&[0.0, 0.4, 0.4, 3.0, 19.0, 1_000.0]),
        } })
    }
}

fn effects(dice: &mut Random) -> Value {
    let all = [
        "carrier",
        "contact",
        "limiter",
        "square_root",
        "gain",
        "resampling",
        "quantisation",
        "level_scaling",
        "frequency_scaling",
        "interpolation",
        "direction",
        "crossfade",
    ];
    let mut effects = Map::new();
    for name in all {
        if dice.one_in(25) {
            effects.insert(name.to_owned(), dice.of(&["on", "off", "auto"]).into());
        }
    }
    effects.into()
}

fn scene(dice: &mut Random) -> Value {
    let surface = json!({
        "asset": dice.of(&["coarse-fabric.htex", "vinyl.htex"]),
        "gain": dice.of(&[0.0, 1.0, 1.0, 3.0, 1_000.0]),
    });
    json!({ "surfaces": [surface], "device": device(dice), "motion": motion(dice), "effects": effects(dice), "seed": dice.below(1_000) })
}

/// The highest of what was measured.
#[derive(Debug, Default)]
struct Worst {
    played: u64,
    refused: u64,
    dc_v: f64,
    peak_v: f64,
    zero_s: f64,
}

impl Worst {
    fn take(&mut self, card_v: &[f64], rate_hz: f64, what: &Value) {
        if card_v.iter().any(|v| *v != 0.0) {
            self.played += 1
        } else {
            self.refused += 1
        }
        assert!(card_v.last().is_none_or(|v| *v == 0.0), "not at zero: {what}");
        let Volts { dc_v, peak_v } = volts(card_v, rate_hz);
        assert!(dc_v <= 1.0, "{dc_v} V direct voltage: {what}");
        assert!(peak_v <= LIMIT_V * (1.0 + 1e-6), "{peak_v} V: {what}");
        self.dc_v = self.dc_v.max(dc_v);
        self.peak_v = self.peak_v.max(peak_v);
    }
}

/// Played, or refused with an error: no panic, no end by a signal.
fn ended_soundly(output: &Output, what: &Value) {
    let code = output.status.code();
    let is_sound = code == Some(0) || code == Some(1);
    assert!(is_sound, "{code:?}, {}: {what}", text(output));
}

fn rate_of(device: &Value) -> f64 {
    device["rate_hz"].as_f64().unwrap_or(RATE_HZ)
}

/// Plays a scene to its end.
fn to_its_end(dice: &mut Random, worst: &mut Worst) {
    let mut what = scene(dice);
    what["duration_s"] = dice.of(&[0.05, 0.3, 1.0]).into();
    let bench = Bench::new(what.clone());
    ended_soundly(&bench.command(&["play"]).output().unwrap(), &what);
    worst.take(&bench.card_v(), rate_of(&what["device"]), &what);
}

/// Plays a scene in real time, and ends the player.
fn interrupted(dice: &mut Random, worst: &mut Worst) {
    let what = scene(dice);
    let (bench, name) = (Bench::new(what.clone()), dice.of(&["-INT", "-TERM", "-KILL"]));
    let mut play = bench.command(&["play"]);
    play.stderr(Stdio::null()).stdout(Stdio::null());
    let begun = Instant::now();
    let mut child = play.env("NIDAQMX_SIM_CLOCK", "wall").spawn().unwrap();
    let is_felt = || bench.card_v().iter().any(|v| *v != 0.0);
    while child.try_wait().unwrap().is_none() && !is_felt() {
        // Silent for ever, as at 0 mm/s.
        if begun.elapsed() > Duration::from_secs(3) {
            child.kill().unwrap();
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let rate_hz = rate_of(&what["device"]);
    if child.try_wait().unwrap().is_none() {
        let before = bench.card_v().len();
        signal(&child, name);
        child.wait().unwrap();
        bench.comes_to_zero();
        let felt = bench.card_v().iter().rposition(|v| *v != 0.0).unwrap_or(0) + 1;
        let zero_s = felt.saturating_sub(before) as f64 / rate_hz;
        assert!(zero_s <= MOST_S, "{name}: zero after {zero_s} s: {what}");
        worst.zero_s = worst.zero_s.max(zero_s);
    }
    worst.take(&bench.card_v(), rate_hz, &what);
}

/// A value as TOML.
fn toml(value: &Value) -> String {
    match value {
        Value::Object(all) => {
            let pairs: Vec<String> =
                all.iter().map(|(k, v)| format!("{k} = {}", toml(v))).collect();
            format!("{{ {} }}", pairs.join(", "))
        }
        other => other.to_string(),
    }
}

/// Runs a study of a simulated participant.
fn studied(dice: &mut Random, worst: &mut Worst) {
    let what = device(dice);
    let place = crate::studies::short(&[
        ("device = { adapter = 'file' }", &format!("device = {}", toml(&what))),
        ("trial_s = 0.05", "trial_s = 0.2"),
    ]);
    let driver = format!("driver={}", crate::simulated::built().display());
    let run = ["study", "run", "study.toml", "--simulated", "11", "--fast"];
    let card = ["--participant", "Ann", "--profile", PAPER, "--set", &driver];
    let mut command = place.command(&[&run[..], &card].concat());
    ended_soundly(&recorded(&mut command, &place).output().unwrap(), &what);
    worst.take(&crate::bench::card_v(&place), rate_of(&what), &what);
}

/// Direct voltage, largest voltage and time to zero of what any scene or study does on the rig.
#[test]
fn no_scene_and_no_study_harms_a_finger() {
    let count = if xtask::prove::whole() { WHOLE } else { SAMPLE };
    let mut worst = Worst::default();
    for seed in 0..count {
        let mut dice = Random(seed);
        match seed % 4 {
            0 => studied(&mut dice, &mut worst),
            1 => interrupted(&mut dice, &mut worst),
            _ => to_its_end(&mut dice, &mut worst),
        }
    }
    println!("{count} scenes and studies: {worst:?}");
    assert!(worst.played > count / 5 && worst.refused > 0, "{worst:?}");
}
