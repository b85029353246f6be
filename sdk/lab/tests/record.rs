//! Takes: nothing is lost but the current second, what leaves its target is set aside, and recordings read back.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::fs;
use std::path::{Path, PathBuf};

use htex_author::Exploration;
use htex_author::read::{ReadOptions, read_recording};
use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_format::Quantity;
use htex_lab::record::{
    Calibration, Format, Next, Outcome, Part, RecordError, Recorded, Replay, Session, Setup,
    Signals, TableTracker, TakeHeader, TrackerRows, read_part, recover,
};
use proptest::prelude::*;

const RATE_HZ: f64 = 2_000.0;

fn header(seconds: f64) -> TakeHeader {
    let newtons = |role: &str| (role.to_owned(), "N".to_owned());
    TakeHeader {
        htex_take: 1,
        name: "vinyl".to_owned(),
        number: 1,
        tool: "test".to_owned(),
        source: "test".to_owned(),
        map: None,
        calibrations: Vec::new(),
        quantity: Quantity::LateralForce,
        rate_hz: RATE_HZ,
        seconds,
        signals: ["lateral", "normal"].map(newtons).to_vec(),
        tare: Vec::new(),
        tracker: vec![("x".to_owned(), "mm".to_owned())],
        target_speed_mm_s: None,
        target_force_n: None,
        tolerance: 0.1,
        format: Format::Csv,
    }
}

/// Frames of two signals that tell their place.
fn frames(range: std::ops::Range<usize>) -> Vec<f64> {
    range.flat_map(|i| [i as f64, -(i as f64) / 3.0]).collect()
}

/// A part file of 3.5 s in pieces of these lengths, with a tracker's row for each.
fn part_file(folder: &Path, pieces: &[usize]) -> PathBuf {
    let path = folder.join("vinyl-001.part");
    let mut part = Part::create(&path, &header(10.0)).unwrap();
    let mut at = 0;
    for piece in pieces.iter().cycle() {
        let end = (at + piece).min(7_000);
        part.push_tracker(&[at as f64 / RATE_HZ, 1.0]);
        part.push(&frames(at..end)).unwrap();
        at = end;
        if at == 7_000 {
            break;
        }
    }
    path
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// A file that ends at any byte, or is damaged at any, gives the frames before, and at most a second is missing.
    #[test]
    fn a_part_file_cut_anywhere_gives_its_beginning(
        pieces in proptest::collection::vec(1_usize..600, 1..5),
        cut in 0.0..1.0_f64,
        is_cut in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = part_file(folder.path(), &pieces);
        let bytes = fs::read(&path).unwrap();
        // What a kill loses is at most a second and the piece that completes it.
        let whole = read_part(&path).unwrap().unwrap();
        prop_assert!(whole.frames() + 2_000 + 600 >= 7_000, "{}", whole.frames());
        let at = (cut * (bytes.len() - 1) as f64) as usize;
        let mut damaged = bytes.clone();
        match is_cut {
            true => damaged.truncate(at),
            false => damaged[at] ^= 0x40,
        }
        fs::write(&path, &damaged).unwrap();
        let header_end = bytes.iter().position(|b| *b == b'\n').unwrap();
        let read = match read_part(&path) {
            Ok(read) => read,
            // A damaged header says so.
            Err(error) => {
                prop_assert!(!is_cut && at <= header_end, "{error}");
                return Ok(());
            }
        };
        let Some(data) = read else {
            prop_assert!(at <= header_end);
            return Ok(());
        };
        if at <= header_end {
            return Ok(());
        }
        let all = frames(0..7_000);
        for (frame, expected) in all.chunks(2).take(data.frames()).enumerate() {
            prop_assert_eq!([data.signals[0][frame], data.signals[1][frame]], [expected[0], expected[1]]);
        }
        // Chunks before the damage are all there: each is little more than a second, and a frame takes 40 bytes at most.
        let before = (at - header_end) / 40;
        prop_assert!(data.frames() + 2_000 + 600 >= before.min(whole.frames()), "{} of {before}", data.frames());
    }
}

