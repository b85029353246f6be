//! Takes: a take that leaves its target is set aside, nothing is lost, and recordings can be read
//! again.

use crate::recording;

use std::fs;

use htex_author::Exploration;
use htex_author::recording::{ReadOptions, read_recording};
use htex_lab::LabError;
use htex_lab::record::{Format, Guidance, KnownTake, Outcome, Requirements};
use recording::{RATE_HZ, Settings, record, source, sweeps, take};

#[test]
fn a_take_that_leaves_its_target_is_set_aside_and_repeated() {
    let folder = tempfile::tempdir().unwrap();
    let source = sweeps(folder.path(), &[0.6, 0.4]);
    let settings = Settings {
        target: Exploration { speed_mm_s: Some(80.0), force_n: Some(0.4) },
        ..Settings::default()
    };
    let kept = record(folder.path(), &source, &settings).unwrap();
    assert_eq!((kept.outcome, kept.number), (Outcome::Kept, 2), "{kept:?}");
    let force = kept.verdict.force_n.unwrap();
    assert!(force.min >= 0.36 && force.max <= 0.44 && (force.mean - 0.4).abs() < 0.02, "{force:?}");
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
    let first: f64 =
        all.lines().nth(1 + 8_000).unwrap().split(',').next().unwrap().parse().unwrap();
    assert_eq!((recording.samples(), recording.axes[0][0]), (8_000, first));
}

/// The finger is lifted from 3.2 s of 10 s and moves on in the air. The three sweeps before are on
/// target, but the take is refused.
#[test]
fn a_take_in_which_the_finger_is_lifted_is_set_aside() {
    let folder = tempfile::tempdir().unwrap();
    let whole = take(0.4, 10.0);
    let lifted = whole.iter().enumerate().map(|(at, row)| {
        let cells: Vec<&str> = row.split(',').collect();
        if at < (3.2 * RATE_HZ) as usize {
            row.clone()
        } else {
            format!("0,0,0,{},{}", cells[3], cells[4])
        }
    });
    let source = source(folder.path(), &[lifted.collect(), whole.clone()].concat());
    let guidance =
        Guidance { speed_mm_s: Some(80.0), force_n: Some(0.4), tolerance: 0.1, stroke_mm: 80.0 };
    let required = Requirements {
        on_target: Requirements::USUAL_ON_TARGET,
        sweeps: Requirements::usual_sweeps(&guidance, 10.0),
    };
    assert_eq!(required.sweeps, 4);
    let settings = Settings {
        seconds: 10.0,
        target: Exploration { speed_mm_s: Some(80.0), force_n: Some(0.4) },
        required,
        ..Settings::default()
    };
    let kept = record(folder.path(), &source, &settings).unwrap();
    assert_eq!((kept.outcome, kept.number), (Outcome::Kept, 2), "{kept:?}");
    let coverage = kept.verdict.coverage.unwrap();
    assert!(coverage.on_target > 0.6 && coverage.sweeps >= 6, "{coverage:?}");
    let rejected = folder.path().join("rejected/take-001.json");
    let rejected: serde_json::Value = serde_json::from_slice(&fs::read(rejected).unwrap()).unwrap();
    let verdict = &rejected["verdict"];
    let [share, sweeps] = [0, 1].map(|at| verdict["reasons"][at].as_str().unwrap());
    // The sweeps themselves are on target.
    assert_eq!(verdict["reasons"].as_array().unwrap().len(), 2, "{verdict}");
    assert!(
        share.starts_with("the finger slides on target in 2")
            && share.contains("at least 50 % is asked for")
            && share.ends_with("to 10.0 s)"),
        "{share}"
    );
    assert_eq!(sweeps, "complete sweeps: 3, at least 4 asked for");
    assert_eq!(rejected["take"]["required"]["sweeps"], 4);
}

#[test]
fn when_no_take_keeps_to_its_target_that_is_an_error_and_all_are_kept_aside() {
    let folder = tempfile::tempdir().unwrap();
    let source = sweeps(folder.path(), &[0.6, 0.6, 0.4]);
    let settings = Settings {
        target: Exploration { speed_mm_s: None, force_n: Some(0.4) },
        attempts: 2,
        ..Settings::default()
    };
    let error = record(folder.path(), &source, &settings).unwrap_err();
    assert!(matches!(error, LabError::OffTarget { attempts: 2, .. }), "{error}");
    assert!(folder.path().join("rejected/take-002.csv").exists());
}

#[test]
fn a_source_that_ends_and_a_person_who_leaves_lose_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let source = sweeps(folder.path(), &[0.4]);
    let long = Settings { seconds: 6.0, ..Settings::default() };
    let error = record(folder.path(), &source, &long).unwrap_err();
    let text = error.to_string();
    let LabError::Ended { after_s, kept: Some(kept), .. } = error else { unreachable!("{text}") };
    assert!((after_s - 4.0).abs() < 0.01 && text.contains("incomplete"), "{text}");
    assert_eq!(read_recording(&kept, &ReadOptions::default()).unwrap().samples(), 8_000);
    let left = Settings { stop_after: 80, ..Settings::default() };
    let LabError::Left { kept: Some(kept) } = record(folder.path(), &source, &left).unwrap_err()
    else {
        unreachable!("it was left")
    };
    assert!(kept.ends_with("incomplete/take-002.csv"), "{}", kept.display());
    assert!(read_recording(&kept, &ReadOptions::default()).unwrap().samples() >= 80 * 40);
    assert!(!folder.path().join("take-002.part").exists());
}

#[test]
fn formats_hold_the_same_samples() {
    let folder = tempfile::tempdir().unwrap();
    let source = sweeps(folder.path(), &[0.4]);
    let mut axes = Vec::new();
    for format in [Format::Csv, Format::Npy, Format::Wav] {
        let settings = Settings { format, ..Settings::default() };
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
    assert!(rounded(&axes[0]) == rounded(&axes[2]), "WAV has all bits of f32");
}

#[test]
fn a_take_of_this_version_has_no_other_keys() {
    let folder = tempfile::tempdir().unwrap();
    let source = sweeps(folder.path(), &[0.4]);
    let taken = record(folder.path(), &source, &Settings::default()).unwrap();
    let known = KnownTake::find(&taken.file).unwrap().unwrap();
    let beside = taken.file.with_extension("json");
    assert_eq!(known.recording, taken.file);
    assert_eq!(KnownTake::find(&beside).unwrap(), Some(known));
    let text = fs::read_to_string(&beside).unwrap();
    for (from, to, expected) in [
        (
            "\"tare\"",
            "\"rate_h\": 1, \"tare\"",
            "take: there is no key `rate_h`; did you mean `rate_hz`?",
        ),
        ("\"htex_take\": 1", "\"htex_take\": 2", "take: its version is 2, and this htex reads 1"),
    ] {
        assert!(text.contains(from), "{text}");
        fs::write(&beside, text.replace(from, to)).unwrap();
        let error = KnownTake::find(&taken.file).unwrap_err().to_string();
        assert_eq!(error, format!("{}: {expected}", beside.display()));
    }
}
