//! From channels to recorded signals: calibration, map, tare, tracker.

use crate::recording;

use std::fs;
use std::path::Path;

use htex_author::Exploration;
use htex_author::recording::{ReadOptions, read_recording};
use htex_format::Quantity;
use htex_lab::LabError;
use htex_lab::record::{Calibration, Signals, TableTracker, Tare};
use recording::{RATE_HZ, Settings, record, record_with, sweeps};

#[test]
fn tare_subtracts_the_mean_of_the_first_second_from_forces_alone() {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("source.csv");
    let mut text = "fx_n,fz_n,x_mm\n".to_owned();
    for i in 0..10_000 {
        let force = if i < 2_000 { [0.25, -1.5] } else { [1.25, -1.1] };
        text += &format!("{},{},{}\n", force[0], force[1], 7);
    }
    fs::write(&source, text).unwrap();
    let settings = Settings { tare: Tare::Once, ..Settings::default() };
    let taken = record(folder.path(), &source, &settings).unwrap();
    let csv = fs::read_to_string(&taken.file).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("time_s,lateral_x_N,normal_N,x_mm"));
    let first: Vec<f64> =
        lines.next().unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
    assert!((first[1] - 1.0).abs() < 1e-12 && (first[2] - 0.4).abs() < 1e-12, "{first:?}");
    assert_eq!((first[0], first[3]), (0.0, 7.0));
}

#[test]
fn a_sensor_that_drifts_is_tared_before_each_take() {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("source.csv");
    // A second without a finger, then a take that presses too hard. After a drift, both again with
    // the right force.
    let parts = [(2_000, 0.25), (8_000, 0.25 + 0.8), (2_000, -0.5), (8_000, -0.5 + 0.4)];
    let lines: String = parts.map(|(rows, force_n)| format!("0,{force_n}\n").repeat(rows)).concat();
    fs::write(&source, format!("fx_n,fz_n\n{lines}")).unwrap();
    let settings = |tare| Settings {
        tare,
        target: Exploration { speed_mm_s: None, force_n: Some(0.4) },
        attempts: 2,
        ..Settings::default()
    };
    let taken = record(folder.path(), &source, &settings(Tare::Each)).unwrap();
    let force = taken.verdict.force_n.unwrap();
    assert_eq!(taken.number, 2);
    assert!((force.min - 0.4).abs() < 1e-9 && (force.max - 0.4).abs() < 1e-9, "{force:?}");
    let rejected = folder.path().join("rejected/take-001.json");
    let rejected: serde_json::Value = serde_json::from_slice(&fs::read(rejected).unwrap()).unwrap();
    let offsets = [&rejected["take"]["tare"][1], &rejected["verdict"]["force_n"]["mean"]]
        .map(|value| (value.as_f64().unwrap() * 1e9).round() / 1e9);
    assert_eq!(offsets, [0.25, 0.8]);
    let once = record(folder.path(), &source, &settings(Tare::Once));
    assert!(matches!(once, Err(LabError::OffTarget { .. })), "{once:?}");
}