#[test]
fn a_killed_take_is_recovered_once_and_the_next_has_another_number() {
    let folder = tempfile::tempdir().unwrap();
    part_file(folder.path(), &[100]);
    let recovered = recover(folder.path()).unwrap();
    let [take] = &recovered[..] else {
        unreachable!("{recovered:?}")
    };
    assert_eq!(
        (take.outcome, take.number, take.recorded_s),
        (Outcome::Incomplete, 1, 3.0)
    );
    assert_eq!(take.file, folder.path().join("incomplete/vinyl-001.csv"));
    let recording = read_recording(&take.file, &ReadOptions::default()).unwrap();
    assert_eq!((recording.rate_hz, recording.samples()), (RATE_HZ, 6_000));
    assert_eq!(recording.axes[0][..3], [0.0, 1.0, 2.0]);
    assert!(recover(folder.path()).unwrap().is_empty(), "once");
    let taken = record(
        folder.path(),
        &sweeps(folder.path(), &[0.4]),
        &Settings::default(),
    )
    .unwrap();
    assert_eq!(taken.number, 1, "another name");
    let own = Settings {
        name: "vinyl",
        ..Settings::default()
    };
    let taken = record(folder.path(), &sweeps(folder.path(), &[0.4]), &own).unwrap();
    assert_eq!(taken.number, 2);
}

#[test]
fn a_take_that_another_program_records_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("vinyl-001.part");
    let mut part = Part::create(&path, &header(10.0)).unwrap();
    part.push(&frames(0..2_000)).unwrap();
    assert!(recover(folder.path()).unwrap().is_empty());
    assert!(path.exists());
    drop(part);
    assert_eq!(recover(folder.path()).unwrap().len(), 1);
    assert!(!path.exists());
}

struct Settings {
    name: &'static str,
    seconds: f64,
    tare: bool,
    target: Exploration,
    attempts: u32,
    format: Format,
    stop_after: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            name: "take",
            seconds: 4.0,
            tare: false,
            target: Exploration::default(),
            attempts: 3,
            format: Format::Csv,
            stop_after: usize::MAX,
        }
    }
}

/// A file of simulated takes of 4 s one after the other, each of this force (N) and of 80 mm/s.
fn sweeps(folder: &Path, forces_n: &[f64]) -> PathBuf {
    let path = folder.join("source.csv");
    let mut text = "fx_n,fy_n,fz_n,x_mm,y_mm\n".to_owned();
    for force_n in forces_n {
        let options = SimulationOptions::new(Surface::Vinyl)
            .with_rate_hz(RATE_HZ)
            .with_duration_s(4.0)
            .with_force_n(*force_n);
        let mut csv = Vec::new();
        simulate(&options).unwrap().write_csv(&mut csv).unwrap();
        let csv = String::from_utf8(csv).unwrap();
        for line in csv.lines().skip(2) {
            text += line.split_once(',').unwrap().1;
            text += "\n";
        }
    }
    fs::write(&path, text).unwrap();
    path
}

fn record(folder: &Path, source: &Path, settings: &Settings) -> Result<Recorded, RecordError> {
    record_with(folder, source, settings, None)
}

fn record_with(
    folder: &Path,
    source: &Path,
    settings: &Settings,
    tracker: Option<Box<dyn TrackerRows>>,
) -> Result<Recorded, RecordError> {
    let source = open(source);
    let signals = Signals::new(
        "source.csv",
        source.channels(),
        Vec::new(),
        None,
        Quantity::LateralForce,
    )?;
    let setup = Setup {
        folder: folder.to_owned(),
        name: settings.name.to_owned(),
        seconds: settings.seconds,
        countdown_s: 0.0,
        tare: settings.tare,
        quantity: Quantity::LateralForce,
        target: settings.target,
        tolerance: 0.1,
        attempts: settings.attempts,
        format: settings.format,
        tool: "test".to_owned(),
        source: "file:source.csv".to_owned(),
        map: None,
    };
    let mut session = Session::new(setup, source, signals, tracker)?;
    let mut moments = 0;
    let mut watch = |_: &_| {
        moments += 1;
        match moments > settings.stop_after {
            true => Next::Stop,
            false => Next::Go,
        }
    };
    session.record(&mut watch, &mut |_| ())
}

/// A CSV without times has the rate of the tests.
fn open(path: &Path) -> Box<dyn htex_device::Source> {
    use htex_device::{Settings, SourceAdapter};
    let given = [
        ("path", path.to_str().unwrap()),
        ("pace", "fast"),
        ("rate_hz", "2000"),
    ];
    let given = given.map(|(name, value)| (name.to_owned(), value.to_owned()));
    let settings = Settings::resolve(Replay.descriptor(), None, &given.into()).unwrap();
    Replay.open(&settings).unwrap()
}

