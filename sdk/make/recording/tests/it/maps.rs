//! Column maps with expressions, and motions from a tracker.

use crate::common::files;

use files::{Folder, has_warning, mapped, npy, npy_header, read, spec, wav};
use htex_recording::Recording;
use htex_recording::{ColumnMap, ReadOptions, Tracker, read_recording};
use proptest::prelude::*;

const TABLE: &str = "a,b,Fx [m/s],a-b,5V\n1,2,4,8,16\n-3,5,7,11,13\n";

fn lateral(expression: &str) -> Result<Vec<f64>, String> {
    let map =
        format!("lateral={expression}").parse::<ColumnMap>().map_err(|error| error.to_string())?;
    let options = ReadOptions::default().with_rate_hz(1000.0).with_map(map);
    let recording = read("t.csv", TABLE, &options)?;
    Ok(recording.axes.into_iter().next().unwrap())
}

#[test]
fn expressions_compute_with_columns() {
    let cases: [(&str, [f64; 2]); 18] = [
        ("a+b", [3.0, 2.0]),
        ("-a*0.5", [-0.5, 1.5]),
        ("(a-b)/2*9.81e-3", [-0.5 * 9.81e-3, -4.0 * 9.81e-3]),
        ("a - b", [-1.0, -8.0]),
        // The whole text is the name of a column; quotes or parentheses say which of the two is
        // meant.
        ("a-b", [8.0, 11.0]),
        ("\"a-b\"*1", [8.0, 11.0]),
        ("(a)-b", [-1.0, -8.0]),
        ("'a-b':0.5", [4.0, 5.5]),
        ("#1+#2*#3", [9.0, 32.0]),
        ("A+B", [3.0, 2.0]),
        ("Fx [m/s]/2", [2.0, 3.5]),
        ("2*(a+b)*(a+b)", [18.0, 8.0]),
        ("8/4/2*a", [1.0, -3.0]),
        ("1-2-a", [-2.0, 2.0]),
        ("--a+-+b", [-1.0, -8.0]),
        ("5V*1", [16.0, 13.0]),
        (".5e1*a", [5.0, -15.0]),
        ("a+b:-2", [-6.0, -4.0]),
    ];
    for (expression, expected) in cases {
        assert_eq!(lateral(expression), Ok(expected.to_vec()), "{expression}");
    }
}

#[test]
fn malformed_expressions_are_refused_where_they_break() {
    let deep = format!("{}a{}", "(".repeat(40), ")".repeat(40));
    let long = vec!["a"; 400].join("+");
    for (expression, words) in [
        ("(a+b", "character 9: '(' is not closed"),
        ("a+b)", "character 12: ')' closes nothing"),
        ("a+*b", "character 11: a number or a column is missing before this"),
        ("a+", "a number or a column is missing at the end"),
        ("2 a", "character 11: an operator is missing before this"),
        ("\"a", "character 9: the quote \" is not closed"),
        ("#x+a", "character 9: \"#x\" is not a column number"),
        ("1e999*a", "character 9: the number is larger"),
        ("a:b", "character 10: what follows is not a scale"),
        ("a:1:2", "character 10: a second ':'"),
        ("a=b", "character 10: a second '='"),
        ("a+c", "the map's column \"c\" does not exist"),
        ("a/0", "line 2, column \"a/0\": the expression is inf there"),
        ("#9+a", "the map's column #9 does not exist"),
        ("", "character 8: a column name is missing"),
        (&deep, "more than 32"),
        (&long, "more than 256"),
    ] {
        let error = lateral(expression).unwrap_err();
        assert!(error.contains(words), "{expression}: {error}");
    }
}

#[test]
fn units_of_an_expression_are_those_of_the_role() {
    let text = "fx1_mN,fx2_mN\n1,2\n3,4\n";
    let sum = read("u.csv", text, &mapped("lateral_x=fx1_mN+fx2_mN", Some(100.0))).unwrap();
    assert_eq!(sum.axes, [[3.0, 7.0]]);
    assert!(has_warning(&sum, "taken to be in N, but column \"fx1_mN\" has another unit"));
    for map in ["lateral_x=(fx1_mN+fx2_mN)*1e-3", "lateral_x=fx1_mN+fx2_mN:1e-3"] {
        let scaled = read("u.csv", text, &mapped(map, Some(100.0))).unwrap();
        assert_eq!((&scaled.axes[..], scaled.warnings.len()), (&[vec![3e-3, 7e-3]][..], 0));
    }
}

#[test]
fn channels_of_a_wav_are_chosen_by_a_map() {
    let bytes = wav(spec(4, 16), &[0.5, 0.25, 0.125, -0.5, 0.0, 0.5, -0.125, 0.25]);
    let options = mapped("lateral=ch2*2-#4,normal=ch3:8", None);
    let recording = read("w.wav", &bytes, &options).unwrap();
    assert_eq!(recording.axes, [[1.0, 0.75]]);
    assert_eq!(recording.normal_n, Some(vec![1.0, -1.0]));
    assert_eq!(recording.rate_hz, 44_100.0);
    assert_eq!(recording.warnings, ["Columns not used: ch1."]);
}

