//! Readers of recordings: which files they accept, and errors with file, line and column.

use crate::common::files;

use files::{Folder, at, has_warning, mapped, npy, npy_header, read, spec, wav};
use htex_recording::Recording;
use htex_recording::read_response;
use htex_recording::{ColumnMap, ReadOptions, read_trace};
use proptest::prelude::*;

#[test]
fn two_axes_time_and_position_by_name() {
    let mut text = String::from("\u{feff}# Simulated\r\nt_s,fx_n,fy_mN,fz_n,x_mm,y_mm\r\n");
    for sample in 0..200 {
        let t = f64::from(sample) / 1000.0;
        text += &format!("{t:.3},0.1,200,-0.4,{:.4},{:.4}\r\n", 3.0 * t, 4.0 - 4.0 * t);
    }
    let recording = read("a.csv", text, &ReadOptions::default()).unwrap();
    assert_eq!((recording.source.as_str(), recording.rate_hz), ("a.csv", 1000.0));
    assert_eq!((recording.samples(), recording.duration_s()), (200, 0.2));
    assert_eq!(recording.axes, [[0.1; 200], [0.2; 200]]);
    assert_eq!(recording.normal_n, Some(vec![0.4; 200]), "pressing reads positive");
    assert!(recording.speed_mm_s.unwrap().iter().all(|speed| (speed - 5.0).abs() < 0.2));
    assert!(recording.simulated);
    assert_eq!(recording.warnings, [""; 0]);
}

#[test]
fn volts_need_a_map_and_the_message_gives_it() {
    let text = "lateral_V,normal_V\n1,2\n3,4\n";
    let error = read("v.csv", text, &at(10_000.0)).unwrap_err();
    assert!(error.contains("map it with its scale to N: lateral=lateral_V:SCALE"), "{error}");
    let options = mapped("lateral=lateral_V:0.4444,normal=#2:0.31", Some(10_000.0));
    let recording = read("v.csv", text, &options).unwrap();
    assert_eq!(recording.axes, [[0.4444, 3.0 * 0.4444]]);
    assert_eq!(recording.normal_n, Some(vec![2.0 * 0.31, 4.0 * 0.31]));
    let half = read("v.csv", text, &mapped("lateral=LATERAL_v:1", Some(1e4))).unwrap();
    assert_eq!(half.normal_n, None);
    assert!(has_warning(&half, "normal=normal_V:SCALE"));
}

#[test]
fn units_left_unsaid_are_assumed_aloud() {
    let text = "speed,force,accel,friction\n80,0.4,9,0.1\n81,0.5,9,0.2\n";
    let recording = read("k.csv", text, &at(1000.0)).unwrap();
    assert_eq!(recording.axes, [[0.1, 0.2]]);
    assert_eq!(recording.speed_mm_s, Some(vec![80.0, 81.0]));
    assert!(has_warning(&recording, "\"speed\" (speed) has no unit; mm/s is assumed"));
    assert!(has_warning(&recording, "Columns not used: accel."));
    assert!(
        read("k.csv", text, &ReadOptions::default())
            .unwrap_err()
            .contains("no sample rate; give one")
    );
    let in_metres = text.replace("speed", "speed [m/s]");
    let recording = read("k.csv", in_metres, &at(1000.0)).unwrap();
    assert_eq!(recording.speed_mm_s, Some(vec![80_000.0, 81_000.0]));
}

#[test]
fn delimiters_comments_quotes_and_headerless_files() {
    let same = [1.0, -2.5e-3];
    for text in [
        "fy_n;note\n1;x\n\n# rest\n-2.5e-3;y",
        "\"fy_n\"\t\"a\tb\"\n\"1\"\t\"p\tq\"\n -2.5e-3\t\n",
        "fy_n  z\n1  2\n  -2.5e-3 3\n",
        "# fy_n, z\n1,2\n-2.5e-3,3\n",
        "1\n-2.5e-3\n",
    ] {
        let recording =
            read("d.csv", text, &at(100.0)).unwrap_or_else(|error| panic!("{text:?}: {error}"));
        assert_eq!(recording.axes, [same], "{text:?}");
    }
    assert!(
        read("h.csv", "1,2\n3,4\n", &at(100.0))
            .unwrap_err()
            .contains("map columns by number, as in lateral=#2")
    );
    let by_number = read("h.csv", "1,2\n3,4\n", &mapped("lateral=#2:2", Some(100.0))).unwrap();
    assert_eq!(by_number.axes, [[4.0, 8.0]]);
}

