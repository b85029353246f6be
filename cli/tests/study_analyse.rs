//! `htex study analyse` and `htex study power`, as a user runs them.
#![cfg(feature = "lab")]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;

use std::path::Path;

use common::{Place, Run};
use serde_json::Value;

const HEADER: &str = "participant,texture,model,repetition,rating\n";

fn golden(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/golden/study");
    folder.join(name).to_str().unwrap().to_owned()
}

/// Runs the analysis of `rows`, with `flags`.
fn analysed(rows: &str, flags: &[&str]) -> Run {
    let place = Place::new();
    place.write("r.csv", format!("{HEADER}{rows}"));
    place.run(&[&["study", "analyse", "--ratings", "r.csv"], flags].concat())
}

#[test]
fn bad_tables_have_codes_and_places() {
    let rest = "a,t,m,1,3\na,t,n,1,4\nb,t,m,1,2\n";
    let cases = [
        (
            "a,t,m,1,good\n",
            "RATING_INVALID",
            "/5/rating",
            "line 5, column 5 (`rating`): `good`",
        ),
        (
            "b,t,n,1,NaN\n",
            "RATING_INVALID",
            "/5/rating",
            "`NaN` is not a number",
        ),
        (
            "b,t,n,1,\n",
            "RATING_INVALID",
            "/5/rating",
            "line 5, column 5",
        ),
        (
            ",t,n,1,4\n",
            "TABLE_NAME_EMPTY",
            "/5/participant",
            "line 5, column 1",
        ),
        (
            "b,t,n,4\n",
            "TABLE_FIELDS",
            "/5",
            "line 5: it has 4 fields, and the header has 5",
        ),
        (
            "b,t,m,1,4\n",
            "RATING_DUPLICATE",
            "/5/repetition",
            "line 5, column 4",
        ),
        (
            "c,t,m,1,4\nc,t,n,1,5\n",
            "RATINGS_CELL_MISSING",
            "",
            "participant b has no rating of model n in texture t",
        ),
    ];
    for (row, code, pointer, message) in cases {
        let run = analysed(&format!("{rest}{row}"), &[]);
        assert_eq!(run.code(), 1, "{row}");
        assert!(
            run.error().contains(code) && run.error().contains(message),
            "{row}: {}",
            run.error()
        );
        let run = analysed(&format!("{rest}{row}"), &["--json"]);
        let report: Value = serde_json::from_str(&run.text()).unwrap();
        assert_eq!((run.code(), &report["valid"]), (1, &Value::Bool(false)));
        let found = report["findings"].as_array().unwrap();
        assert!(
            found
                .iter()
                .any(|f| f["code"] == code && f["pointer"] == pointer),
            "{row}: {report}"
        );
        assert_eq!(Place::new().run(&["explain", code]).code(), 0, "{code}");
    }
    let place = Place::new();
    for (bytes, code) in [
        (
            &b"participant;texture;model;repetition;rating\na;t;m;1;2\n"[..],
            "TABLE_COLUMN_MISSING",
        ),
        (
            b"participant,texture,model,repetition,rating\n",
            "TABLE_EMPTY",
        ),
        (
            b"participant,texture,model,repetition,rating\na,t,\xff,1,2\n",
            "TABLE_NOT_UTF8",
        ),
        (
            b"participant,texture,model,repetition,rating,rating\na,t,m,1,2,3\n",
            "TABLE_COLUMN_DUPLICATE",
        ),
        (b"", "TABLE_EMPTY"),
    ] {
        place.write("r.csv", bytes);
        let run = place.run(&["study", "analyse", "--ratings", "r.csv", "-o", "out"]);
        assert!(
            run.code() == 1 && run.error().contains(code),
            "{code}: {}",
            run.error()
        );
        assert!(!place.path("out").exists());
    }
    assert_eq!(
        place
            .run(&["study", "analyse", "--ratings", "none.csv"])
            .code(),
        1
    );
}

