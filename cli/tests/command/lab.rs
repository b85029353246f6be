//! Recordings as laboratories keep them: sensors that are added up, a tracker in a second file,
//! other formats.

use std::path::Path;

use crate::common::{Place, numbers};

/// Writes `name` with columns of a simulated recording: each is computed of the row's values, in
/// the order of `t_s,fx_n,fy_n,fz_n,x_mm,y_mm`.
fn rewritten(
    place: &Place,
    csv: &str,
    name: &str,
    header: &str,
    every: usize,
    row: impl Fn(&[f64]) -> Vec<f64>,
) {
    let text = std::fs::read_to_string(place.path(csv)).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    assert_eq!(lines.next(), Some("t_s,fx_n,fy_n,fz_n,x_mm,y_mm"));
    let mut out = format!("{header}\n");
    for line in lines.step_by(every) {
        let values: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let cells: Vec<String> = row(&values).iter().map(f64::to_string).collect();
        out += &format!("{}\n", cells.join(","));
    }
    place.write(name, out);
}

#[test]
fn two_sensors_and_a_tracker_give_the_spectrum_of_the_recording() {
    let place = Place::new();
    let csv = place.recording("sandpaper");
    let whole = place.json(&["process", &csv, "--json"]);
    // Sensors of half the force with opposite offsets in millinewtons, a normal force of the other
    // sign, and a tracker of 60 Hz.
    rewritten(&place, &csv, "force.csv", "t_s,left-mN,right,y,fz", 1, |row| {
        vec![row[0] + 7.0, 500.0 * row[1] + 3.0, 500.0 * row[1] - 3.0, row[2], -row[3] / 0.31]
    });
    let rate_hz = whole["rate_hz"].as_f64().unwrap();
    rewritten(&place, &csv, "tracker.csv", "stamp,px,py", (rate_hz / 60.0) as usize, |row| {
        vec![1000.0 * (row[0] + 7.0), row[4] / 0.26, row[5] / 0.26]
    });
    let map = "lateral_x=(\"left-mN\"+right)*1e-3,lateral_y=y:1,normal=-fz*0.31";
    let tracker_map = "time=stamp:0.001,x=px:0.26,y=py:0.26";
    let reading = ["--map", map, "--tracker", "tracker.csv", "--tracker-map", tracker_map];
    let arguments = [&["process", "force.csv", "--json"], &reading[..]].concat();
    let tracked = place.json(&arguments);

    let (a, b) = (numbers(&whole["magnitude"]), numbers(&tracked["magnitude"]));
    let power = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let difference: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
    assert!(power(&difference) < 1e-3 * power(&a), "{} of {}", power(&difference), power(&a));
    let speed = |json: &serde_json::Value| json["speed_mm_s"].as_f64().unwrap();
    assert!((speed(&whole) / speed(&tracked) - 1.0).abs() < 0.01);

    // The asset records how the files were read, with their names but not their folders.
    let fit = [&["fit", "force.csv", "--model", "bands", "-o", "a.htex"], &reading[..]].concat();
    assert_eq!(place.run(&fit).code(), 0);
    let asset = htex_format::Asset::open(&place.path("a.htex")).unwrap();
    let options = &asset.manifest.provenance.options;
    assert_eq!(options["tracker"], "tracker.csv");
    assert_eq!((&options["map"][..], &options["tracker-map"][..]), (map, tracker_map));
}

#[test]
fn files_of_a_tracker_are_never_overwritten_and_must_fit() {
    let place = Place::new();
    let csv = place.recording("sandpaper");
    place.write("t.csv", "t_s,x_mm\n100,0\n101,9\n");
    let run = place.run(&["fit", &csv, "--tracker", "t.csv", "-o", "t.csv"]);
    assert_eq!(run.code(), 2, "{}", run.error());
    let apart = place.run(&["process", &csv, "--tracker", "t.csv"]);
    assert_eq!(apart.code(), 1);
    assert!(
        apart.error().contains("do not overlap")
            && apart.error().contains("(see --tracker, --tracker-map)"),
        "{}",
        apart.error()
    );
    let two = place.run(&["process", &csv, "--tracker", "t.csv", "--tracker", "t.csv"]);
    assert!(
        two.code() == 2 && two.error().contains("--tracker: 2 trackers for 1 recordings"),
        "{}",
        two.error()
    );
    let map = place.run(&["process", &csv, "--map", "lateral=(fx_n"]);
    assert!(
        map.code() == 2 && map.error().contains("character 9: '(' is not closed"),
        "{}",
        map.error()
    );
}

#[test]
fn a_file_of_another_format_is_validated_and_processed() {
    let lab = Path::new(env!("CARGO_MANIFEST_DIR")).join("../sdk/make/recording/tests/lab");
    let place = Place::new();
    for (file, map) in [
        ("compressed.mat", "lateral=run.forces#1:1,normal=run.forces#3:1"),
        ("segments.tdms", "lateral=Run 1/fx_n,normal=Run 1/fz:1"),
        ("pcm16.flac", "lateral=ch1:1,normal=ch3:1"),
    ] {
        let path = lab.join(file);
        let path = path.to_str().unwrap();
        // 96 rows are too short for a segment: the file is read, and the recording is what is
        // refused.
        let run = place.run(&["process", path, "--map", map, "--rate", "2000"]);
        assert!(
            run.code() == 1 && run.error().contains("96 samples are less than one segment"),
            "{file}: {}",
            run.error()
        );
    }
}
