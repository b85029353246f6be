//! Accuracy against bytes and time, as a user runs it.

use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::common::{Place, entries, rms, words};
use crate::model::ID;
use crate::versions::{FIELDS, noise};
use htex_host::{Registry, Search};
use serde_json::Value;

fn quick<'a>(csv: &'a str, only: &'a str, output: &'a str) -> [&'a str; 8] {
    ["tradeoff", csv, "--quick", "--only", only, "-o", output, "--json"]
}

fn points(tradeoff: &Value) -> &Vec<Value> {
    tradeoff["points"].as_array().unwrap()
}

#[test]
fn a_sweep_writes_a_page_and_its_points() {
    let place = Place::new();
    let csv = place.recording("sandpaper");
    // In windows, a recording of 4 s has blocks to hold out.
    let windows = ["--segments", "windows"];
    let told = place.json(&[&quick(&csv, "ar,sslope", "report.html")[..], &windows].concat());
    assert_eq!(
        entries(&place.path("")),
        ["report.csv", "report.html", "report.json", "sandpaper.csv"]
    );
    let read = |name: &str| std::fs::read_to_string(place.path(name)).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&read("report.json")).unwrap(), told);
    assert_eq!(read("report.csv").lines().count(), 1 + points(&told).len());
    let page = read("report.html");
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("ar order=64"));
    assert!(!page.contains("<script") && !page.contains("src="));
    let number = |point: &Value, key: &str| {
        let value = point[key].as_f64();
        value.unwrap_or_else(|| panic!("{key} of {point}"))
    };
    for point in points(&told) {
        assert_eq!(point["recording"], "sandpaper.csv");
        assert!(point["model"].is_string() && point["knobs"]["synthesis"].is_string());
        for key in ["ns_per_sample", "first_sample_us", "bytes", "band_error_rms_db"] {
            assert!(number(point, key) > 0.0, "{key} of {point}");
        }
        for key in [
            "felt_error_rms_db",
            "share_below_threshold",
            "share_within_repeatability",
            "samples_felt_error_rms_db",
            "fit_ms",
            "spread",
            "spectral_correlation",
            "samples_band_error_rms_db",
        ] {
            number(point, key);
        }
        assert!(point["on_front"].is_boolean() && point["on_time_front"].is_boolean());
    }
    // Graded by what is held out, where the spectrum at a byte a bin is no better than a second
    // recording, whatever it is to itself.
    assert_eq!(told["error"], "held_out");
    let default = |tradeoff: &Value, model: &str| {
        let own = |p: &&Value| p["model"] == model && p["setting"] == "default";
        points(tradeoff).iter().find(own).unwrap().clone()
    };
    let recording = default(&told, "recording");
    assert_eq!(recording["bytes"], 4 * 2 * 80_000);
    assert_eq!(number(&recording, "held_out_error"), 1.0);
    let floor_db = number(&told["recordings"][0], "floor_db");
    assert_eq!(number(&recording, "held_out_error_db"), floor_db);
    let quantised = default(&told, "quantised-spectrum");
    assert!((0.7..1.3).contains(&number(&quantised, "held_out_error")), "{quantised}");
    assert!(number(&quantised, "third_octave_error_rms_db") < 0.1 * floor_db);
    assert!(number(&default(&told, "sslope"), "held_out_error") > 1.3);
    assert!(number(&told["recordings"][0], "blocks") >= 4.0);
    assert!(page.contains("held-out error / of a second recording"));
    assert!(page.contains("floor: a second recording"));
    // Of times within their spreads, the best alone is on the front.
    let mut on_time: Vec<&Value> =
        points(&told).iter().filter(|p| p["on_time_front"] == true).collect();
    on_time.sort_by(|a, b| number(a, "ns_per_sample").total_cmp(&number(b, "ns_per_sample")));
    let falls =
        |pair: &[&Value]| number(pair[1], "held_out_error") < number(pair[0], "held_out_error");
    assert!(on_time.windows(2).all(falls), "{on_time:?}");
    // Twice the digits, twice the bytes, and no nearer.
    let ar = |setting: &str| {
        let own = |p: &&Value| p["model"] == "ar" && p["setting"] == setting;
        points(&told).iter().find(own).unwrap()
    };
    assert_eq!(ar("store=f32")["bytes"], 29);
    assert_eq!(ar("store=f64")["bytes"], 57);
    // The same sweep by another error: fronts and knees go by it, and points stay as they were.
    let arguments =
        [&quick(&csv, "ar,sslope", "third.html")[..], &windows, &["--error", "third-octave"]]
            .concat();
    let third = place.json(&arguments);
    assert_eq!(third["error"], "third_octave");
    assert!(read("third.html").contains("third-octave error / dB"));
    let mut front: Vec<&Value> = points(&third).iter().filter(|p| p["on_front"] == true).collect();
    front.sort_by_key(|p| p["bytes"].as_u64());
    let falls = |key: &str| front.windows(2).all(|w| number(w[1], key) <= number(w[0], key));
    assert!(falls("third_octave_error_rms_db"));
    // The spectrum at a byte a bin ends that front.
    let last = front.last().unwrap();
    assert_eq!((&last["model"], &last["bytes"]), (&"quantised-spectrum".into(), &205.into()));
    let error = |t: &Value| {
        points(t).iter().map(|p| number(p, "third_octave_error_rms_db")).collect::<Vec<_>>()
    };
    assert_eq!(error(&third), error(&told));
    let knees = told["knees"].as_array().unwrap();
    assert!(knees.iter().any(|k| k["of"] == "all models" && k["against"] == "bytes"));
}

