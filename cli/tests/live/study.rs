//! Studies as a laboratory runs them. They mostly wait, and so stand in one program, whose tests
//! run at the same time.

#[path = "study/felt.rs"]
mod felt_trials;
#[path = "study/hostile.rs"]
mod hostile_clients;
#[path = "study/page.rs"]
mod page;
#[path = "study/terminal.rs"]
mod terminal;

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::common::Place;
use crate::studies::*;
use htex_dsp::bands::pearson_correlation;

const SURFACES: [&str; 5] =
    ["coarse-fabric", "corrugated-paper", "fine-fabric", "sandpaper", "vinyl"];

/// The paper's study on the paper's rig, with trials as short as a spectrum allows.
fn whole_study() -> String {
    let mut text = "htex_study = '1.0'\nname = 'Similarity'\nseed = 5\ntrial_s = 0.25\nrests = { every = 25, seconds = 60 }\n\
        motion = { constant = { speed_mm_s = 80, force_n = 0.4 } }\ndevice = { adapter = 'daq', profile = 'pcie-6321_tabor-9200a_sct3250' }\n"
        .to_owned();
    for surface in SURFACES {
        text += &format!("[[textures]]\nasset = '{surface}.htex'\n");
    }
    text
}

/// 14 participants, 5 textures, 5 models, 5 repetitions: study.toml to ratings and felt spectra.
/// Two of the participants also run elsewhere, killed five times on the way, with the same bytes.
#[test]
fn a_whole_study_has_the_same_bytes_however_often_it_is_killed() {
    let place = Place::new();
    assert_eq!(place.run(&["demo", "."]).code(), 0);
    place.write("study.toml", whole_study());
    let valid = place.run(&["study", "validate", "study.toml"]);
    assert_eq!(valid.code(), 0, "{}", valid.text());
    let plan = place.json(&["study", "plan", "study.toml", "--json"]);
    assert_eq!(plan["participants"].as_array().unwrap().len(), 14);
    // Participants are independent: seven run at the same time.
    let names: Vec<String> = (1..=14).map(|i| format!("P{i:02}")).collect();
    for some in names.chunks(7) {
        let start = |name: &String| on_card(&place, "answers", &["--participant", name]).spawn();
        let running: Vec<_> = some.iter().map(start).collect();
        for child in running {
            let done = child.unwrap().wait_with_output().unwrap();
            assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        }
    }
    check_ratings(&place);
    check_spectra(&place);
    let whole = answers(&place.path("answers"));
    for (name, text) in &whole {
        assert!(text.lines().all(|line| line.contains("\"simulated\":")), "{name}");
    }
    check_levels(&whole["P01.jsonl"]);
    let killed = place.path("killed");
    for kill in 1..=5 {
        let name = ["P01", "P02"][kill % 2];
        let mut child = on_card(&place, "killed", &["--participant", name]).spawn().unwrap();
        let (start, before) = (Instant::now(), lines(&killed));
        while lines(&killed) < before + 13 * kill && start.elapsed() < Duration::from_secs(120) {
            std::thread::sleep(Duration::from_millis(5));
        }
        child.kill().unwrap();
        assert!(!child.wait().unwrap().success(), "it ended before it was killed");
    }
    for name in ["P01", "P02"] {
        let file = format!("{name}.jsonl");
        assert!(answers(&killed)[&file].len() < whole[&file].len(), "{name} was cut off");
        let done = on_card(&place, "killed", &["--participant", name]).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        assert_eq!(answers(&killed)[&file], whole[&file], "{name}");
        let (found, expected) = (felt(&killed, name), felt(&place.path("answers"), name));
        // 125 trials and 5 for practice, each with JSON beside it.
        assert_eq!(expected.len(), 2 * 130);
        assert!(found == expected, "{name}: what was felt differs");
    }
    let table = |folder: &str, name: &str| {
        let spectra = format!("{folder}.csv");
        let run = place.run(&exported(folder, &spectra, &["-o", "unused.csv"]));
        assert_eq!(run.code(), 0, "{}", run.error());
        let text = fs::read_to_string(place.path(&spectra)).unwrap();
        let rows = text.lines().filter(|row| row.starts_with(name));
        rows.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(table("killed", "P01").len(), 25);
    assert!(table("killed", "P01") == table("answers", "P01"), "the spectra differ");
}

/// Each phase says what the display was given: at first a tenth of its 150 V, and never more than
/// the level that was asked for.
fn check_levels(text: &str) {
    let lines: Vec<serde_json::Value> =
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let mut seen = std::collections::BTreeSet::new();
    for line in lines.iter().filter(|line| line.get("texture").is_some()) {
        let kind = line["kind"].as_str().unwrap();
        let phase = line["phase"].as_str().unwrap_or("");
        let level = |key: &str| line["output"][key].as_f64().unwrap();
        let drive_v = line["drive_v"].as_f64().unwrap();
        if seen.insert(format!("{kind} {phase}")) && kind == "rise" {
            assert!((drive_v - 15.0).abs() < 1e-9, "{line}");
        }
        assert!(level("peak") > 0.0 && level("peak") <= drive_v, "{line}");
        assert!(level("rms") > 0.0 && level("rms") < level("peak"), "{line}");
        assert!(level("direct") < 1.0, "{line}");
        assert!((level("duration_s") - 0.25).abs() < 0.05, "{line}");
        assert_eq!((&line["stops"], &line["output"]["unit"]), (&0.into(), &"V".into()));
    }
    let expected = ["answer ", "gain ", "rise gain", "rise training", "training "];
    assert_eq!(seen.iter().collect::<Vec<_>>(), expected);
}

/// Felt spectra are compared with the spectra of the recordings. Every model's felt spectrum is
/// close to its texture's.
fn check_spectra(place: &Place) {
    let run = exported("answers", "spectra.csv", &["-o", "ratings.csv", "--json"]);
    assert_eq!(place.json(&run)["recordings"], 14 * 125);
    let spectra = fs::read_to_string(place.path("spectra.csv")).unwrap();
    assert_eq!(spectra.lines().count(), 1 + 14 * 25 + 5);
    let rows: Vec<(Vec<&str>, Vec<f64>)> = spectra.lines().skip(1).map(row).collect();
    let recorded = |texture: &str| {
        let found = rows.iter().find(|(names, _)| names[..] == ["recorded", texture, "recorded"]);
        &found.unwrap().1
    };
    for model in ["ar", "mfcc", "sbeta", "speak", "sslope"] {
        let felt = rows.iter().filter(|(names, _)| names[2].ends_with(model));
        let felt: Vec<f64> =
            felt.map(|(names, felt)| pearson_correlation(felt, recorded(names[1]))).collect();
        assert_eq!(felt.len(), 14 * 5, "{model}");
        // Five segments of noise have a correlation of about 0.8 with a spectrum that they fit.
        let mean = felt.iter().sum::<f64>() / felt.len() as f64;
        assert!(mean > 0.7, "{model}: {mean}");
    }
}

/// The table has each rating once, in the columns that analyses read, and the planned best model is
/// rated best.
fn check_ratings(place: &Place) {
    let table = place.json(&["study", "export", "answers", "-o", "ratings.csv", "--json"]);
    assert_eq!(table["ratings"], 14 * 5 * 5 * 5);
    assert_eq!(table["incomplete"].as_array().unwrap().len(), 0);
    let csv = fs::read_to_string(place.path("ratings.csv")).unwrap();
    let mut rows = csv.lines();
    assert!(rows.next().unwrap().starts_with("participant,texture,model,repetition,rating,"));
    let mut keys = std::collections::BTreeSet::new();
    let mut sums: BTreeMap<&str, f64> = BTreeMap::new();
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        assert!(keys.insert(cells[..4].join(",")), "{row}");
        assert!(cells[8].parse::<f64>().unwrap() < 0.0 && cells[9] == "yes", "{row}");
        *sums.entry(cells[2]).or_default() += cells[4].parse::<f64>().unwrap();
    }
    assert_eq!(keys.len(), 14 * 5 * 5 * 5);
    // Simulated participants rate by the nine-band error. AR has the smallest error and sPeak,
    // which plays single lines, the largest.
    let mean = |model: &str| sums[model] / (14.0 * 25.0);
    assert!(mean("ar") > 4.5 && mean("speak") < 1.5, "{sums:?}");
    assert!(mean("ar") > mean("sslope") && mean("sslope") > mean("speak"), "{sums:?}");
}

