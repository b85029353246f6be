//! Inputs of third parties on the command line, recorded as a user does it, and the checker of
//! devices: a valid input passes, and each faulty one fails the right check.

use std::path::{Path, PathBuf};

use crate::common::native::{self, complaints, count};
use crate::common::{Place, words};
use htex_check::device::{Direction, checks_of};
use serde_json::Value;

/// The faults of `tests/bad-devices/input.c`.
const FAULTS: &[native::Fault] = &[
    ("MARKER", "marker", "failed"),
    ("EXPORT_MISSING", "exports", "failed"),
    ("TARGET", "descriptor", "failed"),
    ("NO_TEXT", "descriptor", "failed"),
    ("EXTENSIONS", "extensions", "failed"),
    ("ENDPOINTS", "endpoints", "failed"),
    ("RATE_NAN", "open", "failed"),
    ("NO_CHANNELS", "open", "failed"),
    ("CHANGES", "open", "failed"),
    ("ACCEPTS_SETTING", "bad-settings", "failed"),
    ("ACCEPTS_TWICE", "bad-settings", "failed"),
    ("SETTING_UNNAMED", "bad-settings", "failed"),
    ("READS_EARLY", "start", "failed"),
    ("READ_TOO_MANY", "read", "failed"),
    ("READ_CRASHES", "read", "crashed"),
    ("READ_LOOPS", "read", "timed-out"),
    ("NAN", "read", "failed"),
    ("LATE", "timeout", "failed"),
    ("AFTER_STOP", "finish", "failed"),
    ("CLOSED_HANDLE", "handles", "failed"),
    ("ACCEPTS_NULL", "arrays", "failed"),
    ("STREAM_BEYOND", "arrays", "failed"),
    ("TWO", "two", "failed"),
    ("LEAK", "memory", "failed"),
    ("OPENINGS_LEAK", "memory", "failed"),
];

/// The ridges of `examples`.
fn ridges(place: &Place) -> PathBuf {
    native::example(place, "device-c-ridges", "ridges.c")
}

fn bad(place: &Place, good: &Path, fault: &str) -> String {
    native::bad(place, "bad-devices/input.c", good, fault)
}

/// Number of checks of an input.
fn all() -> usize {
    checks_of(Some(Direction::Input)).count()
}

fn checked(place: &Place, arguments: &[&str]) -> Value {
    native::checked(place, arguments)
}

#[test]
fn sound_inputs_pass() {
    let place = Place::new();
    let ridges = ridges(&place);
    let report = checked(&place, &[ridges.to_str().unwrap()]);
    assert_eq!(count(&report, "passed"), all(), "{report:#}");
    let name = ridges.file_name().unwrap().to_str().unwrap();
    let fast = checked(&place, &[name, "--set", "pace=fast"]);
    assert_eq!(complaints(&fast), []);
    #[cfg(feature = "lab")]
    {
        let path = format!("path={}", place.recording("vinyl"));
        let file = checked(&place, &["file", "--input", "--set", &path, "--set", "pace=fast"]);
        assert_eq!(complaints(&file), []);
        // Checks of a library: marker, exports, extensions, settings as lines, handles, arrays.
        assert_eq!(count(&file, "skipped"), 6, "{file:#}");
    }
}

#[test]
fn each_fault_is_found_by_its_own_check() {
    let place = Place::new();
    let good = ridges(&place);
    native::each_fault_is_found(
        (&place, "bad-devices/input.c", &good),
        (FAULTS, Direction::Input),
        |&(fault, _, outcome)| {
            let pace = match fault {
                "READ_LOOPS" | "LEAK" => "pace=fast",
                _ => "pace=real",
            };
            vec!["--timeout", if outcome == "timed-out" { "5" } else { "60" }, "--set", pace]
        },
    );
}

