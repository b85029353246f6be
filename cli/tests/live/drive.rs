//! Scenes played on the simulated card: the output voltage, and that it is zero after
//! every failure.

use std::process::{Command, Stdio};
use std::time::Duration;
#[cfg(target_os = "linux")]
use std::{
    io::{BufRead, BufReader},
    process::{Child, Output},
    time::Instant,
};

use crate::bench::{Bench, EXAMPLES, GAIN, PAPER, RATE_HZ, RECORD, SCENE, check_failed};
use crate::common::{Place, signal};
use htex_check::device::{Direction, checks_of};
use serde_json::{Value, json};

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
        // Volts at the display.
        let file_v = bench.0.samples("drive.wav");
        let wav = hound::WavReader::open(bench.0.path("drive.wav")).unwrap();
        assert_eq!(f64::from(wav.spec().sample_rate), RATE_HZ);
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
    // Nor does a scene without what makes its newtons volts, brings these from zero and back, and
    // holds them at the drive.
    for effect in ["square_root", "contact", "limiter", "carrier"] {
        let raw = Bench::new(json!({ "duration_s": 1, "effects": { effect: "off" } }));
        raw.fails(&mut raw.command(&["play"]), &[&format!("`{effect}` is off")]);
        assert!(!raw.0.path(RECORD).exists());
    }
    let none = Bench::new(json!({ "duration_s": 1 }));
    let mut play =
        none.0.command(&["play", SCENE, "--profile", PAPER, "--set", "driver=/no/such.so"]);
    none.fails(&mut play, &["`driver`", "`/no/such.so` cannot be loaded as the NI-DAQmx library"]);
    for bench in [fast, high, none] {
        assert!(!bench.0.path(RECORD).exists());
    }
}

/// What a scene says of the hardware is not used: gain, limit, channel, the ramp, the driver, the
/// rig itself.
#[test]
fn a_scene_never_overrides_the_rig() {
    let settings = json!({ "amplifier_gain": 15, "limit_v": 500, "ramp_ms": 1, "device": "Dev1/ao1", "dac_bits": 4 });
    let device =
        json!({ "adapter": "daq", "profile": "generic", "settings": settings, "drive_v": 150 });
    let bench = Bench::new(json!({ "device": device, "duration_s": 2 }));
    let done = bench.command(&["play"]).output().unwrap();
    let error = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{error}");
    for word in ["amplifier_gain", "limit_v", "ramp_ms", "device", "dac_bits", "150 holds"] {
        assert!(error.contains(word), "{word}: {error}");
    }
    assert_eq!(error.matches("DEVICE_HARDWARE").count(), 5, "{error}");
    let most = bench.card_v().iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    assert!(most > 1.0 && most <= 150.0 / GAIN, "{most} V of the card");
    // Without settings from the user there is no rig, and nothing is played.
    let driver = format!("driver={}", crate::simulated::built().display());
    let alone = Bench::new(json!({ "duration_s": 1 }));
    let mut play = alone.0.command(&["play", SCENE, "--set", &driver]);
    play.env("NIDAQMX_SIM_RECORD", alone.0.path("")).stdout(Stdio::piped()).stderr(Stdio::piped());
    let profile = format!("`profile {PAPER}`");
    alone.fails(&mut play, &["DEVICE_HARDWARE", &profile, "(see --profile", "amplifier_gain"]);
    assert!(!alone.0.path(RECORD).exists());
    // Anyone may lower the limit; the smallest holds.
    for (asked, given, holds) in
        [(Some(40.0), None, 40.0), (Some(400.0), Some("60"), 60.0), (None, Some("400"), 150.0)]
    {
        let mut device = json!({ "adapter": "daq", "drive_v": 150 });
        if let Some(limit_v) = asked {
            device["settings"] = json!({ "limit_v": limit_v });
        }
        device["drive_v"] = holds.into();
        let bench = Bench::new(json!({ "device": device, "duration_s": 2 }));
        let given = given.map(|limit_v| format!("limit_v={limit_v}"));
        let set: Vec<&str> = given.iter().flat_map(|set| ["--set", set]).collect();
        let done = bench.command(&[&["play"], &set[..]].concat()).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let most = bench.card_v().iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        assert!(most > 0.6 * holds / GAIN && most <= holds / GAIN, "{holds}: {most} V of the card");
    }
}