#[test]
fn bad_spectra_have_codes_and_places() {
    let place = Place::new();
    let ratings = "a,t,m,1,3\na,t,n,1,4\nb,t,m,1,2\nb,t,n,1,4\n";
    place.write("r.csv", format!("{HEADER}{ratings}"));
    let grid: Vec<String> = (4..=200).map(|bin| (5 * bin).to_string()).collect();
    let line = |names: &str, value: &str| format!("{names},{}\n", vec![value; 197].join(","));
    let head = format!("participant,texture,model,{}\n", grid.join(","));
    let recorded = line("recorded,t,recorded", "1");
    let felt: String = ["a,t,m", "a,t,n", "b,t,m"]
        .iter()
        .map(|cell| line(cell, "2"))
        .collect();
    let cases = [
        (
            format!("{head}{felt}"),
            "SPECTRA_RECORDED_MISSING",
            "of texture t",
        ),
        (
            format!("{head}{recorded}{felt}"),
            "SPECTRA_CELL_MISSING",
            "participant b felt of model n",
        ),
        (
            format!("{head}{recorded}{felt}{}", line("b,t,n", "-1")),
            "SPECTRA_MAGNITUDE_INVALID",
            "line 6, column 4 (`20`)",
        ),
        (
            format!("{head}{recorded}{felt}{}", line("b,t,m", "1")),
            "SPECTRA_DUPLICATE",
            "line 6",
        ),
        (
            "participant,texture,model,20,25\na,t,m,1,2\n".to_owned(),
            "SPECTRA_GRID_INVALID",
            "2 of 2 frequencies",
        ),
    ];
    for (table, code, message) in cases {
        place.write("s.csv", table);
        let run = place.run(&[
            "study",
            "analyse",
            "--ratings",
            "r.csv",
            "--spectra",
            "s.csv",
        ]);
        assert_eq!(run.code(), 1, "{code}");
        assert!(
            run.error().contains(code) && run.error().contains(message),
            "{code}: {}",
            run.error()
        );
    }
    // Equal spectra explain nothing: the regressions are named as missing, not NaN.
    place.write(
        "s.csv",
        format!("{head}{recorded}{felt}{}", line("b,t,n", "2")),
    );
    let got = place.json(&[
        "study",
        "analyse",
        "--ratings",
        "r.csv",
        "--spectra",
        "s.csv",
        "--json",
    ]);
    assert!(
        noted(&got, "bands.1", "NO_PREDICTOR") && got.get("bands").is_none(),
        "{got}"
    );
}

fn noted(analysis: &Value, group: &str, code: &str) -> bool {
    let notes = analysis["notes"].as_array().unwrap();
    notes
        .iter()
        .any(|note| note["group"] == group && note["code"] == code)
}

#[test]
fn degenerate_studies_are_named_and_never_nan() {
    let rows = |people: &str, rating: &dyn Fn(usize, usize) -> f64| -> String {
        let people = people.chars().enumerate();
        people
            .flat_map(|(p, name)| (0..3).map(move |m| (p, name, m)))
            .map(|(p, name, m)| format!("{name},t,m{m},1,{}\n", rating(p, m)))
            .collect()
    };
    let cases = [
        (
            rows("a", &|_, m| m as f64),
            "anova_model",
            "TOO_FEW_PARTICIPANTS",
        ),
        (
            rows("ab", &|p, m| (p + m * m) as f64),
            "anova_model",
            "NO_ERROR_VARIANCE",
        ),
        (rows("abc", &|p, _| p as f64), "friedman", "ALL_TIED"),
        (rows("abc", &|_, _| 3.0), "normality", "CONSTANT"),
        (
            rows("ab", &|p, m| (p * m) as f64),
            "anova_model",
            "SPHERICITY_UNDEFINED",
        ),
        (
            rows("abcd", &|p, m| (p * m % 4) as f64),
            "anova_two_way",
            "TOO_FEW_LEVELS",
        ),
    ];
    for (rows, group, code) in cases {
        let run = analysed(&rows, &["--json", "-o", "out"]);
        assert_eq!(run.code(), 0, "{}", run.error());
        let got: Value = serde_json::from_str(&run.text()).unwrap();
        assert!(noted(&got, group, code), "{group} {code}: {}", got["notes"]);
        let text = analysed(&rows, &[]).text();
        for word in ["NaN", " inf", "Infinity", "null"] {
            assert!(
                !text.contains(word) && !run.text().contains(word),
                "{word}: {text}"
            );
        }
    }
    let constant = rows("abcd", &|p, m| {
        if p == 3 {
            2.0
        } else {
            (p + 2 * m) as f64 % 5.0
        }
    });
    let run = analysed(&constant, &[]);
    assert!(
        run.error().contains("RATINGS_PARTICIPANT_CONSTANT")
            && run.error().contains("participant d")
    );
    // A participant without all ratings is left out where that is asked for, and named.
    let missing = format!("{constant}e,t,m0,1,2\n");
    assert_eq!(analysed(&missing, &[]).code(), 1);
    let run = analysed(&missing, &["--leave-out-incomplete"]);
    assert!(
        run.code() == 0 && run.error().contains("RATINGS_LEFT_OUT"),
        "{}",
        run.error()
    );
    assert!(run.text().contains("4 participants"));
}