#[test]
fn a_tracker_is_recorded_beside_and_gives_the_speed() {
    let folder = tempfile::tempdir().unwrap();
    let source = sweeps(folder.path(), &[0.4]);
    // The positions of the source at 60 Hz, as a tracker of its own.
    let all = fs::read_to_string(&source).unwrap();
    let (mut forces, mut track) = ("fx_n,fy_n,fz_n\n".to_owned(), "time_ms,x_mm,y_mm\n".to_owned());
    let mut next_s = 0.0;
    for (row, line) in all.lines().skip(1).enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        forces += &(cells[..3].join(",") + "\n");
        let at_s = row as f64 / RATE_HZ;
        if at_s >= next_s {
            track += &format!("{},{},{}\n", 1e3 * at_s, cells[3], cells[4]);
            next_s += 1.0 / 60.0;
        }
    }
    fs::write(&source, forces).unwrap();
    let tracker = folder.path().join("track.csv");
    fs::write(&tracker, track).unwrap();
    let settings = Settings {
        target: Exploration { speed_mm_s: Some(80.0), force_n: Some(0.4) },
        ..Settings::default()
    };
    let error = record(folder.path(), &source, &settings).unwrap_err();
    assert!(matches!(error, LabError::NotMeasured { what: "speed", .. }), "{error}");
    let tracker = TableTracker::open(&tracker, None).unwrap();
    let taken = record_with(folder.path(), &source, &settings, Some(Box::new(tracker))).unwrap();
    let speed = taken.verdict.speed_mm_s.unwrap();
    assert!((speed.mean - 80.0).abs() < 4.0, "{speed:?}");
    let beside = folder.path().join("tracker/take-001.csv");
    assert!(fs::read_to_string(&beside).unwrap().starts_with("time_s,x_mm,y_mm\n0,"));
    assert_eq!(taken.fit.last(), Some(&beside.display().to_string()));
    let options = ReadOptions::default().with_tracker(htex_author::recording::Tracker::new(beside));
    assert!(read_recording(&taken.file, &options).unwrap().speed_mm_s.is_some());
}

#[test]
fn two_calibrated_sensors_are_summed_by_the_map() {
    use htex_device::Channel;
    let channels: Vec<Channel> = (0..13).map(|i| Channel::new(format!("ai{i}"), "V")).collect();
    let scaled = |factor: f64| {
        let row = |i: usize| {
            (0..6)
                .map(|k| if i == k { factor.to_string() } else { "0".to_owned() })
                .collect::<Vec<_>>()
                .join(",")
        };
        let text: Vec<String> = (0..6).map(row).collect();
        Calibration::parse(Path::new("a.csv"), &text.join("\n")).unwrap()
    };
    let map = "lateral_x=fx1+fx2,lateral_y=fy1+fy2,normal=-(fz1+fz2),x=ai12:10".parse().unwrap();
    let signals =
        |sensors, map| Signals::new("Dev1", &channels, sensors, map, Quantity::LateralForce);
    let both = signals(vec![scaled(2.0), scaled(3.0)], Some(&map)).unwrap();
    assert!(both.warnings().is_empty(), "{:?}", both.warnings());
    let frame: Vec<f64> = (1..=13).map(f64::from).collect();
    assert_eq!(both.values(&frame), [[2.0 + 21.0], [4.0 + 24.0], [-(6.0 + 27.0)], [130.0]]);
    let one = signals(vec![scaled(2.0)], None).unwrap();
    assert_eq!(one.values(&frame), [[2.0], [4.0], [6.0]], "forces by their names");
    let error = signals(Vec::new(), None).unwrap_err().to_string();
    assert!(error.contains("ai0"), "{error}");
    for (bad, what) in [
        ("1,2\n", "1 rows"),
        ("a\n", "line 1"),
        (
            "1,1,1,1,1,1\n1,1,1,1,1,1\n1,1,1,1,1,1\n1,1,1,1,1,1\n1,1,1,1,1,1\n1,1,1,1,1,1\n",
            "singular",
        ),
    ] {
        let error = Calibration::parse(Path::new("bad.csv"), bad).unwrap_err().to_string();
        assert!(error.starts_with("bad.csv: ") && error.contains(what), "{error}");
    }
    let toml = format!(
        "matrix = [{}]",
        [
            "[1.0,0,0,0,0,0]",
            "[0,1.0,0,0,0,0]",
            "[0,0,1.0,0,0,0]",
            "[0,0,0,1.0,0,0]",
            "[0,0,0,0,1.0,0]",
            "[0,0,0,0,0,1.0]"
        ]
        .join(",")
    );
    assert!(
        Calibration::parse(
            Path::new("a.toml"),
            &toml.replace("1.0", "1.5").replace(",0", ",0.0").replace("[0,", "[0.0,")
        )
        .is_ok()
    );
}