/// Whatever a model renders, the output stays within the drive, and a texture far beyond it is
/// refused.
#[test]
fn the_drive_is_a_cap_and_what_is_far_beyond_it_is_refused() {
    let loud = |gain: f64| {
        Bench::new(json!({
            "surfaces": [{ "asset": "coarse-fabric.htex", "gain": gain, "representation": "ar" }],
            "device": { "adapter": "daq", "drive_v": 5, "levels": "own", "reference_rms": 0.01 },
            "duration_s": 5,
        }))
    };
    let most_v = |bench: &Bench| bench.card_v().iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let bench = loud(1000.0);
    let words = [
        "dB above the reference level of the drive",
        "5 % are allowed",
        "lower the surface's gain",
    ];
    bench.fails(&mut bench.command(&["play"]), &words);
    assert!(!bench.0.path(RECORD).exists());
    // Some of it is beyond the drive, and is held there.
    let bench = loud(3.0);
    let done = bench.command(&["play"]).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(
        String::from_utf8_lossy(&done.stdout)
            .contains("samples were held at the drive or the device's limit")
    );
    let most = most_v(&bench);
    assert!(most > 0.098 && most <= 5.0 / GAIN, "{most} V of the card");
    bench.is_at_zero();
}

#[test]
fn a_card_pulled_out_is_told() {
    let bench = Bench::new(json!({ "duration_s": 5 }));
    let mut play = bench.command(&["play"]);
    let words = ["-88705", "could not be set to zero: switch the amplifier off"];
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

/// The ramp to zero is completed whatever signals arrive.
#[cfg(unix)]
#[test]
fn further_signals_do_not_cut_the_way_to_zero_short() {
    for signals in [&["-INT", "-INT"][..], &["-INT", "-HUP"], &["-TERM", "-INT", "-HUP", "-TERM"]] {
        let bench = Bench::new(json!({}));
        let child = bench.start();
        for name in signals {
            signal(&child, name);
            // A signal that arrives while another is pending is lost.
            std::thread::sleep(Duration::from_millis(5));
        }
        let done = child.wait_with_output().unwrap();
        let error = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.success(), "{signals:?}: {error}");
        assert!(error.contains("going to zero; please wait"), "{signals:?}: {error}");
        if signals.len() > 2 {
            assert!(error.contains("switch the amplifier off before"), "{signals:?}: {error}");
        }
        bench.is_at_zero();
    }
}

/// A signal that ends or stops the player does not reach the process that holds the output.
#[cfg(unix)]
#[test]
fn a_player_that_is_killed_leaves_zero() {
    // A shell may have its children ignore SIGQUIT, which else ends a program as SIGABRT does.
    for name in ["-KILL", "-ABRT", "-STOP"] {
        let bench = Bench::new(json!({}));
        let mut child = bench.start();
        signal(&child, name);
        bench.comes_to_zero();
        let length = bench.card_v().len();
        if name == "-STOP" {
            child.kill().unwrap();
        }
        child.wait().unwrap();
        std::thread::sleep(Duration::from_millis(200));
        bench.is_at_zero();
        assert!(bench.card_v().len() <= length + 1, "{name}: it played on");
    }
}

/// The process that holds the output.
#[cfg(target_os = "linux")]
fn guardian(player: &Child) -> String {
    let list = Command::new("pgrep").args(["-P", &player.id().to_string()]).output().unwrap();
    String::from_utf8_lossy(&list.stdout).trim().to_owned()
}

/// Exit status 1, these words, and the output at zero. On a busy machine the second helper process
/// may take so long that a sentence comes before zero, and then zero is told by itself.
#[cfg(target_os = "linux")]
fn ended_at_zero(bench: &Bench, done: &Output, words: &[&str]) {
    let error = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(1), "{error}");
    for word in [words, &["the output was set to zero"]].concat() {
        assert!(error.contains(word), "{word}: {error}");
    }
    bench.is_at_zero();
}

/// If the process that holds the output is killed or stopped, the player has a second one set it to
/// zero, and says so; also while Ctrl-C asks for the end.
#[cfg(target_os = "linux")]
#[test]
fn a_guardian_that_is_killed_or_stopped_is_replaced_by_zero() {
    for (name, also, words) in [
        ("-KILL", None, "has ended"),
        ("-STOP", None, "did not answer within 0.82 s"),
        ("-STOP", Some("-INT"), "did not answer within 0.82 s"),
    ] {
        let bench = Bench::new(json!({}));
        let child = bench.start();
        let guardian = guardian(&child);
        let sent = Command::new("kill").args([name, &guardian]).status();
        assert!(sent.unwrap().success(), "{guardian}");
        let begun = Instant::now();
        if let Some(also) = also {
            signal(&child, also);
        }
        let done = child.wait_with_output().unwrap();
        let seconds = begun.elapsed().as_secs_f64();
        println!("{name} {also:?}: ended at zero after {seconds:.2} s");
        ended_at_zero(&bench, &done, &[words]);
    }
}