#[test]
fn simulated_participants_are_named_everywhere() {
    let place = Place::new();
    let rows = "a,t,m,1,3,yes\na,t,n,1,4,yes\nb,t,m,1,2,no\nb,t,n,1,4,no\n";
    place.write(
        "r.csv",
        format!("participant,texture,model,repetition,rating,simulated\n{rows}"),
    );
    let run = place.run(&["study", "analyse", "--ratings", "r.csv", "-o", "out"]);
    assert!(run.error().contains("RATINGS_SIMULATED"), "{}", run.error());
    assert!(run.text().contains("1 SIMULATED"));
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("SIMULATED"));
}

#[test]
fn results_do_not_depend_on_the_order_of_the_lines() {
    let place = Place::new();
    let table = std::fs::read_to_string(golden("ratings.csv")).unwrap();
    let mut lines: Vec<&str> = table.lines().skip(1).collect();
    lines.sort_by_key(|line| {
        line.bytes()
            .rev()
            .map(u64::from)
            .fold(7, |sum, b| sum * 31 % 9973 + b)
    });
    place.write(
        "shuffled.csv",
        format!("{HEADER}{}\r\n", lines.join("\r\n")),
    );
    let one = place.run(&[
        "study",
        "analyse",
        "--json",
        "--ratings",
        &golden("ratings.csv"),
    ]);
    let other = place.run(&["study", "analyse", "--json", "--ratings", "shuffled.csv"]);
    assert_eq!((one.code(), one.text()), (0, other.text()));
}

#[test]
fn the_papers_power_analysis_gives_eight_participants() {
    let place = Place::new();
    let plan = [
        "study",
        "power",
        "--effect",
        "0.25",
        "--measurements",
        "25",
        "--json",
    ];
    let got = place.json(&[&plan[..], &["--power", "0.8"]].concat());
    assert_eq!(got["participants"], 8);
    assert!((got["power"].as_f64().unwrap() - 0.801_578_953_388_535_4).abs() < 1e-9);
    let got = place.json(&[&plan[..], &["--participants", "14"]].concat());
    assert!((got["power"].as_f64().unwrap() - 0.987_540_231_698_149_3).abs() < 1e-9);
    for wrong in [
        ["--alpha", "0"],
        ["--correlation", "1"],
        ["--epsilon", "2"],
        ["--power", "1"],
        ["--participants", "1"],
        ["--alpha", "NaN"],
    ] {
        let run = place.run(&[&plan[..], &wrong].concat());
        assert_eq!(run.code(), 2, "{wrong:?}: {}", run.error());
    }
    let run = place.run(&[
        "study",
        "power",
        "--effect",
        "0.00001",
        "--measurements",
        "2",
    ]);
    assert!(
        run.code() == 1 && run.error().contains("100000 participants"),
        "{}",
        run.error()
    );
}

#[test]
fn ratings_off_the_scale_are_named_with_their_lines() {
    let place = Place::new();
    let lines = "participant,texture,model,repetition,rating\na,t,m,1,3\na,t,n,1,7\nb,t,m,1,-1\nb,t,n,1,6\n";
    place.write("ratings.csv", lines);
    let run = |more: &[&str]| {
        place.run(&[&["study", "analyse", "--ratings", "ratings.csv"], more].concat())
    };
    assert_eq!(run(&[]).code(), 0);
    assert_eq!(run(&["--scale", "-1-7"]).code(), 0);
    let refused = run(&["--scale", "0-6"]);
    assert_eq!(refused.code(), 1);
    let error = refused.error();
    assert_eq!(error.matches("RATING_OFF_SCALE").count(), 2, "{error}");
    assert!(
        error.contains("/3/rating") || error.contains("line 3"),
        "{error}"
    );
    assert!(
        error.contains("7 is not on the scale from 0 to 6"),
        "{error}"
    );
    for wrong in ["6", "6-0", "a-b", ""] {
        assert_eq!(run(&["--scale", wrong]).code(), 2, "{wrong}");
    }
}
