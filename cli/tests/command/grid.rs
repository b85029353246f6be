//! One free recording, a grid of conditions: simulated, fitted, shown, played.

use crate::common::Place;

#[test]
fn a_free_recording_becomes_a_grid_that_is_shown_and_played() {
    let place = Place::new();
    let simulate = |more: &[&str]| {
        let common = ["simulate", "--surface", "vinyl", "-o", "free.csv"];
        place.run(&[&common[..], more].concat())
    };
    let free = ["--motion", "free", "--seconds", "30", "--rate", "4000"];
    let run = simulate(&[&free[..], &["--truth", "truth.json"]].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
    let first = std::fs::read_to_string(place.path("free.csv")).unwrap();
    let title = first.lines().next().unwrap();
    assert!(title.contains("free motion, 36 to 280 mm/s, 0.15 to 3.8 N"), "{title}");

    let fit = ["fit", "free.csv", "--model", "bands", "--license", "CC0-1.0"];
    let grid = ["--grid", "auto", "--grid-svg", "grid.svg", "--report", "page.html"];
    let fitted = place.json(&[&fit[..], &grid, &["-o", "a.htex", "--json"]].concat());
    let cells = fitted["grid"]["cells"].as_array().unwrap();
    let named = cells.iter().filter(|c| c["condition"].is_u64()).count();
    assert!(named >= 8 && named == fitted["manifest"]["conditions"].as_array().unwrap().len());
    assert!(
        cells
            .iter()
            .all(|c| ["fitted", "widened", "thin"].contains(&c["status"].as_str().unwrap()))
    );
    let picture = std::fs::read_to_string(place.path("grid.svg")).unwrap();
    for word in ["speed / mm/s", "normal force / N", "steady windows", "repeats within"] {
        assert!(picture.contains(word), "{word}");
    }
    assert!(std::fs::read_to_string(place.path("page.html")).unwrap().contains("Conditions"));

    let info = place.json(&["info", "a.htex", "--json"]);
    // There are more than eight conditions, and the coded file is smaller.
    assert!(named > 8);
    assert_eq!(info["manifest"]["htex"], "1.1");
    assert_eq!(info["manifest"]["extensions_required"], serde_json::json!(["org.htex.coded/1"]));
    // The file holds fewer digits of the repeatability.
    let place_of = |json: &serde_json::Value| -> Vec<[f64; 3]> {
        let conditions = json["manifest"]["conditions"].as_array().unwrap().iter();
        let keys = ["speed_mm_s", "force_n", "segments"];
        conditions.map(|c| keys.map(|key| c[key].as_f64().unwrap())).collect()
    };
    assert_eq!(place_of(&info), place_of(&fitted));
    let grid = &fitted["grid"];
    assert!(grid["left_out_rms_db"].is_f64() && grid["one_condition_rms_db"].is_f64());
    let at = info["manifest"]["representations"][0]["at"].as_array().unwrap();
    assert!(at.iter().any(|at| at["left_out"]["third_octave_error_rms_db"].is_f64()));
    let text = place.run(&["info", "a.htex"]).text();
    assert!(text.contains("left out") && text.contains("segments"), "{text}");
    assert_eq!(place.run(&["validate", "a.htex"]).code(), 0);
    let played = ["spectrum", "a.htex", "--speed", "100", "--force", "1", "--json"];
    assert!(place.json(&played)["magnitude"].is_array());

    // The same texture without codes: any reader can open it, and it plays the same samples.
    let plain = place.run(&["edit", "a.htex", "--storage", "plain", "-o", "plain.htex"]);
    assert_eq!(plain.code(), 0, "{}", plain.error());
    let plain = place.json(&["info", "plain.htex", "--json"]);
    assert_eq!(plain["manifest"]["extensions_required"], serde_json::Value::Null);
    assert_eq!(place_of(&plain), place_of(&info));
    assert!(plain["bytes"].as_u64() > info["bytes"].as_u64());
    let samples = |asset: &str| {
        let motion = ["--speed", "100", "--force", "1", "--seconds", "0.2", "-o", "played.wav"];
        assert_eq!(place.run(&[&["synth", asset], &motion[..]].concat()).code(), 0);
        std::fs::read(place.path("played.wav")).unwrap()
    };
    assert_eq!(samples("plain.htex"), samples("a.htex"));
    let again = place.run(&["edit", "plain.htex", "--storage", "auto", "-o", "again.htex"]);
    assert_eq!(again.code(), 0, "{}", again.error());
    let file = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert_eq!(file("again.htex"), file("a.htex"));

    let few = [&fit[..], &["--grid", "speed=60,120", "--grid", "force=0.5,1.5"]].concat();
    let text = place.run(&[&few[..], &["-o", "b.htex"]].concat());
    assert_eq!(text.code(), 0, "{}", text.error());
    let required = |asset: &str| {
        let info = place.json(&["info", asset, "--json"]);
        info["manifest"]["extensions_required"].is_array()
    };
    assert!(!required("b.htex"));
    assert_eq!(place.run(&[&few[..], &["--storage", "coded", "-o", "c.htex"]].concat()).code(), 0);
    assert!(required("c.htex"));
    assert!(text.text().contains("windows of 0.2 s are steady"), "{}", text.text());
}

#[test]
fn grids_and_motions_that_do_not_fit_are_refused() {
    let place = Place::new();
    let sweeps = place.recording("vinyl");
    let refused = |arguments: &[&str]| {
        let run = place.run(arguments);
        (run.code(), run.error())
    };
    let (code, error) = refused(&["fit", &sweeps, "--grid", "auto", "-o", "a.htex"]);
    assert!(code == 1 && error.contains("the motion is constant"), "{code} {error}");
    let (code, error) = refused(&["fit", &sweeps, "--grid", "speed=80,x", "-o", "a.htex"]);
    assert!(code == 2 && error.contains("--grid speed=80,x"), "{code} {error}");
    assert!(!place.path("a.htex").exists());
    let simulate = ["simulate", "--surface", "vinyl", "-o", "b.csv"];
    for (more, why) in [
        (&["--truth", "t.json"][..], "--motion free"),
        (&["--speed", "36:280"], "--motion free"),
        (&["--motion", "free", "--speed", "280:36"], "highest speed_mm_s"),
        (&["--motion", "free", "--force", "a"], "not a number"),
    ] {
        let (code, error) = refused(&[&simulate[..], more].concat());
        assert!(code == 2 && error.contains(why), "{code} {error}");
    }
    assert!(!place.path("b.csv").exists());
}
