//! Recording as a user does it: a replayed file and the simulated card, takes that are repeated,
//! errors that lose nothing.

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::common::{Place, entries, words};
use serde_json::Value;

/// Volts for a newton of the sensor, and for a millimetre of the tracker that is wired to the card.
const VOLTS: [f64; 4] = [1.0, 1.0, 2.0, 0.01];
const MAP: &str = "lateral_x=ai0:1,lateral_y=ai1:1,normal=ai2*0.5,y=ai3*100";

/// A recording of a simulated finger, as voltages of four inputs at 2 kHz; `force` times as strong
/// as 0.4 N.
fn volts(place: &Place, force: f64) -> Vec<String> {
    let newtons = (0.4 * force).to_string();
    let run = place.run(&words(&format!(
        "simulate --surface vinyl --seconds 4 --rate 2000 --force {newtons} -o sim.csv"
    )));
    assert_eq!(run.code(), 0, "{}", run.error());
    let csv = std::fs::read_to_string(place.path("sim.csv")).unwrap();
    let line = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let volts: Vec<String> = [cells[1], cells[2], cells[3], cells[5]]
            .iter()
            .zip(VOLTS)
            .map(|(c, v)| (c * v).to_string())
            .collect();
        volts.join(",")
    };
    csv.lines().skip(2).map(line).collect()
}

