//! Part files: only the current second can be lost, however a take ends.

use crate::recording;

use std::fs;
use std::path::{Path, PathBuf};

use htex_author::recording::{ReadOptions, read_recording};
use htex_format::Quantity;
use htex_lab::record::{Format, Outcome, PartFile, Requirements, TakeHeader, read_part, recover};
use proptest::prelude::*;
use recording::{RATE_HZ, Settings, record, sweeps};

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
        required: Requirements::NOTHING,
        format: Format::Csv,
    }
}

/// Frames of two signals whose values give their position.
fn frames(range: std::ops::Range<usize>) -> Vec<f64> {
    range.flat_map(|i| [i as f64, -(i as f64) / 3.0]).collect()
}

/// A part file of 3.5 s in pieces of these lengths, with a tracker's row for each.
fn part_file(folder: &Path, pieces: &[usize]) -> PathBuf {
    let path = folder.join("vinyl-001.part");
    let mut part = PartFile::create(&path, &header(10.0)).unwrap();
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

    /// A file that ends at any byte, or is damaged at any byte, gives the frames before that. At
    /// most a second is missing.
    #[test]
    fn a_part_file_cut_anywhere_gives_its_beginning(
        pieces in proptest::collection::vec(1_usize..600, 1..5),
        cut in 0.0..1.0_f64,
        is_cut in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = part_file(folder.path(), &pieces);
        let bytes = fs::read(&path).unwrap();
        // A kill loses at most a second and the piece that completes it.
        let whole = read_part(&path).unwrap().unwrap();
        prop_assert!(whole.frames() + 2_000 + 600 >= 7_000, "{}", whole.frames());
        let at = (cut * (bytes.len() - 1) as f64) as usize;
        let mut damaged = bytes.clone();
        if is_cut { damaged.truncate(at) } else { damaged[at] ^= 0x40 }
        fs::write(&path, &damaged).unwrap();
        let header_end = bytes.iter().position(|b| *b == b'\n').unwrap();
        let read = match read_part(&path) {
            Ok(read) => read,
            // A damaged header is reported.
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
        // All chunks before the damage can be read. Each is little more than a second, and a frame
        // takes 40 bytes at most.
        let before = (at - header_end) / 40;
        prop_assert!(data.frames() + 2_000 + 600 >= before.min(whole.frames()), "{} of {before}", data.frames());
    }
}

#[test]
fn a_killed_take_is_recovered_once_and_the_next_has_another_number() {
    let folder = tempfile::tempdir().unwrap();
    part_file(folder.path(), &[100]);
    let recovered = recover(folder.path()).unwrap();
    let [take] = &recovered[..] else { unreachable!("{recovered:?}") };
    assert_eq!((take.outcome, take.number, take.recorded_s), (Outcome::Incomplete, 1, 3.0));
    assert_eq!(take.file, folder.path().join("incomplete/vinyl-001.csv"));
    let recording = read_recording(&take.file, &ReadOptions::default()).unwrap();
    assert_eq!((recording.rate_hz, recording.samples()), (RATE_HZ, 6_000));
    assert_eq!(recording.axes[0][..3], [0.0, 1.0, 2.0]);
    assert!(recover(folder.path()).unwrap().is_empty(), "once");
    let taken =
        record(folder.path(), &sweeps(folder.path(), &[0.4]), &Settings::default()).unwrap();
    assert_eq!(taken.number, 1, "another name");
    let own = Settings { name: "vinyl", ..Settings::default() };
    let taken = record(folder.path(), &sweeps(folder.path(), &[0.4]), &own).unwrap();
    assert_eq!(taken.number, 2);
}

#[test]
fn a_take_that_another_program_records_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("vinyl-001.part");
    let mut part = PartFile::create(&path, &header(10.0)).unwrap();
    part.push(&frames(0..2_000)).unwrap();
    assert!(recover(folder.path()).unwrap().is_empty());
    assert!(path.exists());
    drop(part);
    assert_eq!(recover(folder.path()).unwrap().len(), 1);
    assert!(!path.exists());
}

#[test]
fn a_part_file_that_is_not_ours_is_refused_or_recovered_in_its_folder_alone() {
    use serde_json::{Value, json};
    let outer = tempfile::tempdir().unwrap();
    let folder = outer.path().join("takes");
    fs::create_dir(&folder).unwrap();
    let path = part_file(&folder, &[100]);
    // Rows and frames that are not numbers, after whole ones.
    let whole = fs::read(&path).unwrap();
    let end = whole.iter().position(|b| *b == b'\n').unwrap();
    fs::remove_file(&path).unwrap();
    let mut part = PartFile::create(&path, &header(10.0)).unwrap();
    part.push_tracker(&[f64::NAN, 1.0, 0.5, f64::INFINITY, 0.1, 2.0, 0.1, 3.0]);
    part.push(&[f64::NAN, 0.4]).unwrap();
    part.flush().unwrap();
    drop(part);
    let odd = fs::read(&path).unwrap();
    let odd = &odd[odd.iter().position(|b| *b == b'\n').unwrap()..];
    let first: Value = serde_json::from_slice(&whole[..end]).unwrap();
    let values = [
        json!(null),
        json!(-1),
        json!(0),
        json!(0.3),
        json!(1e308),
        json!(5_000_000_000_u64),
        json!(""),
        json!("../../vinyl"),
        json!("a\u{1b}[2J\n"),
        json!("wav"),
        json!([]),
        json!([["lateral", "N"], ["lateral", "N"]]),
        json!([["time", "s"]]),
        json!([["speed", "mm/s"], ["x", "mm"]]),
        json!([["lateral", "N,\n=x"]]),
        json!(vec![["normal", "N"]; 70_000]),
    ];
    let mut recovered = 0;
    for key in first.as_object().unwrap().keys() {
        for value in &values {
            for chunks in [&whole[end..], &[&whole[end..], odd].concat()] {
                let mut header = first.clone();
                header[key] = value.clone();
                fs::write(&path, [header.to_string().as_bytes(), chunks].concat()).unwrap();
                match recover(&folder) {
                    Ok(takes) => recovered += takes.len(),
                    Err(error) => {
                        let text = error.to_string();
                        assert!(!text.contains(char::is_control), "{text:?}");
                        assert!(path.exists(), "{key} {value}: it stays");
                        fs::remove_file(&path).unwrap();
                    }
                }
                assert!(!path.exists());
                let beside = fs::read_dir(outer.path()).unwrap().count();
                assert_eq!(beside, 1, "{key} {value}: a file outside of the folder");
            }
        }
    }
    assert!(recovered > 50, "{recovered}");
}