#[test]
fn a_take_that_leaves_its_target_is_set_aside_and_repeated() {
    let folder = tempfile::tempdir().unwrap();
    let source = sweeps(folder.path(), &[0.6, 0.4]);
    let settings = Settings {
        target: Exploration {
            speed_mm_s: Some(80.0),
            force_n: Some(0.4),
        },
        ..Settings::default()
    };
    let kept = record(folder.path(), &source, &settings).unwrap();
    assert_eq!((kept.outcome, kept.number), (Outcome::Kept, 2), "{kept:?}");
    let force = kept.verdict.force_n.unwrap();
    assert!(
        force.min >= 0.36 && force.max <= 0.44 && (force.mean - 0.4).abs() < 0.02,
        "{force:?}"
    );
    assert!(kept.verdict.speed_mm_s.is_some() && kept.verdict.segments > 0);
    let rejected = folder.path().join("rejected/take-001.json");
    let rejected: serde_json::Value = serde_json::from_slice(&fs::read(rejected).unwrap()).unwrap();
    assert_eq!(rejected["outcome"], "rejected");
    let reason = rejected["verdict"]["reasons"][0].as_str().unwrap();
    assert!(
        reason.starts_with("force: mean 0.") && reason.contains("allowed is 0.3600 to 0.4400 N"),
        "{reason}"
    );
    // The kept take has the second half of the source, bit for bit.
    let recording = read_recording(&kept.file, &ReadOptions::default()).unwrap();
    let all = fs::read_to_string(&source).unwrap();
    let first: f64 = all
        .lines()
        .nth(1 + 8_000)
        .unwrap()
        .split(',')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    assert_eq!((recording.samples(), recording.axes[0][0]), (8_000, first));
}

#[test]
fn when_no_take_keeps_to_its_target_that_is_an_error_and_all_are_kept_aside() {
    let folder = tempfile::tempdir().unwrap();
    let source = sweeps(folder.path(), &[0.6, 0.6, 0.4]);
    let settings = Settings {
        target: Exploration {
            speed_mm_s: None,
            force_n: Some(0.4),
        },
        attempts: 2,
        ..Settings::default()
    };
    let error = record(folder.path(), &source, &settings).unwrap_err();
    assert!(
        matches!(error, RecordError::OffTarget { attempts: 2, .. }),
        "{error}"
    );
    assert!(folder.path().join("rejected/take-002.csv").exists());
}

#[test]
fn a_source_that_ends_and_a_person_who_leaves_lose_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let source = sweeps(folder.path(), &[0.4]);
    let long = Settings {
        seconds: 6.0,
        ..Settings::default()
    };
    let error = record(folder.path(), &source, &long).unwrap_err();
    let text = error.to_string();
    let RecordError::Ended {
        after_s,
        kept: Some(kept),
        ..
    } = error
    else {
        unreachable!("{text}")
    };
    assert!(
        (after_s - 4.0).abs() < 0.01 && text.contains("incomplete"),
        "{text}"
    );
    assert_eq!(
        read_recording(&kept, &ReadOptions::default())
            .unwrap()
            .samples(),
        8_000
    );
    let left = Settings {
        stop_after: 80,
        ..Settings::default()
    };
    let RecordError::Left { kept: Some(kept) } = record(folder.path(), &source, &left).unwrap_err()
    else {
        unreachable!("it was left")
    };
    assert!(
        kept.ends_with("incomplete/take-002.csv"),
        "{}",
        kept.display()
    );
    assert!(
        read_recording(&kept, &ReadOptions::default())
            .unwrap()
            .samples()
            >= 80 * 40
    );
    assert!(!folder.path().join("take-002.part").exists());
}

#[test]
fn formats_hold_the_same_samples() {
    let folder = tempfile::tempdir().unwrap();
    let source = sweeps(folder.path(), &[0.4]);
    let mut axes = Vec::new();
    for format in [Format::Csv, Format::Npy, Format::Wav] {
        let settings = Settings {
            format,
            ..Settings::default()
        };
        let taken = record(folder.path(), &source, &settings).unwrap();
        let value = |flag: &str| {
            let at = taken.fit.iter().position(|word| word == flag)?;
            taken.fit.get(at + 1).cloned()
        };
        let options = ReadOptions::default()
            .with_map(value("--map").map(|map| map.parse().unwrap()))
            .with_rate_hz(value("--rate").map(|rate| rate.parse::<f64>().unwrap()));
        let recording = read_recording(&taken.file, &options).unwrap();
        assert_eq!((recording.rate_hz, recording.axes.len()), (RATE_HZ, 2));
        assert!(recording.normal_n.is_some() && recording.speed_mm_s.is_some());
        axes.push(recording.axes);
    }
    assert!(axes[0] == axes[1], "CSV and NPY have all bits");
    let rounded =
        |axes: &Vec<Vec<f64>>| axes.iter().flatten().map(|v| *v as f32).collect::<Vec<_>>();
    assert!(
        rounded(&axes[0]) == rounded(&axes[2]),
        "WAV has those of f32"
    );
}