/// A recording from the card.
fn command(place: &Place, more: &[&str]) -> Command {
    let driver = format!("driver={}", crate::simulated::built().display());
    let base = words(
        "record --source daq:Dev1/ai0:3 --set rate_hz=2000 --take vinyl --seconds 4 --countdown 0 \
         --target-speed 80 --target-force 0.4 -o takes",
    );
    let card = ["--set", &driver, "--map", MAP];
    let mut command = place.command(&[&base[..], &card, more].concat());
    command
        .env("NIDAQMX_SIM_CLOCK", "calls")
        .env("NIDAQMX_SIM_INPUT", place.path("volts.csv"))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_take_through_the_card_is_repeated_until_it_keeps_to_its_target_and_is_fitted() {
    let place = Place::new();
    let both = [volts(&place, 1.5), volts(&place, 1.0)].concat();
    place.write("volts.csv", both.join("\n"));
    let output = command(&place, &["--json"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", error(&output));
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&said["takes"][0]["outcome"], &said["kept"]["number"]),
        (&"rejected".into(), &2.into())
    );
    let reason = said["takes"][0]["verdict"]["reasons"][0].as_str().unwrap();
    assert!(reason.starts_with("force: mean 0."), "{reason}");
    assert_eq!(entries(&place.path("takes")), ["rejected", "vinyl-002.csv", "vinyl-002.json"]);
    let fit: Vec<&str> =
        said["kept"]["fit"].as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect();
    let fit = place.run(&[&["fit"], &fit[..], &["-o", "vinyl.htex"]].concat());
    assert_eq!(fit.code(), 0, "{}", fit.error());
    let info = place.json(&["info", "vinyl.htex", "--json"]);
    assert!(info.to_string().contains("sbeta"), "{info}");
}

/// A recording that clips is kept and said to clip, in the terminal and in JSON; what a take needs
/// is said before it.
#[test]
fn findings_and_what_a_take_needs_are_said_in_the_terminal() {
    let place = Place::new();
    let rows = volts(&place, 1.0);
    let rows: Vec<Vec<f64>> =
        rows.iter().map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    let most = rows.iter().map(|row| row[1].abs()).fold(0.0, f64::max);
    let clipped = rows.iter().map(|row| {
        let mut row = row.clone();
        row[1] = row[1].clamp(-0.6 * most, 0.6 * most);
        row.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
    });
    place.write("volts.csv", clipped.collect::<Vec<_>>().join("\n"));
    let output = command(&place, &["--json"]).output().unwrap();
    let text = error(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let needs = "take 1: 4 s; it needs: on target 50 % or more, complete sweeps 1 or more";
    assert!(text.contains(needs), "{text}");
    assert!(
        text.contains("vinyl-001.csv: kept") && text.contains("\n  RECORDING_CLIPPED: "),
        "{text}"
    );
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    let coverage = &said["kept"]["verdict"]["coverage"];
    assert!(coverage["on_target"].as_f64().unwrap() > 0.6, "{coverage}");
    // With more than it can have, the take is refused.
    let output =
        command(&place, &["--min-sweeps", "9", "--min-on-target", "0.95", "--attempts", "1"])
            .output()
            .unwrap();
    let text = error(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(
        text.contains("at least 95 % is asked for") && text.contains("at least 9 asked for"),
        "{text}"
    );
}

/// A format without names and rates is read by the JSON beside it, and a recording of another kind
/// by the flags.
#[test]
fn takes_in_any_format_are_compared_without_flags() {
    let place = Place::new();
    place.write("volts.csv", volts(&place, 1.0).join("\n"));
    for format in ["csv", "npy", "wav"] {
        let output = command(&place, &["--format", format]).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", error(&output));
    }
    let compare = |files: [&str; 2], more: &[&str]| {
        let run = [&["compare"], &files[..], &["--json"], more].concat();
        place.json(&run)
    };
    for other in ["takes/vinyl-002.npy", "takes/vinyl-003.wav"] {
        for files in [["takes/vinyl-001.csv", other], [other, "takes/vinyl-001.csv"]] {
            let found = compare(files, &[]);
            let off_db = found["other"]["band_error_rms_db"].as_f64().unwrap();
            assert!(off_db.abs() < 1e-4, "{files:?}: {off_db} dB");
            let speeds = [&found, &found["other"]].map(|of| of["speed_mm_s"].as_f64().unwrap());
            assert!((speeds[0] / speeds[1] - 1.0).abs() < 1e-6, "{speeds:?}");
            assert!(found["force_n"].as_f64().unwrap() > 0.3, "{found}");
        }
    }
    let take = "takes/vinyl-002.npy";
    std::fs::copy(place.path(take), place.path("bare.npy")).unwrap();
    let bare = ["compare", take, "bare.npy"];
    let refused = place.run(&bare);
    assert_eq!(refused.code(), 1);
    assert!(refused.error().contains("bare.npy: "), "{}", refused.error());
    let map = "lateral_x=#1:1,lateral_y=#2:1,normal=#3:1,y=#4:1";
    let flags = ["--rate", "2000", "--map", map];
    let found = compare([take, "bare.npy"], &flags);
    assert_eq!(found["other"]["band_error_rms_db"], 0.0);
    // Of one recording, flags say what is read.
    let energy = |more: &[&str]| {
        let spectrum = place.json(&[&["process", take, "--json"], more].concat());
        let magnitude = spectrum["magnitude"].as_array().unwrap();
        magnitude.iter().map(|m| m.as_f64().unwrap().powi(2)).sum::<f64>()
    };
    let [both, one] = [energy(&[]), energy(&["--rate", "2000", "--map", "lateral=#1:1"])];
    assert!(one < both, "{one} {both}");
    let said = place.run(&[&bare, &flags[..]].concat()).error();
    assert!(said.contains("vinyl-002.npy: its columns"), "{said}");
}

#[test]
fn an_overrun_and_an_unplugged_card_are_named_and_what_was_recorded_stays() {
    let place = Place::new();
    place.write("volts.csv", volts(&place, 1.0).join("\n"));
    let faults = [
        ("NIDAQMX_SIM_FAULT", "DAQmxReadAnalogF64:900:error=-200279", "lost samples"),
        ("NIDAQMX_SIM_UNPLUG_AFTER", "5000", "-88705"),
    ];
    for (number, (variable, value, words)) in faults.into_iter().enumerate() {
        let output = command(&place, &[]).env(variable, value).output().unwrap();
        let text = error(&output);
        assert_eq!(output.status.code(), Some(1), "{text}");
        let kept = format!("incomplete/vinyl-00{}.csv", number + 1);
        assert!(text.contains(words) && text.contains(&kept), "{text}");
        let rows =
            std::fs::read_to_string(place.path("takes").join(&kept)).unwrap().lines().count() - 1;
        assert!(rows > 3_000, "{rows}");
        assert_eq!(entries(&place.path("takes")), ["incomplete"]);
    }
}

/// Whether a part file has a whole chunk after its header: its kind, the number of bytes, these and
/// eight of a hash.
#[cfg(unix)]
fn has_chunk(part: &Path) -> bool {
    let bytes = std::fs::read(part).unwrap_or_default();
    let header = bytes.iter().position(|byte| *byte == b'\n');
    let chunk = header.map_or(&[][..], |end| &bytes[end + 1..]);
    chunk.get(1..5).is_some_and(|length| {
        let length = u32::from_le_bytes(length.try_into().unwrap());
        chunk.len() >= 5 + length as usize + 8
    })
}

#[cfg(unix)]
#[test]
fn a_killed_recording_loses_the_current_second_at_most() {
    let place = Place::new();
    let recording = place.recording("vinyl");
    let source = format!("file:{recording}");
    let arguments =
        ["record", "--source", &source, "--seconds", "4", "--countdown", "0", "-o", "takes"];
    let mut child =
        place.command(&arguments).stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
    let (part, since) = (place.path("takes/take-001.part"), Instant::now());
    // In real time, until the first second is written.
    while !has_chunk(&part) {
        assert!(since.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(10));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(part.exists());
    let again = place.run(&[&arguments[..], &["--fast"]].concat());
    assert_eq!(again.code(), 0, "{}", again.error());
    assert!(
        again.error().contains("recovered takes/incomplete/take-001.csv: incomplete, "),
        "{}",
        again.error()
    );
    assert_eq!(entries(&place.path("takes")), ["incomplete", "take-002.csv", "take-002.json"]);
    let [killed, whole] = ["incomplete/take-001.csv", "take-002.csv"]
        .map(|name| std::fs::read_to_string(place.path("takes").join(name)).unwrap());
    assert!(
        killed.lines().count() > 1_000 && whole.starts_with(&killed),
        "the beginning, bit for bit"
    );
}

#[test]
fn what_cannot_be_recorded_is_said_before_anything_is() {
    let place = Place::new();
    let recording = place.recording("vinyl");
    place.write("bad.csv", "1,2,3\n");
    let file = format!("file:{recording}");
    let cases: [(&[&str], i32, &str); 9] = [
        (&["--source", "tape:x"], 2, "no input `tape`; there are file, daq"),
        (&["--source", "file:none.csv"], 1, "none.csv"),
        (&["--source", &file, "--take", "../x"], 2, "the name of the takes"),
        (&["--source", &file, "--seconds", "0"], 2, "the length of a take is 0"),
        (&["--source", &file, "--tolerance", "2"], 2, "the tolerance is 2"),
        (&["--source", &file, "--calibration", "bad.csv"], 1, "bad.csv: 1 rows of numbers, not 6"),
        (&["--source", &file, "--map", "lateral=nothing"], 1, "nothing"),
        (&["--source", &file, "--map", "lateral=#1:1", "--quantity", "weight"], 2, "weight"),
        (&["--source", &file, "--tracker", "mouse"], 2, "lines:-"),
    ];
    for (arguments, code, words) in cases {
        let run = place.run(&[&["record", "--countdown", "0", "-o", "takes"], arguments].concat());
        assert_eq!(run.code(), code, "{arguments:?}: {}", run.error());
        assert!(run.error().contains(words), "{arguments:?}: {}", run.error());
        assert!(!place.path("takes/take-001.csv").exists());
    }
    let long =
        place.run(&["record", "--fast", "--source", &file, "--seconds", "30", "-o", "takes"]);
    assert_eq!(long.code(), 1, "{}", long.error());
    assert!(
        long.error().contains("the source ended 4.000 s into a take of 30 s"),
        "{}",
        long.error()
    );
}
