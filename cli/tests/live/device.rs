//! Outputs on the command line, including a third party's, and the checker of devices: valid outputs
//! pass, and each faulty one fails the right check.

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::common::Place;
use crate::common::native::{self, complaints, count};
use htex_check::device::{CHECKS, Direction, checks_of};
use htex_device::{Adapter, DeviceError, NativeAdapter, Settings, StreamFormat};
use serde_json::Value;

/// The faults of `tests/bad-devices/output.c`.
const FAULTS: &[native::Fault] = &[
    ("MARKER", "marker", "failed"),
    ("EXPORT_MISSING", "exports", "failed"),
    ("DESCRIPTOR_JSON", "descriptor", "failed"),
    ("DESCRIPTOR_DEFAULT", "descriptor", "failed"),
    ("PROFILE", "descriptor", "failed"),
    ("EXTENSIONS", "extensions", "failed"),
    ("ENDPOINTS", "endpoints", "failed"),
    ("VOLTAGE", "capabilities", "failed"),
    ("CAPABILITIES", "capabilities", "failed"),
    ("ACCEPTS_SETTING", "bad-settings", "failed"),
    ("ACCEPTS_TWICE", "bad-settings", "failed"),
    ("OPEN_ACCEPTS_SETTING", "bad-settings", "failed"),
    ("SETTING_UNNAMED", "bad-settings", "failed"),
    ("OPEN_HIGH", "open", "failed"),
    ("WRITE_NOTHING", "open", "failed"),
    ("ACCEPTS_RATE", "bad-rate", "failed"),
    ("ACCEPTS_BLOCK", "bad-block", "failed"),
    ("WRITE_CRASHES", "write", "crashed"),
    ("WRITE_LOOPS", "write", "timed-out"),
    ("WRITE_TOO_MANY", "write", "failed"),
    ("STATUS", "status", "failed"),
    ("STATUS_SHORT", "status", "failed"),
    ("OVER_LIMIT", "over-limit", "failed"),
    ("NAN", "no-number", "failed"),
    ("CLOSED_GOES_ON", "no-number", "failed"),
    ("WRITE_AFTER_FINISH", "finish", "failed"),
    ("LEFT_BEHIND", "abort", "failed"),
    ("CLOSED_HANDLE", "handles", "failed"),
    ("ACCEPTS_NULL", "arrays", "failed"),
    ("ACCEPTS_MISALIGNED", "arrays", "failed"),
    ("TEXT_BEYOND", "arrays", "failed"),
    ("STATUS_BEYOND", "arrays", "failed"),
    ("TWO", "two", "failed"),
    ("LEAK", "memory", "failed"),
    ("OPENINGS_LEAK", "memory", "failed"),
];

/// The strip chart of `examples`.
fn strip(place: &Place) -> PathBuf {
    native::example(place, "device-c-strip", "strip.c")
}

/// The report on a device.
fn checked(place: &Place, arguments: &[&str]) -> Value {
    native::checked(place, arguments)
}

/// A bare name is a file of the current folder; the system's loader does not search for it.
#[test]
fn a_device_is_found_by_its_bare_name() {
    let place = Place::new();
    let file = strip(&place);
    let name = file.file_name().unwrap().to_str().unwrap();
    assert_eq!(checked(&place, &[name])["ok"], true);
    for arguments in
        [["device", "info", name].as_slice(), &["device", "list", "--device-file", name]]
    {
        let run = place.run(arguments);
        assert_eq!(run.code(), 0, "{}", run.error());
        assert!(run.text().contains("strip"), "{}", run.text());
    }
    std::fs::write(&file, "no library").unwrap();
    let wrong = place.run(&["device", "info", name]);
    let reason = format!("{}: ", file.display());
    assert!(wrong.code() == 1 && wrong.error().contains(&reason), "{}", wrong.error());
}

/// The last table of the specification lists the checks, in their order and in their words.
#[test]
fn the_guarantees_of_the_specification_are_those_that_are_checked() {
    let text = std::fs::read_to_string(native::workspace().join("spec/device-abi-1.md")).unwrap();
    let rows: Vec<&str> = text.lines().filter(|line| line.starts_with("| ")).collect();
    let heading = rows.iter().position(|row| row.contains("| guarantee |"));
    let row = |(i, check): (usize, &htex_check::harness::Check<_>)| {
        let only = check.only.first().map_or("both".to_owned(), ToString::to_string);
        format!("| {} | `{}` | {only} | {} |", i + 1, check.name, check.summary)
    };
    let expected: Vec<String> = CHECKS.iter().enumerate().map(row).collect();
    assert_eq!(rows[heading.unwrap() + 1..], expected);
}

/// Number of checks of an output.
fn all() -> usize {
    checks_of(Some(Direction::Output)).count()
}

#[test]
fn sound_devices_pass() {
    let place = Place::new();
    let strip = strip(&place);
    let report = checked(&place, &[strip.to_str().unwrap()]);
    assert_eq!(count(&report, "passed"), all(), "{report:#}");
    // Checks of a library: marker, exports, extensions, settings as lines, blocks, handles, arrays.
    let file = checked(&place, &["file", "--set", "encoding=i16"]);
    assert_eq!(complaints(&file), []);
    assert_eq!(count(&file, "passed"), all() - 7, "{file:#}");
    let drive = ["quantity=display_voltage", "limit_v=100", "carrier_hz=10000"]
        .map(|pair| ["--set", pair])
        .concat();
    let drive = checked(&place, &[&["org.htex.file"], &drive[..]].concat());
    assert_eq!(complaints(&drive), []);
}