#[test]
fn broken_text_is_refused_where_it_breaks() {
    let long = format!("fy_n,z\n1,2\n{}\n", "1".repeat(70_000));
    let cases: [(&[u8], &str); 16] = [
        (b"", "holds no data"),
        (b"\n# only a comment\n", "holds no data"),
        (b"fy_n,z\n", "0 row(s)"),
        (b"fy_n,z\n1,2\n", "1 row(s)"),
        (b"fy_n,z\n1,2\n\n#\nabc,2\n", "line 5, column \"fy_n\": \"abc\" is not a number"),
        (b"fy_n,z\n1,2\nNaN,2\n", "line 3, column \"fy_n\": \"NaN\" is not finite"),
        (b"fy_n,z\n1,2\n1e999,2\n", "is not finite"),
        (b"fy_n,z\n1,2\n,2\n", "line 3, column \"fy_n\": the cell is empty"),
        (b"fy_n;z\n1;2\n0,5;2\n", "decimal comma"),
        (b"fy_n,z\n1,2\n1\n1,2\n", "line 3: 1 cells where the first row has 2"),
        (b"fy_n,z\n1,2\n1,2,3\n", "line 3: 3 cells"),
        (b"fy_n,z\n1,2\n1,2\n1", "line 4: the file seems truncated"),
        (b"fy_n,z\n1,2\n1,\0\n", "line 3: a NUL byte"),
        (b"fy_n,z\n1,2\n1,\xff\n", "line 3: a byte sequence that is not UTF-8"),
        (b"a,b\n1,2\n1,2\n", "the columns are: a, b"),
        (long.as_bytes(), "line 3: 70000 bytes in one line"),
    ];
    for (bytes, words) in cases {
        let error = read("bad.csv", bytes, &at(100.0)).unwrap_err();
        assert!(error.starts_with("bad.csv") && error.contains(words), "{error}");
    }
}

#[test]
fn columns_that_could_be_either_are_asked_for() {
    let twice = "force,fz_n,fy_n\n1,2,3\n1,2,3\n";
    assert!(
        read("m.csv", twice, &at(9.0))
            .unwrap_err()
            .contains("map one of them, as in normal=COLUMN")
    );
    let chosen = read("m.csv", twice, &mapped("normal=force:2", Some(9.0))).unwrap();
    assert_eq!(chosen.normal_n, Some(vec![2.0, 2.0]));
    let absent = read("m.csv", twice, &mapped("lateral=nix", Some(9.0))).unwrap_err();
    assert!(absent.contains("\"nix\"") && absent.contains("force, fz_n, fy_n"), "{absent}");
    let same = read("m.csv", twice, &mapped("lateral=fy_n,normal=#3", Some(9.0))).unwrap_err();
    assert!(same.contains("twice"), "{same}");
    for map in [
        "",
        "lateral",
        "drag=a",
        "lateral=",
        "lateral=#0",
        "lateral=a:0",
        "lateral=a:x",
        "lateral=a,lateral=b",
        "lateral=a,normal=a",
        "lateral=a,lateral_x=b",
    ] {
        assert!(map.parse::<ColumnMap>().is_err(), "{map}");
    }
}

#[test]
fn the_time_column_gives_the_rate_or_says_why_not() {
    let table = |times: &[&str]| {
        times.iter().fold(String::from("t_ms,fy_n\n"), |text, time| text + time + ",0.1\n")
    };
    let even = table(&["0", "0.5", "1.0", "1.5"]);
    assert_eq!(read("t.csv", &even, &ReadOptions::default()).unwrap().rate_hz, 2000.0);
    let other = read("t.csv", &even, &at(1000.0)).unwrap();
    assert_eq!(other.rate_hz, 1000.0);
    assert!(has_warning(&other, "2000 Hz, the given rate is 1000 Hz"));
    let gap =
        read("t.csv", table(&["0", "1", "2", "3", "7", "8"]), &ReadOptions::default()).unwrap();
    assert_eq!(gap.rate_hz, 1000.0);
    let found = |recording: &Recording, code: &str, words: &str| {
        let mut findings = recording.clock_findings.iter();
        findings.any(|f| f.code == code && f.message.contains(words))
    };
    assert!(found(&gap, "RECORDING_CLOCK_GAP", "ends on line 6"));
    let jitter =
        read("t.csv", table(&["0", "1", "2.1", "3", "4"]), &ReadOptions::default()).unwrap();
    assert!(found(&jitter, "RECORDING_CLOCK_JITTER", "uneven"));
    let back = table(&["0", "1", "1", "2"]);
    assert!(
        read("t.csv", &back, &ReadOptions::default()).unwrap_err().contains("line 4: the time")
    );
    assert!(has_warning(&read("t.csv", &back, &at(1000.0)).unwrap(), "instead of the time column"));
}