#[test]
fn an_interrupted_sweep_goes_on_where_it_stopped() {
    let place = Place::new();
    let csv = place.recording("vinyl");
    let arguments = quick(&csv, "ar,sbeta", "report.html");
    let mut command = place.command(&arguments);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let part = place.path("report.part");
    let begun = Instant::now();
    let lines = || std::fs::read_to_string(&part).map_or(0, |text| text.lines().count());
    while lines() < 4 && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(lines() >= 4, "the sweep left nothing to go on from");
    assert_eq!(entries(&place.path("")), ["report.part", "vinyl.csv"]);
    // A mark in what was finished shows that it is used.
    let text = std::fs::read_to_string(&part).unwrap();
    let (key, rest) = text.split_once('\n').unwrap();
    let marked = rest.replacen("\"bytes\":53,", "\"bytes\":424242,", 1);
    assert_ne!(marked, rest);
    std::fs::write(&part, format!("{key}\n{marked}")).unwrap();
    let resumed = place.json(&arguments);
    assert!(!part.exists());
    let is_marked = |p: &&Value| p["bytes"] == 424_242;
    assert_eq!(points(&resumed).iter().filter(is_marked).count(), 1);
    let whole = place.json(&arguments);
    assert_eq!(points(&whole).iter().filter(is_marked).count(), 0);
    let same = |tradeoff: &Value| {
        let what = ["model", "setting", "band_error_rms_db", "samples_band_error_rms_db"];
        let of = |p: &Value| what.map(|key| p[key].clone());
        points(tradeoff).iter().map(of).collect::<Vec<_>>()
    };
    assert_eq!(same(&resumed), same(&whole));
    // Another recording: what was finished is of no use.
    std::fs::write(&part, format!("{key}\n{marked}")).unwrap();
    let other = place.recording("coarse-fabric");
    let other = place.json(&quick(&other, "ar,sbeta", "report.html"));
    assert_eq!(points(&other).iter().filter(is_marked).count(), 0);
}