/// If a call of the driver does not return, the guardian's watchdog writes zero. If that also
/// hangs, the second helper process writes it.
#[cfg(target_os = "linux")]
#[test]
fn a_call_of_the_driver_that_does_not_return_ends_at_zero() {
    let hangs = |calls: &str| format!("DAQmxWriteAnalogF64:{calls}:hang=600000");
    for (fault, words) in [
        (hangs("100"), "has not returned for 0.3 s; the output was set to zero"),
        (hangs("100+"), "did not answer within 0.82 s"),
    ] {
        let bench = Bench::new(json!({}));
        let mut play = bench.command(&["play"]);
        play.env("NIDAQMX_SIM_CLOCK", "wall");
        let done = play.env("NIDAQMX_SIM_FAULT", &fault).output().unwrap();
        ended_at_zero(&bench, &done, &[words]);
    }
}

/// No process can reach the output: the player says so every second, until zero is confirmed or a
/// signal ends it.
#[cfg(target_os = "linux")]
#[test]
fn an_output_that_nothing_brings_to_zero_is_told_every_second() {
    const SENTENCE: &str = "htex: the output could not be set to zero: switch the amplifier off";
    for ends_by_signal in [false, true] {
        let bench = Bench::new(json!({}));
        let hangs = bench.0.path("hangs");
        let mut play = bench.command(&["play"]);
        play.env("NIDAQMX_SIM_FAULT", "DAQmxWriteAnalogF64:1+:hang=600000")
            .env("NIDAQMX_SIM_FAULT_WHILE", &hangs);
        let mut child = bench.started(&mut play);
        bench.0.write("hangs", "");
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let mut said = Vec::new();
        while said.len() < 4 {
            let line = lines.next().expect("it ended").unwrap();
            said.extend((line == SENTENCE).then(Instant::now));
        }
        let gaps: Vec<f64> =
            said.windows(2).map(|pair| (pair[1] - pair[0]).as_secs_f64()).collect();
        println!("seconds between the sentences: {gaps:?}");
        assert!(gaps.iter().all(|gap| (0.5..3.0).contains(gap)), "{gaps:?}");
        if ends_by_signal {
            signal(&child, "-INT");
            assert_eq!(child.wait().unwrap().code(), Some(130));
        }
        // A helper process that is left goes on when the driver does.
        std::fs::remove_file(&hangs).unwrap();
        let rest: Vec<String> = lines.map(Result::unwrap).collect();
        let code = child.wait().unwrap().code();
        if !ends_by_signal {
            assert_eq!(code, Some(1), "{rest:?}");
            assert_eq!(rest.last().unwrap(), "htex: the output was set to zero");
        }
        bench.comes_to_zero();
    }
}

/// A bare name is a file in the current folder. If no such file exists, the system's loader
/// searches for the name. The error says so.
#[test]
fn a_driver_is_found_by_its_bare_name() {
    let place = Place::new();
    let name = crate::simulated::built().file_name().unwrap();
    std::fs::copy(crate::simulated::built(), place.path(name.to_str().unwrap())).unwrap();
    let driver = format!("driver={}", name.display());
    let problem = |driver: &str| {
        let device = ["device", "info", "daq", "--json", "--profile", PAPER];
        place.json(&[&device[..], &["--set", driver]].concat())["problem"].clone()
    };
    assert_eq!(problem(&driver), Value::Null);

    let absent = problem("driver=libabsent.so.1").to_string();
    for words in ["libabsent.so.1", "current folder", "LD_LIBRARY_PATH"] {
        assert!(absent.contains(words), "{absent}");
    }
    let file = place.write("text.so", "no library");
    let (problem, reason) =
        (problem("driver=text.so").to_string(), format!("{}: ", file.display()));
    assert!(problem.contains(&reason), "{problem}");
}

#[test]
fn the_adapter_keeps_what_devices_promise() {
    let place = Place::new();
    let driver = format!("driver={}", crate::simulated::built().display());
    let check = ["device", "check", "daq", "--profile", PAPER, "--json"];
    let mut check = place.command(&[&check[..], &["--set", &driver]].concat());
    let done = check.env("NIDAQMX_SIM_CLOCK", "calls").output().unwrap();
    let report: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert!(done.status.success(), "{report:#}");
    let all = report["checks"].as_array().unwrap().iter();
    let passed = all.filter(|check| check["outcome"] == "passed").count();
    // Seven checks are of libraries, and the installed driver, which lists outputs, may be absent.
    let all = checks_of(Some(Direction::Output)).count();
    assert!(passed >= all - 8, "{report:#}");
}