#[test]
fn jitter_does_not_move_the_rate() {
    // Timestamps of a busy computer: in order, but late by up to a whole period.
    let mut state = 1u32;
    let mut text = String::from("t_s,fy_n\n");
    let mut last = -1.0;
    for sample in 0..5_000 {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let late = f64::from(state >> 8) / f64::from(1u32 << 24);
        last = f64::max(last + 1e-6, (f64::from(sample) + late) / 1000.0);
        text += &format!("{last:.6},0.1\n");
    }
    let recording = read("j.csv", text, &ReadOptions::default()).unwrap();
    assert!((recording.rate_hz - 1000.0).abs() < 0.5, "{}", recording.rate_hz);
    assert_eq!(recording.clock_findings.len(), 1);
    assert_eq!(recording.clock_findings[0].code, "RECORDING_CLOCK_JITTER");
}

#[test]
fn setup_response_is_read_unwrapped_and_held_at_its_ends() {
    let folder = Folder::new();
    let path = folder.put("h.csv", "frequency_hz,magnitude,phase_rad\n10,1,3\n20,2,-3\n40,1,-3\n");
    let response = read_response(&path).unwrap();
    let (re, im) = response.value_at(15.0);
    let middle = 1.5_f64;
    assert!((re.hypot(im) - middle).abs() < 1e-12);
    assert!((re + middle).abs() < 1e-12, "half way from 3 to 2 pi - 3 is pi");
    assert_eq!(response.value_at(1.0), response.value_at(10.0));
    assert_eq!(response.value_at(99.0), response.value_at(40.0));
    for (text, words) in [
        ("frequency_hz,magnitude\n10,1\n10,1\n", "line 3: the frequency 10 Hz follows 10 Hz"),
        ("frequency_hz,magnitude\n10,1\n20,-1\n", "line 3: the magnitude -1 is negative"),
        ("frequency_hz,magnitude\n10,1\n", "1 row(s)"),
        ("f,magnitude\n10,1\n20,1\n", "\"frequency_hz\""),
    ] {
        let error = read_response(&folder.put("bad.csv", text)).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Damaged files of every kind give a recording or an error, never a panic.
    #[test]
    fn damage_never_panics(kind in 0..3_usize, cut in 0..200_usize, edits in prop::collection::vec((0..200_usize, any::<u8>()), 0..6)) {
        let (name, mut bytes) = [
            ("x.csv", b"t_s,fx_n,fy_n\n0.000,1,2\n0.001,3,4\n0.002,5,\"6\"\n".to_vec()),
            ("x.wav", wav(spec(2, 24), &[0.25; 20])),
            ("x.npy", npy(&npy_header("<f4", "True", "(2, 2)"), &[0; 16])),
        ][kind].clone();
        for (place, byte) in edits {
            let length = bytes.len();
            bytes[place % length] = byte;
        }
        bytes.truncate(cut.max(8));
        let _ = read(name, bytes, &at(44_100.0));
    }
}

#[test]
fn a_trace_is_known_by_names_and_units_and_refused_with_its_line() {
    let folder = Folder::new();
    let trace = |text: &str| read_trace(&folder.put("hand.csv", text));
    let text = "time [ms];Y_mm;x_mm;fz_mN;speed_cm_s;mood\n10;1;2;400;8;0\n20;3;4;500;9;0\n";
    let read = trace(text).unwrap();
    assert_eq!(read.t_s, [0.01, 0.02]);
    assert_eq!((read.x_mm, read.y_mm), (vec![2.0, 4.0], vec![1.0, 3.0]));
    assert_eq!(read.force_n, [0.4, 0.5]);
    assert_eq!(read.speed_mm_s, Some(vec![80.0, 90.0]));
    assert_eq!(read.warnings, ["Columns not used: mood."]);
    let refusals = [
        ("t_s,x_mm,y_mm\n0,0,0\n1,1,1\n", "there is no column for normal"),
        ("t_s,x_mm,y_mm,fz_V\n0,0,0,1\n1,1,1,1\n", "not in a unit known for normal"),
        ("t_s,x_mm,y_mm,fz_n\n0,0,0,1\n1,1,1,1\n1,1,1,1\n", "line 4: the time after 1 s is 1 s"),
        ("t_s,x_mm,x_cm,y_mm,fz_n\n0,0,0,0,1\n1,1,1,1,1\n", "both match x; keep one"),
        ("0,0,0,1\n1,1,1,1\n", "no header row"),
        ("t_s,x_mm,y_mm,fz_n\n0,0,0,1\n1,one,1,1\n", "line 3, column \"x_mm\""),
    ];
    for (text, expected) in refusals {
        let error = trace(text).unwrap_err().to_string();
        assert!(error.contains(expected), "{text:?}: {error}");
    }
}