/// A third party's source is recorded, every sample as the library made it, and the recording is
/// fitted.
#[cfg(feature = "lab")]
#[test]
fn the_ridges_are_recorded_and_fitted() {
    let place = Place::new();
    let library = ridges(&place);
    let record = |more: &[&str]| {
        let base = words(
            "record --source ridges:0.8 --set pace=fast --take ridges --seconds 4 \
             --min-sweeps 0 --countdown 0 --target-speed 80 --target-force 0.4 -o takes",
        );
        place.command(&[&base[..], more].concat())
    };
    let named = record(&["--device-file", library.to_str().unwrap(), "--json"]);
    let output = { named }.output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{error}");
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    let csv = std::fs::read_to_string(place.path("takes/ridges-001.csv")).unwrap();
    let mut lines = csv.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| columns.iter().position(|c| c.starts_with(name)).unwrap();
    let (force, normal, speed) = (column("lateral_x"), column("normal"), column("speed"));
    let mut rows = 0;
    for (frame, line) in lines.enumerate() {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let way_mm = 80.0 * frame as f64 / 5000.0 % 120.0;
        let x_mm = if way_mm >= 60.0 { 120.0 - way_mm } else { way_mm };
        let side = if way_mm >= 60.0 { 1.0 } else { -1.0 };
        let ripple = 0.2 * (std::f64::consts::TAU * x_mm / 0.8).sin();
        let expected = 0.5 * 0.4 * (ripple + side);
        assert!((cells[force] - expected).abs() < 1e-9, "frame {frame}: {line}");
        assert!((cells[normal] - 0.4).abs() < 1e-12 && cells[speed] == 80.0);
        rows += 1;
    }
    assert_eq!(rows, 20_000);
    let fit = said["kept"]["fit"].as_array().unwrap().iter();
    let fit: Vec<&str> = fit.map(|word| word.as_str().unwrap()).collect();
    let fit = place.run(&[&["fit"], &fit[..], &["-o", "ridges.htex"]].concat());
    assert_eq!(fit.code(), 0, "{}", fit.error());

    // By the environment; and the end of a source is the end of its take.
    let folder = library.parent().unwrap();
    let mut short = record(&["--set", "seconds=1"]);
    let output = short.env("HTEX_DEVICE_PATH", folder).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(error.contains("incomplete/ridges-002.csv"), "{error}");
    let csv = std::fs::read_to_string(place.path("takes/incomplete/ridges-002.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 5_000);
}

#[cfg(feature = "lab")]
#[test]
fn what_is_no_input_is_refused_with_its_reason() {
    let place = Place::new();
    let strip = native::example(&place, "device-c-strip", "strip.c");
    let good = ridges(&place);
    let nan = bad(&place, &good, "NAN");
    let many = bad(&place, &good, "READ_TOO_MANY");
    let rate = bad(&place, &good, "RATE_NAN");
    let good = good.to_str().unwrap();
    let cases = [
        (strip.to_str().unwrap(), "ridges", 2, "no input `ridges`; there are file, daq"),
        ("no-such.so", "ridges", 1, "no-such.so"),
        (good, "ridges:0", 2, "`0` is not a number from 0.01 to 10"),
        (good, "rigdes:1", 2, "no input `rigdes`; there are ridges, file, daq"),
        (&nan, "ridges:1", 1, "of channel `speed` is NaN"),
        (&many, "ridges:1", 1, "it delivered"),
        (&rate, "ridges:1", 1, "stream: "),
    ];
    for (library, source, code, said) in cases {
        let run = place.run(&words(&format!(
            "record --device-file {library} --source {source} --seconds 1 --countdown 0 \
             --set pace=fast -o takes"
        )));
        let error = run.error();
        assert!(run.code() == code && error.contains(said), "{said}: {error}");
    }
}

#[test]
fn inputs_are_listed_and_shown() {
    let place = Place::new();
    let library = ridges(&place);
    let named = library.to_str().unwrap();
    let folder = library.parent().unwrap().to_str().unwrap();
    let exported = place.run(&["plugin", "export", named]);
    assert_eq!(exported.code(), 0, "{}", exported.error());
    let twice = ["--device-file", named, "--device-dir", folder];
    let list = place.json(&[&["device", "list", "--json"], &twice[..]].concat());
    let mut inputs = list["devices"].as_array().unwrap().iter();
    let first = inputs.find(|device| device["direction"] == "input").unwrap();
    assert_eq!(
        (&first["id"], &first["target"]),
        (&"org.example.ridges".into(), &"spacing_mm".into())
    );
    assert_eq!(first["endpoints"][0]["setting"], "spacing_mm");
    assert_eq!(first["settings"][3]["name"], "rate_hz");
    assert!(list["notes"][0].as_str().unwrap().starts_with("input org.example.ridges ("));
    let ids: Vec<&Value> = list["devices"].as_array().unwrap().iter().map(|d| &d["id"]).collect();
    assert!(ids.contains(&&"org.htex.file".into()));
    let text = place.run(&[&["device", "list"], &twice[..]].concat()).text();
    for words in [
        "outputs\n  file ",
        "inputs\n  ridges ",
        "spacing_mm=1  coarse ridges",
        "settings: spacing_mm=1 speed_mm_s=80",
        "terminals=default",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let info = place.json(&["device", "info", "--json", named, "--set", "rate_hz=800"]);
    assert_eq!(info["stream"]["rate_hz"], 800.0);
    assert_eq!(info["stream"]["channels"][1]["name"], "normal");
    let text = place.run(&["device", "info", named]).text();
    assert!(
        text.contains("rate: 5000 Hz\n  channels: lateral_x in N, normal in N, speed in mm/s"),
        "{text}"
    );
    assert!(text.contains("pace: real or fast [real]"), "{text}");
    for (arguments, code) in [
        (&["device", "info", "--input", "no-such-input"][..], 2),
        (&["device", "check", "--input", "no-such-input"], 2),
        (&["device", "list", "--device-file", "no-such.so"], 1),
    ] {
        assert_eq!(place.run(arguments).code(), code, "{arguments:?}");
    }
}