#[test]
fn each_fault_is_found_by_its_own_check() {
    let place = Place::new();
    let good = strip(&place);
    native::each_fault_is_found(
        (&place, "bad-devices/output.c", &good),
        (FAULTS, Direction::Output),
        |fault| vec!["--timeout", if fault.2 == "timed-out" { "3" } else { "60" }],
    );
}

/// A third party's device works: an hour of force becomes a picture of an hour.
#[test]
fn the_strip_chart_draws() {
    let place = Place::new();
    let adapter = NativeAdapter::load(&strip(&place)).unwrap();
    let chart = place.path("hour.svg");
    let given = [("path", chart.to_str().unwrap()), ("full_scale_n", "2")]
        .map(|(k, v)| (k.to_owned(), v.to_owned()))
        .into();
    let settings = Settings::resolve(adapter.descriptor(), Some("day"), &given).unwrap();
    assert_eq!(adapter.capabilities(&settings).unwrap().limit, Some(2.0));
    let format = StreamFormat { rate_hz: 1_000.0, block_frames: 1_000 };
    let mut device = adapter.open_output(&settings, &format).unwrap();
    for second in 0..3_600 {
        let peak = if second == 1_800 { 1.0 } else { 0.5 };
        let wave = |i: u16| peak * (f32::from(i) * 0.1).sin().signum();
        let block: Vec<f32> = (0..1_000).map(wave).collect();
        assert_eq!(device.write(&block, Duration::ZERO), Ok(1_000));
    }
    device.finish().unwrap();
    let svg = std::fs::read_to_string(&chart).unwrap();
    assert_eq!(svg.matches('V').count(), 3_600);
    // Half of full scale is a quarter of the height from the middle; 1800 s is the 1801st column.
    assert_eq!(svg.matches("50.00V").count(), 1);
    assert!(svg.contains("M1800.5 50.00V150.50"), "{}", &svg[..400]);
    assert!(svg.contains("viewBox=\"0 0         3600 200\""));
}

/// A native device returns the same kinds of errors as a device in Rust.
#[test]
fn errors_keep_their_kind() {
    let place = Place::new();
    let adapter = NativeAdapter::load(&strip(&place)).unwrap();
    let open = |path: &Path, rate_hz: f64| {
        let given = [("path".to_owned(), path.to_str().unwrap().to_owned())].into();
        let settings = Settings::resolve(adapter.descriptor(), None, &given)?;
        let format = StreamFormat { rate_hz, block_frames: 64 };
        adapter.open_output(&settings, &format)
    };
    let chart = place.path("a.svg");
    let rate = open(&chart, 1e6).err().unwrap();
    let expected = "Strip chart does not run at 1000000 Hz; it runs at 100 to 100000 Hz";
    assert_eq!(rate.to_string(), expected);
    let nowhere = place.path("no/such/a.svg");
    let file = open(&nowhere, 1e4).err().unwrap();
    let is_named = |p: &str| p == nowhere.to_str().unwrap();
    assert!(matches!(&file, DeviceError::File { path, .. } if is_named(path)), "{file}");
    let mut device = open(&chart, 1e4).unwrap();
    device.write(&[0.0; 10], Duration::ZERO).unwrap();
    let over = device.write(&[0.5, -1.5], Duration::ZERO);
    let expected = DeviceError::OverLimit { frame: 11, value: -1.5, limit: 1.0, unit: "N" };
    assert_eq!(over, Err(expected));
    let closed = DeviceError::Closed("Strip chart".to_owned());
    assert_eq!(device.finish(), Err(closed));
    let all: Vec<_> = (0..16).map(|_| open(&chart, 1e4)).collect();
    let busy = all.into_iter().find_map(Result::err);
    assert!(matches!(busy, Some(DeviceError::Busy(_))), "{busy:?}");
}

#[test]
fn devices_are_listed_and_shown() {
    let place = Place::new();
    let library = strip(&place);
    let folder = library.parent().unwrap().to_str().unwrap();
    let ids = |list: &Value| -> Vec<String> {
        let devices = list["devices"].as_array().unwrap().iter();
        devices
            .filter(|d| d["direction"] == "output")
            .map(|d| d["id"].as_str().unwrap().to_owned())
            .collect()
    };
    let builtin = ids(&place.json(&["device", "list", "--json"]));
    assert!(builtin.contains(&"org.htex.file".to_owned()));
    let exported = place.run(&["plugin", "export", library.to_str().unwrap()]);
    assert_eq!(exported.code(), 0, "{}", exported.error());
    let found = place.json(&["device", "list", "--json", "--device-dir", folder]);
    assert_eq!(ids(&found)[0], "org.example.strip");
    assert_eq!(ids(&found)[1..], builtin);
    // The same library twice: the first is used, and a note says so.
    let named = library.to_str().unwrap();
    let twice = ["--device-file", named, "--device-dir", folder];
    let twice = place.json(&[&["device", "list", "--json"], &twice[..]].concat());
    assert_eq!(ids(&twice), ids(&found));
    assert!(twice["notes"][0].as_str().unwrap().contains("in place of"));

    let info = place.json(&["device", "info", "--json", named, "--set", "path=a.svg"]);
    assert_eq!(info["capabilities"]["limit"], 1.0);
    let text = place.run(&["device", "info", "file", "--set", "path=a.wav"]).text();
    assert!(text.contains("quantity: lateral_force, N"), "{text}");
    for (arguments, code) in [
        (&["device", "info", "no-such-device"][..], 2),
        (&["device", "check", "no-such-device"], 2),
        (&["device", "list", "--device-file", "no-such.so"], 1),
    ] {
        assert_eq!(place.run(arguments).code(), code, "{arguments:?}");
    }
}