/// The descriptor of a third-party model says how it is swept, what a slider covers, and that it is
/// used only by its name.
#[test]
fn a_plugin_is_swept_as_its_descriptor_says_and_used_only_by_its_name() {
    let place = Place::new();
    let csv = place.recording("sandpaper");
    let fields = FIELDS.replacen(
        r#""description""#,
        r#""usual":{"min":20,"max":1000,"scale":"log"},"description""#,
        1,
    );
    let option = |name: &str, more: &str| {
        format!(
            r#"{{"name":"{name}","unit":"1","min":0,"max":4,"default":2,{more},"description":"O."}}"#
        )
    };
    let detail = option("detail", r#""sweep":[0.5,2,4],"not_above":"most""#);
    let most = option("most", r#""sweep":[2,4]"#);
    let tone = r#"{"name":"tone","unit":"1","min":0,"max":1,"default":0,"integer":true,"choices":["soft","hard"],"sweep_alone":[1],"description":"T."}"#;
    let descriptor = format!(
        r#"{{"id":"{ID}","name":"H","version":"1.0.0","summary":"S.","only_named":true,"fields":[{fields}],"options":[{detail},{most},{tone}]}}"#
    );
    place.write("noise.wasm", noise(&descriptor, false));
    let plugin = ["--plugin", "noise.wasm"];
    let shown = place.run(&[&["plugin", "info", "hostile"][..], &plugin].concat()).text();
    for line in [
        "Used only if you name it.",
        "usually 20 to 1000 Hz, logarithmic",
        "swept: 0.5, 2, 4, none above `most`",
        "swept alone: hard",
    ] {
        assert!(shown.contains(line), "{line}: {shown}");
    }
    let search = Search::builtin().with_files(vec![place.path("noise.wasm")]);
    let registry = Registry::search(&search).unwrap();
    assert!(registry.models().iter().any(|model| model.id() == ID));
    assert!(registry.by_default().all(|model| model.id() != ID));
    let told = place.json(&[&quick(&csv, "hostile", "report.html")[..], &plugin].concat());
    let own = |p: &&Value| p["model"] == "hostile" && p["knobs"]["synthesis"] == "streamed";
    let settings: Vec<&str> =
        points(&told).iter().filter(own).filter_map(|p| p["setting"].as_str()).collect();
    for setting in ["default", "detail=0.5", "most=4", "tone=hard"] {
        assert!(settings.contains(&setting), "{setting}: {settings:?}");
    }
    assert!(!settings.contains(&"detail=4"), "{settings:?}");
}

#[test]
fn wrong_usage_writes_nothing() {
    let place = Place::new();
    let csv = place.recording("vinyl");
    place.write("text.csv", "this is\nno recording\n");
    let short = format!(
        "tradeoff {csv} --from 1 --to 1.7 --segments windows --only sslope --quick -o \
             short.html"
    );
    let short = words(&short);
    let held_out = [&short[..], &["--error", "held-out"]].concat();
    let cases: [(&[&str], i32, &str); 6] = [
        (&held_out, 1, "fewer than four blocks"),
        (&["tradeoff", "-o", "r.html"], 2, "required"),
        (&["tradeoff", &csv, "-o", "r.json"], 2, "r.json"),
        (&["tradeoff", &csv, "--only", "nobody", "-o", "r.html"], 2, "nobody"),
        (&["tradeoff", "text.csv", "-o", "r.html"], 1, "text.csv"),
        (&["tradeoff", &csv, "--quick", "--only", "ar", "-o", "no/r.html"], 1, "no/r.part"),
    ];
    for (arguments, code, said) in cases {
        let run = place.run(arguments);
        assert_eq!(run.code(), code, "{arguments:?}: {}", run.error());
        assert!(run.error().contains(said), "{arguments:?}: {}", run.error());
    }
    assert_eq!(entries(&place.path("")), ["text.csv", "vinyl.csv"]);
    // By default it is then graded by what it was fitted to, and the result says so.
    let found = place.json(&[&short[..], &["--json"]].concat());
    assert_eq!(found["error"], "third_octave");
    assert!(points(&found).iter().all(|p| p["held_out_error"].is_null()));
    let warnings = found["warnings"].as_array().unwrap();
    let is_said = |w: &Value| w.to_string().contains("fewer than four blocks");
    assert!(warnings.iter().any(is_said), "{warnings:?}");
}

#[test]
fn a_loop_repeats_in_a_file_and_a_filter_plays_the_level() {
    let place = Place::new();
    let csv = place.recording("sandpaper");
    place.json(&["fit", &csv, "--model", "ar", "-o", "a.htex", "--json"]);
    let synth = |quality: &str| {
        let out = format!("{}.wav", quality.replace(':', "-"));
        let run =
            place.run(&["synth", "a.htex", "--seconds", "4", "--quality", quality, "-o", &out]);
        assert_eq!(run.code(), 0, "{}", run.error());
        place.samples(&out)
    };
    let (streamed, looped, filtered) = (synth("streamed"), synth("loop:1.5"), synth("filter"));
    assert_eq!(looped[..30_000], looped[30_000..60_000]);
    assert_ne!(streamed[..30_000], streamed[30_000..60_000]);
    // Four seconds of this texture: the level of noise is known within a few percent.
    for other in [&looped, &filtered] {
        assert!((rms(other) / rms(&streamed) - 1.0).abs() < 0.1);
    }
    for wrong in ["loop:0", "filter:7", "loud"] {
        let run = place.run(&["synth", "a.htex", "--quality", wrong, "-o", "x.wav"]);
        assert_eq!(run.code(), 2);
        assert!(run.error().contains("loop:SECONDS"), "{}", run.error());
    }
}