#[test]
fn columns_of_an_array_are_chosen_by_a_map() {
    let rows = [1.0_f64, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
    let columns = [1.0_f64, 5.0, 2.0, 6.0, 3.0, 7.0, 4.0, 8.0];
    let bytes = |values: &[f64]| values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    for (order, values) in [("False", rows), ("True", columns)] {
        let file = npy(&npy_header("<f8", order, "(2, 4)"), &bytes(&values));
        let options = mapped("lateral=#4-#1,normal=ch3:2", Some(1000.0));
        let recording = read("n.npy", file, &options).unwrap();
        assert_eq!(
            (&recording.axes[0][..], &recording.normal_n),
            (&[3.0, 3.0][..], &Some(vec![6.0, 14.0]))
        );
    }
}

/// A recording of 2 s at 1 kHz whose clock begins at 100 s, with a tracker's file.
fn tracked(tracker: &str, map: Option<&str>, header: &str) -> Result<Recording, String> {
    let folder = Folder::new();
    let rows = (0..2000).map(|i| format!("{:.3},0.1\n", 100.0 + f64::from(i) / 1000.0));
    let signal = folder.put("s.csv", format!("{header}\n{}", rows.collect::<String>()));
    let map = map.map(|map| map.parse::<ColumnMap>().unwrap());
    let tracker = Tracker::new(folder.put("t.csv", tracker)).with_map(map);
    let given = (!header.starts_with("t_s")).then_some(1000.0);
    let options = ReadOptions::default().with_tracker(tracker).with_rate_hz(given);
    read_recording(&signal, &options).map_err(|error| error.to_string())
}

/// A tracker of 60 Hz and 0.1 mm that moves along a line at 80 mm/s from one time to another.
fn at_80_mm_s(header: &str, from_s: f64, to_s: f64) -> String {
    let mut text = format!("{header}\n");
    let mut row = 0.0;
    while from_s + row / 60.0 <= to_s {
        let t = row / 60.0;
        let (x, y) = ((480.0 * t).round() / 10.0, 5.0 - (640.0 * t).round() / 10.0);
        text += &format!("{:.6},{x:.1},{y:.1}\n", from_s + t);
        row += 1.0;
    }
    text
}

#[test]
fn a_tracker_gives_the_speed_of_each_sample() {
    let close = |recording: &Recording| {
        let speed = recording.speed_mm_s.as_ref().unwrap();
        assert_eq!(speed.len(), recording.samples());
        assert!(speed.iter().all(|v| (v - 80.0).abs() < 2.5), "{speed:?}");
    };
    let whole = tracked(&at_80_mm_s("t_s,x_mm,y_mm", 99.0, 103.0), None, "t_s,fy_n").unwrap();
    close(&whole);
    assert_eq!((whole.samples(), whole.warnings.len()), (2000, 0));

    let map = Some("time=clock,x=east,y=north");
    let part = tracked(&at_80_mm_s("clock,east,north", 100.5, 101.25), map, "t_s,fy_n").unwrap();
    close(&part);
    assert_eq!((part.samples(), part.first_sample), (751, 500));
    assert!(has_warning(&part, "only the common part is read"));
    assert!(has_warning(&part, "t.csv: Column \"east\" (x) has no unit; mm is assumed"));

    let from_start = tracked(&at_80_mm_s("t_s,x_mm,y_mm", -1.0, 3.0), None, "clock,fy_n").unwrap();
    close(&from_start);
    let speed = tracked("t,speed\n90,-2\n101,-2\n110,7\n", None, "t_s,fy_n").unwrap();
    let speed_mm_s = speed.speed_mm_s.as_ref().unwrap();
    assert!(
        (speed_mm_s[0], speed_mm_s[1000]) == (2.0, 2.0) && (speed_mm_s[1900] - 2.5).abs() < 1e-9
    );
    assert!(has_warning(&speed, "The longest gap of the tracker is 11.000 s"));
}

#[test]
fn trackers_that_cannot_be_aligned_are_refused() {
    for (tracker, map, words) in [
        (
            at_80_mm_s("t_s,x_mm,y_mm", 0.0, 3.0),
            None,
            "covers 0.000 to 3.000 s and the recording 100.000 to 101.999 s",
        ),
        (at_80_mm_s("t_s,x_mm,y_mm", 101.9985, 103.0), None, "do not overlap"),
        (
            at_80_mm_s("clock,x_mm,y_mm", 99.0, 103.0),
            None,
            "the tracker has no time; map its column",
        ),
        (
            at_80_mm_s("t_s,east,north", 99.0, 103.0),
            None,
            "no column of the tracker has a known name",
        ),
        (
            at_80_mm_s("t_s,x_mm,y_mm", 99.0, 103.0),
            Some("lateral=x_mm"),
            "is not a role of a tracker",
        ),
        (
            "t_s,x_mm\n1,2\n1,3\n".to_owned(),
            None,
            "t.csv, line 3: the tracker's time after 1 s is 1 s",
        ),
        ("t_s,x_mm\n1,2\n2,nan\n".to_owned(), None, "t.csv, line 3, column \"x_mm\""),
    ] {
        let error = tracked(&tracker, map, "t_s,fy_n").unwrap_err();
        assert!(error.contains(words), "{error}");
    }
}

proptest! {
    #[test]
    fn any_text_is_a_map_or_an_error(text in "[ -~µ]{0,60}", expression in "[a()#12 +*/.,:='\"-]{0,30}") {
        let _ = text.parse::<ColumnMap>();
        let _ = lateral(&expression);
    }

    #[test]
    fn expressions_agree_with_the_arithmetic_of_the_language(a in -9.0..9.0f64, b in 0.1..9.0f64, c in -9.0..9.0f64) {
        let text = format!("a,b,c\n{a},{b},{c}\n0,1,0\n");
        let map = "lateral=-(a-b*c)/b+2*a-(c/(b+1)-a)";
        let recording = read("p.csv", text, &mapped(map, Some(1.0))).unwrap();
        prop_assert_eq!(recording.axes[0][0], -(a - b * c) / b + 2.0 * a - (c / (b + 1.0) - a));
    }
}