/// Runs Ann's session with these lines of input: exit code, standard error.
fn typed(place: &Place, input: &str) -> (Option<i32>, String) {
    let mut command = place.command(&["study", "run", "study.toml", "--participant", "Ann"]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    // A program that refuses its arguments reads nothing.
    let _ = stdin.write_all(input.as_bytes());
    drop(stdin);
    let done = child.wait_with_output().unwrap();
    (done.status.code(), String::from_utf8(done.stderr).unwrap())
}

#[test]
fn a_person_answers_in_a_terminal_and_goes_on_another_day() {
    let place = short(&[]);
    // Begin; from 20 dB below the maximum up to where it is felt; 1 dB and 4 dB weaker, 1 dB
    // stronger, accepted; begin, no rating of the scale, a rating; then the input ends.
    let (code, error) = typed(&place, "\n++\n++\n++\n++\n++\n\n-\n--\n+\n\n\n7\n4\n");
    assert_eq!(code, Some(0), "{error}");
    assert!(error.contains("\"7\" is no answer") && error.contains("Ann is not done"), "{error}");
    let text = fs::read_to_string(place.path("answers/Ann.jsonl")).unwrap();
    let kept: Vec<serde_json::Value> =
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let levels = |kind: &str| -> Vec<f64> {
        let lines = kept.iter().filter(|line| line["kind"] == kind);
        lines.map(|l| l["gain_db"].as_f64().unwrap()).collect()
    };
    assert_eq!(levels("rise"), [-16.0, -12.0, -8.0, -4.0, 0.0, 0.0]);
    assert_eq!(levels("gain"), [-1.0, -5.0, -4.0, -4.0]);
    assert_eq!((&kept[12]["rating"], &kept[12]["gain_db"]), (&4.into(), &(-4.0).into()));
    assert!(kept.iter().all(|line| line.get("simulated").is_none()));
    // The session has its date, and the device as it was set.
    assert_eq!(kept[1]["kind"], "session");
    assert_eq!(kept[1]["device"], kept[0]["device"]);
    assert_eq!(kept[0]["device"]["settings"]["format"], "auto", "{}", kept[0]);
    let date = kept[1]["date"].as_str().unwrap();
    assert!(date.len() == 20 && date.starts_with("20") && date.ends_with('Z'), "{date}");
    assert_eq!(kept[0]["begun"].as_str().map(|begun| &begun[..4]), Some(&date[..4]));
    let (code, error) = typed(&place, "\n2\n");
    assert_eq!(code, Some(0), "{error}");
    assert!(error.contains("[2/2] All trials are done"), "{error}");
    let run = place.run(&["study", "export", "answers", "-o", "ratings.csv"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    assert_eq!(fs::read_to_string(place.path("ratings.csv")).unwrap().lines().count(), 3);
    // What was played is 4 dB weaker in each model than as it was recorded.
    let samples = |file: &str| {
        let mut wav = hound::WavReader::open(place.path(file)).unwrap();
        let peak = wav.samples::<f32>().map(|x| x.unwrap().abs()).fold(0.0, f32::max);
        (wav.duration() as f64 / f64::from(wav.spec().sample_rate), peak)
    };
    for trial in ["answers/Ann/trial-0001.wav", "answers/Ann/trial-0002.wav"] {
        let (seconds, peak) = samples(trial);
        assert!((seconds - 0.05).abs() < 1e-9 && peak > 0.0, "{trial}: {seconds} s, {peak}");
    }
}

#[test]
fn bad_studies_are_refused_with_code_and_place() {
    let cases: [(Edits<'_>, &str, &str, bool); 6] = [
        (&[("repetitions = 1", "repetition = 1")], "STUDY_UNKNOWN_KEY", "/repetition", true),
        (&[("htex_study = '1.0'", "")], "STUDY_VERSION_MISSING", "", true),
        (&[("repetitions = 1", "repetitions = ")], "STUDY_SYNTAX", "", true),
        (&[("vinyl.htex", "velvet.htex")], "ASSET_MISSING", "/textures/0/asset", false),
        (&[("'sbeta'", "'gamma'")], "REPRESENTATION_MISSING", "/models/1", false),
        (&[("'file'", "'fiel'")], "DEVICE_UNKNOWN", "/device/adapter", false),
    ];
    for (edits, code, pointer, is_text) in cases {
        let place = short(edits);
        let run = place.run(&["study", "validate", "study.toml", "--json"]);
        assert_eq!(run.code(), 1, "{code}");
        let report: serde_json::Value = serde_json::from_str(&run.text()).unwrap();
        let findings = report[0]["findings"].as_array().unwrap();
        let is_named = |f: &serde_json::Value| f["code"] == code && f["pointer"] == pointer;
        assert!(findings.iter().any(is_named), "{code}: {report}");
        let (exit, error) = typed(&place, "\n\n");
        assert!(exit == Some(1) && error.contains(code), "{code}: {error}");
        let plan = place.run(&["study", "plan", "study.toml"]);
        assert_eq!(plan.code(), i32::from(is_text), "{code}: {}", plan.error());
        assert!(!place.path("answers/Ann.jsonl").exists());
        let run = place.run(&["explain", code]);
        assert_eq!(run.code(), 0, "{code}");
    }
}

#[test]
fn combinations_that_cannot_work_are_refused() {
    let live = ("motion = { constant = { speed_mm_s = 80, force_n = 0.4 } }", "motion = 'live'");
    let noise = ("phases", "masking_noise = { level_dbfs = -30 }\nphases");
    let ann = ["--participant", "Ann"];
    let cases: [(Edits<'_>, &[&str], &str); 8] = [
        (&[], &["--participant", "Eve"], "no participant \"Eve\"; it has Ann, Bob"),
        (&[], &[], "--participant"),
        (&[], &["--participant", "Ann", "--fast"], "--simulated"),
        (&[], &["--participant", "Ann", "--motion", "-"], "not live"),
        (&[live], &ann, "the study's motion is live"),
        (&[live], &["--participant", "Ann", "--motion", "-"], "cannot be both"),
        (&[live], &["--participant", "Ann", "--motion", "page"], "needs --page"),
        (&[noise], &ann, "masking noise"),
    ];
    for (edits, arguments, words) in cases {
        let place = short(edits);
        let run = place.run(&[&["study", "run", "study.toml"], arguments].concat());
        assert_eq!(run.code(), 2, "{arguments:?}: {}", run.error());
        assert!(run.error().contains(words), "{words}: {}", run.error());
        assert!(!place.path("answers").exists());
    }
}

#[test]
fn statistics_are_said_to_be_in_the_python_package() {
    for words in [
        &["analyse", "--ratings", "r.csv", "--json"][..],
        &["power", "--effect", "-1"],
        &["analyse", "--help"],
    ] {
        let run = Place::new().run(&[&["study"], words].concat());
        assert_eq!((run.code(), run.text()), (2, String::new()), "{words:?}");
        assert!(run.error().contains("pip install htex[lab]"), "{}", run.error());
    }
}