#[test]
fn tare_subtracts_the_mean_of_the_first_second_from_forces_alone() {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("source.csv");
    let mut text = "fx_n,fz_n,x_mm\n".to_owned();
    for i in 0..10_000 {
        let force = if i < 2_000 {
            [0.25, -1.5]
        } else {
            [1.25, -1.1]
        };
        text += &format!("{},{},{}\n", force[0], force[1], 7);
    }
    fs::write(&source, text).unwrap();
    let settings = Settings {
        tare: true,
        ..Settings::default()
    };
    let taken = record(folder.path(), &source, &settings).unwrap();
    let csv = fs::read_to_string(&taken.file).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("time_s,lateral_x_N,normal_N,x_mm"));
    let first: Vec<f64> = lines
        .next()
        .unwrap()
        .split(',')
        .map(|cell| cell.parse().unwrap())
        .collect();
    assert!(
        (first[1] - 1.0).abs() < 1e-12 && (first[2] - 0.4).abs() < 1e-12,
        "{first:?}"
    );
    assert_eq!((first[0], first[3]), (0.0, 7.0));
}

#[test]
fn a_tracker_is_recorded_beside_and_gives_the_speed() {
    let folder = tempfile::tempdir().unwrap();
    let source = sweeps(folder.path(), &[0.4]);
    // The positions of the source at 60 Hz, as a tracker of its own.
    let all = fs::read_to_string(&source).unwrap();
    let (mut forces, mut track) = (
        "fx_n,fy_n,fz_n\n".to_owned(),
        "time_ms,x_mm,y_mm\n".to_owned(),
    );
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
        target: Exploration {
            speed_mm_s: Some(80.0),
            force_n: Some(0.4),
        },
        ..Settings::default()
    };
    let error = record(folder.path(), &source, &settings).unwrap_err();
    assert!(
        matches!(error, RecordError::NotMeasured { what: "speed", .. }),
        "{error}"
    );
    let tracker = TableTracker::open(&tracker, None).unwrap();
    let taken = record_with(folder.path(), &source, &settings, Some(Box::new(tracker))).unwrap();
    let speed = taken.verdict.speed_mm_s.unwrap();
    assert!((speed.mean - 80.0).abs() < 4.0, "{speed:?}");
    let beside = folder.path().join("tracker/take-001.csv");
    assert!(
        fs::read_to_string(&beside)
            .unwrap()
            .starts_with("time_s,x_mm,y_mm\n0,")
    );
    assert_eq!(taken.fit.last(), Some(&beside.display().to_string()));
    let options = ReadOptions::default().with_tracker(htex_author::read::Tracker::new(beside));
    assert!(
        read_recording(&taken.file, &options)
            .unwrap()
            .speed_mm_s
            .is_some()
    );
}

#[test]
fn two_calibrated_sensors_are_summed_by_the_map() {
    use htex_device::Channel;
    let channels: Vec<Channel> = (0..13)
        .map(|i| Channel::new(format!("ai{i}"), "V"))
        .collect();
    let scaled = |factor: f64| {
        let row = |i: usize| {
            (0..6)
                .map(|k| {
                    if i == k {
                        factor.to_string()
                    } else {
                        "0".to_owned()
                    }
                })
                .collect::<Vec<_>>()
                .join(",")
        };
        let text: Vec<String> = (0..6).map(row).collect();
        Calibration::parse(Path::new("a.csv"), &text.join("\n")).unwrap()
    };
    let map = "lateral_x=fx1+fx2,lateral_y=fy1+fy2,normal=-(fz1+fz2),x=ai12:10"
        .parse()
        .unwrap();
    let signals =
        |sensors, map| Signals::new("Dev1", &channels, sensors, map, Quantity::LateralForce);
    let both = signals(vec![scaled(2.0), scaled(3.0)], Some(&map)).unwrap();
    assert!(both.warnings().is_empty(), "{:?}", both.warnings());
    let frame: Vec<f64> = (1..=13).map(f64::from).collect();
    assert_eq!(
        both.values(&frame),
        [[2.0 + 21.0], [4.0 + 24.0], [-(6.0 + 27.0)], [130.0]]
    );
    let one = signals(vec![scaled(2.0)], None).unwrap();
    assert_eq!(
        one.values(&frame),
        [[2.0], [4.0], [6.0]],
        "forces by their names"
    );
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
        let error = Calibration::parse(Path::new("bad.csv"), bad)
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("bad.csv: ") && error.contains(what),
            "{error}"
        );
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
            &toml
                .replace("1.0", "1.5")
                .replace(",0", ",0.0")
                .replace("[0,", "[0.0,")
        )
        .is_ok()
    );
}
