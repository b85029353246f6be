//! Studies as a laboratory runs them.
#![cfg(unix)]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod common;
#[path = "../../renderer-adapters/daq/tests/simulated/library.rs"]
mod simulated;

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use common::Place;
use htex_dsp::bands::pearson_correlation;

const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes");
const PAPER: &str = "pcie-6321_tabor-9200a_sct3250";
const SURFACES: [&str; 5] = [
    "coarse-fabric",
    "corrugated-paper",
    "fine-fabric",
    "sandpaper",
    "vinyl",
];

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

/// A run of simulated participants on the simulated card, whose input feels its output.
fn on_card(place: &Place, folder: &str, more: &[&str]) -> Command {
    static RUNS: AtomicUsize = AtomicUsize::new(0);
    let wire = place.path(&format!("wire-{}", RUNS.fetch_add(1, Ordering::Relaxed)));
    fs::create_dir(&wire).unwrap();
    let driver = format!("driver={}", simulated::built().display());
    let run = [
        "study",
        "run",
        "study.toml",
        "--simulated",
        "11",
        "--fast",
        "-o",
        folder,
    ];
    let card = ["--profile", PAPER, "--set", &driver];
    let felt = [
        "--source",
        "daq:Dev1/ai0",
        "--source-set",
        &driver,
        "--map",
        "lateral=ai0:0.1",
    ];
    let mut command = place.command(&[&run, &card[..], &felt, more].concat());
    command
        .env("NIDAQMX_SIM_CLOCK", "calls")
        .env("NIDAQMX_SIM_LOOPBACK", wire)
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    command
}

/// The answers of a folder by file name.
fn answers(folder: &Path) -> BTreeMap<String, String> {
    let files = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .map(Result::unwrap);
    let files = files.filter(|file| file.file_name().to_string_lossy().ends_with(".jsonl"));
    let read = |file: fs::DirEntry| {
        let name = file.file_name().to_string_lossy().into_owned();
        (name, fs::read_to_string(file.path()).unwrap())
    };
    files.map(read).collect()
}

/// The recordings of a participant and what is beside them, by file name.
fn felt(folder: &Path, participant: &str) -> BTreeMap<String, Vec<u8>> {
    let files = fs::read_dir(folder.join(participant).join("felt")).unwrap();
    let read = |file: std::io::Result<fs::DirEntry>| {
        let file = file.unwrap();
        let name = file.file_name().to_string_lossy().into_owned();
        (name, fs::read(file.path()).unwrap())
    };
    files.map(read).collect()
}

fn lines(folder: &Path) -> usize {
    answers(folder)
        .values()
        .map(|text| text.lines().count())
        .sum()
}

/// 14 participants, 5 textures, 5 models, 5 repetitions: study.toml to ratings and felt spectra. Two of the participants
/// also run elsewhere, killed five times on the way, with the same bytes.
#[test]
fn a_whole_study_has_the_same_bytes_however_often_it_is_killed() {
    let place = Place::new();
    assert_eq!(place.run(&["demo", "."]).code(), 0);
    place.write("study.toml", whole_study());
    let valid = place.run(&["study", "validate", "study.toml"]);
    assert_eq!(valid.code(), 0, "{}", valid.text());
    let plan = place.json(&["study", "plan", "study.toml", "--json"]);
    assert_eq!(plan["participants"].as_array().unwrap().len(), 14);
    // Participants are independent: several run at the same time.
    let names: Vec<String> = (1..=14).map(|i| format!("P{i:02}")).collect();
    for some in names.chunks(5) {
        let start = |name: &String| on_card(&place, "answers", &["--participant", name]).spawn();
        let running: Vec<_> = some.iter().map(start).collect();
        for child in running {
            let done = child.unwrap().wait_with_output().unwrap();
            assert!(
                done.status.success(),
                "{}",
                String::from_utf8_lossy(&done.stderr)
            );
        }
    }
    check_ratings(&place);
    check_spectra(&place);
    let whole = answers(&place.path("answers"));
    for (name, text) in &whole {
        assert!(
            text.lines().all(|line| line.contains("\"simulated\":")),
            "{name}"
        );
    }
    let killed = place.path("killed");
    for kill in 1..=5 {
        let name = ["P01", "P02"][kill % 2];
        let mut child = on_card(&place, "killed", &["--participant", name])
            .spawn()
            .unwrap();
        let (start, before) = (Instant::now(), lines(&killed));
        while lines(&killed) < before + 13 * kill && start.elapsed() < Duration::from_secs(120) {
            std::thread::sleep(Duration::from_millis(5));
        }
        child.kill().unwrap();
        assert!(
            !child.wait().unwrap().success(),
            "it ended before it was killed"
        );
    }
    for name in ["P01", "P02"] {
        let file = format!("{name}.jsonl");
        assert!(
            answers(&killed)[&file].len() < whole[&file].len(),
            "{name} was cut off"
        );
        let done = on_card(&place, "killed", &["--participant", name])
            .output()
            .unwrap();
        assert!(
            done.status.success(),
            "{}",
            String::from_utf8_lossy(&done.stderr)
        );
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
    assert!(
        table("killed", "P01") == table("answers", "P01"),
        "the spectra differ"
    );
}

/// The arguments of an export with the spectra of the demonstration's recordings.
fn exported<'a>(folder: &'a str, spectra: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let recorded = [
        "coarse-fabric=coarse-fabric.csv",
        "corrugated-paper=corrugated-paper.csv",
        "fine-fabric=fine-fabric.csv",
        "sandpaper=sandpaper.csv",
        "vinyl=vinyl.csv",
    ];
    let mut run = vec![
        "study",
        "export",
        folder,
        "--spectra",
        spectra,
        "--frf",
        "rig.csv",
    ];
    for text in recorded {
        run.extend(["--recorded", text]);
    }
    run.extend(more);
    run
}

/// Felt spectra are compared with those of the recordings, and every model is felt like its texture.
fn check_spectra(place: &Place) {
    let run = exported("answers", "spectra.csv", &["-o", "ratings.csv", "--json"]);
    assert_eq!(place.json(&run)["recordings"], 14 * 125);
    let spectra = fs::read_to_string(place.path("spectra.csv")).unwrap();
    assert_eq!(spectra.lines().count(), 1 + 14 * 25 + 5);
    let rows: Vec<(Vec<&str>, Vec<f64>)> = spectra.lines().skip(1).map(row).collect();
    let recorded = |texture: &str| {
        let found = rows
            .iter()
            .find(|(names, _)| names[..] == ["recorded", texture, "recorded"]);
        &found.unwrap().1
    };
    for model in ["ar", "mfcc", "sbeta", "speak", "sslope"] {
        let felt = rows.iter().filter(|(names, _)| names[2].ends_with(model));
        let felt: Vec<f64> = felt
            .map(|(names, felt)| pearson_correlation(felt, recorded(names[1])))
            .collect();
        assert_eq!(felt.len(), 14 * 5, "{model}");
        // Five segments of noise have a correlation of about 0.8 with a spectrum that they fit.
        let mean = felt.iter().sum::<f64>() / felt.len() as f64;
        assert!(mean > 0.7, "{model}: {mean}");
    }
}

/// A line of the table of spectra: participant, texture, model, and the magnitudes.
fn row(line: &str) -> (Vec<&str>, Vec<f64>) {
    let names: Vec<&str> = line.split(',').take(3).collect();
    let magnitudes = line.split(',').skip(3).map(|field| field.parse().unwrap());
    (names, magnitudes.collect())
}

/// The table has each rating once, in the columns that analyses read, and the planned best model is rated best.
fn check_ratings(place: &Place) {
    let table = place.json(&["study", "export", "answers", "-o", "ratings.csv", "--json"]);
    assert_eq!(table["ratings"], 14 * 5 * 5 * 5);
    assert_eq!(table["incomplete"].as_array().unwrap().len(), 0);
    let csv = fs::read_to_string(place.path("ratings.csv")).unwrap();
    let mut rows = csv.lines();
    assert!(
        rows.next()
            .unwrap()
            .starts_with("participant,texture,model,repetition,rating,")
    );
    let mut keys = std::collections::BTreeSet::new();
    let mut sums: BTreeMap<&str, f64> = BTreeMap::new();
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        assert!(keys.insert(cells[..4].join(",")), "{row}");
        assert!(
            cells[8].parse::<f64>().unwrap() < 0.0 && cells[9] == "yes",
            "{row}"
        );
        *sums.entry(cells[2]).or_default() += cells[4].parse::<f64>().unwrap();
    }
    assert_eq!(keys.len(), 14 * 5 * 5 * 5);
    // Simulated participants rate by the nine-band error: AR's is the smallest, that of sPeak's single lines the largest.
    let mean = |model: &str| sums[model] / (14.0 * 25.0);
    assert!(mean("ar") > 4.5 && mean("speak") < 1.5, "{sums:?}");
    assert!(
        mean("ar") > mean("sslope") && mean("sslope") > mean("speak"),
        "{sums:?}"
    );
}

const SHORT: &str = "
htex_study = '1.0'
participants = ['Ann', 'Bob']
models = ['ar', 'sbeta']
repetitions = 1
trial_s = 0.05
phases = ['gain', 'testing']
gain = { method = 'adjustment' }
motion = { constant = { speed_mm_s = 80, force_n = 0.4 } }
device = { adapter = 'file' }
[[textures]]
asset = 'vinyl.htex'
";

/// Texts, and what replaces them.
type Edits<'a> = &'a [(&'a str, &'a str)];

/// A study of one texture; `more` replaces texts of it.
fn short(more: Edits<'_>) -> Place {
    let place = Place::new();
    place.write(
        "vinyl.htex",
        fs::read(format!("{EXAMPLES}/vinyl.htex")).unwrap(),
    );
    let replaced = |text: String, (from, to): &(&str, &str)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    };
    place.write("study.toml", more.iter().fold(SHORT.to_owned(), replaced));
    place
}

/// Runs Ann's session with these lines of input: exit code, standard error.
fn typed(place: &Place, input: &str) -> (Option<i32>, String) {
    let mut command = place.command(&["study", "run", "study.toml", "--participant", "Ann"]);
    command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
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
    // Begin; 1 dB and 4 dB weaker, 1 dB stronger, accepted; begin, no rating of the scale, a rating; then the input ends.
    let (code, error) = typed(&place, "\n-\n--\n+\n\n\n7\n4\n");
    assert_eq!(code, Some(0), "{error}");
    assert!(
        error.contains("\"7\" is no answer") && error.contains("Ann is not done"),
        "{error}"
    );
    let text = fs::read_to_string(place.path("answers/Ann.jsonl")).unwrap();
    let kept: Vec<serde_json::Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let gains: Vec<f64> = kept
        .iter()
        .filter(|l| l["kind"] == "gain")
        .map(|l| l["gain_db"].as_f64().unwrap())
        .collect();
    assert_eq!(gains, [-1.0, -5.0, -4.0, -4.0]);
    assert_eq!(
        (&kept[6]["rating"], &kept[6]["gain_db"]),
        (&4.into(), &(-4.0).into())
    );
    assert!(kept.iter().all(|line| line.get("simulated").is_none()));
    // The session has its date, and the device as it was set.
    assert_eq!(kept[1]["kind"], "session");
    assert_eq!(kept[1]["device"], kept[0]["device"]);
    assert_eq!(
        kept[0]["device"]["settings"]["format"], "auto",
        "{}",
        kept[0]
    );
    let date = kept[1]["date"].as_str().unwrap();
    assert!(
        date.len() == 20 && date.starts_with("20") && date.ends_with('Z'),
        "{date}"
    );
    assert_eq!(
        kept[0]["begun"].as_str().map(|begun| &begun[..4]),
        Some(&date[..4])
    );
    let (code, error) = typed(&place, "\n2\n");
    assert_eq!(code, Some(0), "{error}");
    assert!(error.contains("[2/2] All trials are done"), "{error}");
    let run = place.run(&["study", "export", "answers", "-o", "ratings.csv"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    assert_eq!(
        fs::read_to_string(place.path("ratings.csv"))
            .unwrap()
            .lines()
            .count(),
        3
    );
    // What was played is 4 dB weaker in each model than as it was recorded.
    let samples = |file: &str| {
        let mut wav = hound::WavReader::open(place.path(file)).unwrap();
        let peak = wav
            .samples::<f32>()
            .map(|x| x.unwrap().abs())
            .fold(0.0, f32::max);
        (
            wav.duration() as f64 / f64::from(wav.spec().sample_rate),
            peak,
        )
    };
    for trial in ["answers/Ann/trial-0001.wav", "answers/Ann/trial-0002.wav"] {
        let (seconds, peak) = samples(trial);
        assert!(
            (seconds - 0.05).abs() < 1e-9 && peak > 0.0,
            "{trial}: {seconds} s, {peak}"
        );
    }
    // Another version of the study is refused, and nothing is lost.
    let before = fs::read(place.path("answers/Ann.jsonl")).unwrap();
    place.write(
        "study.toml",
        SHORT.replace("trial_s = 0.05", "trial_s = 0.06"),
    );
    let (code, error) = typed(&place, "\n2\n");
    assert_eq!(code, Some(1), "{error}");
    assert!(error.contains("study has changed since"), "{error}");
    assert_eq!(fs::read(place.path("answers/Ann.jsonl")).unwrap(), before);
}

#[test]
fn bad_studies_are_refused_with_code_and_place() {
    let cases: [(Edits<'_>, &str, &str, bool); 6] = [
        (
            &[("repetitions = 1", "repetition = 1")],
            "STUDY_UNKNOWN_KEY",
            "/repetition",
            true,
        ),
        (
            &[("htex_study = '1.0'", "")],
            "STUDY_VERSION_MISSING",
            "",
            true,
        ),
        (
            &[("repetitions = 1", "repetitions = ")],
            "STUDY_SYNTAX",
            "",
            true,
        ),
        (
            &[("vinyl.htex", "velvet.htex")],
            "ASSET_MISSING",
            "/textures/0/asset",
            false,
        ),
        (
            &[("'sbeta'", "'gamma'")],
            "REPRESENTATION_MISSING",
            "/models/1",
            false,
        ),
        (
            &[("'file'", "'fiel'")],
            "DEVICE_UNKNOWN",
            "/device/adapter",
            false,
        ),
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
    let live = (
        "motion = { constant = { speed_mm_s = 80, force_n = 0.4 } }",
        "motion = 'live'",
    );
    let noise = ("phases", "masking_noise = { level_dbfs = -30 }\nphases");
    let ann = ["--participant", "Ann"];
    let cases: [(Edits<'_>, &[&str], &str); 8] = [
        (
            &[],
            &["--participant", "Eve"],
            "no participant \"Eve\"; it has Ann, Bob",
        ),
        (&[], &[], "--participant"),
        (&[], &["--participant", "Ann", "--fast"], "--simulated"),
        (&[], &["--participant", "Ann", "--motion", "-"], "not live"),
        (&[live], &ann, "the study's motion is live"),
        (
            &[live],
            &["--participant", "Ann", "--motion", "-"],
            "cannot be both",
        ),
        (
            &[live],
            &["--participant", "Ann", "--motion", "page"],
            "needs --page",
        ),
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

/// A study of one texture on the simulated card.
fn on_card_short() -> Place {
    let card = "device = { adapter = 'daq', profile = 'pcie-6321_tabor-9200a_sct3250' }";
    short(&[
        ("device = { adapter = 'file' }", card),
        ("repetitions = 1", "repetitions = 2"),
        ("trial_s = 0.05", "trial_s = 0.25"),
    ])
}

#[test]
fn a_source_that_fails_ends_the_session_and_the_trial_is_repeated() {
    let place = on_card_short();
    let ann = ["--participant", "Ann"];
    let whole = on_card(&place, "whole", &ann).output().unwrap();
    assert!(
        whole.status.success(),
        "{}",
        String::from_utf8_lossy(&whole.stderr)
    );
    let expected = answers(&place.path("whole"));
    let faults = [
        ("DAQmxReadAnalogF64:20:error=-200279", "-200279"),
        ("DAQmxReadAnalogF64:30:unplug", "not present"),
        ("DAQmxCfgInputBuffer:3:error=-50103", "-50103"),
    ];
    for (number, (fault, words)) in faults.into_iter().enumerate() {
        let folder = format!("failed-{number}");
        let mut command = on_card(&place, &folder, &ann);
        let failed = command.env("NIDAQMX_SIM_FAULT", fault).output().unwrap();
        let error = String::from_utf8_lossy(&failed.stderr).into_owned();
        assert_eq!(failed.status.code(), Some(1), "{fault}: {error}");
        assert!(
            error.contains(words) && error.contains("what is felt"),
            "{error}"
        );
        let so_far = &answers(&place.path(&folder))["Ann.jsonl"];
        assert!(
            expected["Ann.jsonl"].starts_with(&so_far[..])
                && so_far.len() < expected["Ann.jsonl"].len()
        );
        let again = on_card(&place, &folder, &ann).output().unwrap();
        assert!(
            again.status.success(),
            "{}",
            String::from_utf8_lossy(&again.stderr)
        );
        assert_eq!(answers(&place.path(&folder)), expected, "{fault}");
        let found = felt(&place.path(&folder), "Ann");
        assert!(found == felt(&place.path("whole"), "Ann"), "{fault}");
    }
    // Answers with another source, and recordings that are not those of their trials.
    let other = on_card(
        &place,
        "whole",
        &["--participant", "Ann", "--format", "csv"],
    )
    .output()
    .unwrap();
    assert_eq!(other.status.code(), Some(1));
    let error = String::from_utf8_lossy(&other.stderr).into_owned();
    assert!(
        error.contains("source") && error.contains("format"),
        "{error}"
    );
    // Answers with another gain of the amplifier.
    let before = answers(&place.path("whole"));
    assert!(
        before["Ann.jsonl"].contains("\"amplifier_gain\":\"50\"")
            && before["Ann.jsonl"].contains("\"limit\":150")
    );
    let weaker = ["--participant", "Ann", "--set", "amplifier_gain=20"];
    let weaker = on_card(&place, "whole", &weaker).output().unwrap();
    let error = String::from_utf8_lossy(&weaker.stderr).into_owned();
    assert_eq!(weaker.status.code(), Some(1), "{error}");
    assert!(
        error.contains(
            "the device's setting amplifier_gain was 50, and is 20. Restore what was there"
        ),
        "{error}"
    );
    assert_eq!(answers(&place.path("whole")), before);
    // A device that runs dry in every attempt.
    let dry = on_card(&place, "dry", &ann)
        .env("NIDAQMX_SIM_FAULT", "DAQmxWriteAnalogF64:3:error=-200290")
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&dry.stderr).into_owned();
    assert_eq!(dry.status.code(), Some(1), "{error}");
    assert!(
        error.contains("the device ran dry, and gain-vinyl is played again")
            && error.contains("the device ran dry in 3 attempts of the same trial"),
        "{error}"
    );
    let export = [
        "study",
        "export",
        "whole",
        "-o",
        "r.csv",
        "--spectra",
        "s.csv",
    ];
    let run = place.run(&export);
    assert!(
        run.code() == 1 && run.error().contains("--recorded vinyl=FILE"),
        "{}",
        run.error()
    );
    // One of the recordings stands for the real texture.
    let trials = felt(&place.path("whole"), "Ann");
    let trials: Vec<&String> = trials
        .keys()
        .filter(|name| name.ends_with(".npy"))
        .collect();
    assert_eq!(trials.len(), 4, "{trials:?}");
    let recorded = format!("vinyl=whole/Ann/felt/{}", trials[0]);
    let real = [
        "--recorded",
        &recorded,
        "--map",
        "lateral=#1:1",
        "--rate",
        "20000",
    ];
    let run = place.run(&[&export[..], &real].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
    assert_eq!(
        fs::read_to_string(place.path("s.csv"))
            .unwrap()
            .lines()
            .count(),
        1 + 2 + 1
    );
    fs::write(place.path("whole/Ann/felt").join(trials[1]), b"other").unwrap();
    let run = place.run(&[&export[..], &real].concat());
    assert!(
        run.code() == 1 && run.error().contains("hash"),
        "{}",
        run.error()
    );
}

/// In real time, the recording begins when the output does and has the length of the trial; a source that ends too early is an error.
#[test]
fn a_person_is_recorded_from_the_beginning_of_each_trial() {
    let place = short(&[
        ("phases = ['gain', 'testing']", "phases = ['testing']"),
        ("trial_s = 0.05", "trial_s = 0.5"),
        ("gain = { method = 'adjustment' }", ""),
    ]);
    let rows = |seconds: usize| {
        // 0.6 N, where the study has 0.4 N.
        let row = |i: usize| format!("{},{},0.6\n", i as f64 / 2000.0, (i % 97) as f64 / 100.0);
        let rows: String = (0..2000 * seconds).map(row).collect();
        format!("time_s,lateral_N,normal_N\n{rows}")
    };
    place.write("felt.csv", rows(60));
    let run = |input: &str, source: &str| {
        let arguments = [
            "study",
            "run",
            "study.toml",
            "--participant",
            "Ann",
            "--source",
            source,
            "--format",
            "csv",
        ];
        let mut command = place.command(&arguments);
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
        let done = child.wait_with_output().unwrap();
        (done.status.code(), String::from_utf8(done.stderr).unwrap())
    };
    let (code, error) = run("\n4\n\n5\n", "file:felt.csv");
    assert_eq!(code, Some(0), "{error}");
    let text = fs::read_to_string(place.path("answers/Ann.jsonl")).unwrap();
    let lines: Vec<serde_json::Value> = text
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    assert_eq!(lines[0]["source"]["name"], "file:felt.csv");
    assert_eq!(lines[0]["source"]["signals"][0][0], "lateral");
    let answered = lines.iter().filter(|line| line["kind"] == "answer");
    let answered: Vec<_> = answered.collect();
    assert_eq!(answered.len(), 2);
    for line in answered {
        let file = line["felt"]["file"].as_str().unwrap();
        let bytes = fs::read(place.path("answers").join(file)).unwrap();
        assert_eq!(
            line["felt"]["blake3"],
            blake3::hash(&bytes).to_hex().as_str()
        );
        assert_eq!(
            String::from_utf8(bytes).unwrap().lines().count(),
            1 + 1000,
            "{file}"
        );
        let beside = fs::read(place.path("answers").join(file).with_extension("json")).unwrap();
        let beside: serde_json::Value = serde_json::from_slice(&beside).unwrap();
        assert_eq!(beside["trial"]["speed_mm_s"], 80.0);
        assert_eq!(beside["trial"]["texture"], line["texture"]);
    }
    // Each trial was off its target, which is said at once; its rating and its spectrum are exported all the same.
    assert!(
        error.contains("note: trial-0001 was off its target: force: mean 0.6000"),
        "{error}"
    );
    let spectra = |more: &[&str]| {
        let export = [
            "study",
            "export",
            "answers",
            "-o",
            "r.csv",
            "--spectra",
            "s.csv",
            "--json",
        ];
        let run = place.run(&[&export[..], &["--recorded", "vinyl=felt.csv"], more].concat());
        assert_eq!(run.code(), 0, "{}", run.error());
        let said: serde_json::Value = serde_json::from_str(&run.text()).unwrap();
        let rows = |file: &str| {
            fs::read_to_string(place.path(file))
                .unwrap()
                .lines()
                .skip(1)
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        (said, rows("r.csv"), rows("s.csv"), run.error())
    };
    let (said, ratings, felt, warned) = spectra(&[]);
    assert_eq!(
        (&said["off_target"], &said["recordings"]),
        (&2.into(), &2.into())
    );
    assert!(
        ratings.len() == 2 && ratings.iter().all(|row| row.ends_with(",no,yes")),
        "{ratings:?}"
    );
    assert_eq!(felt.len(), 2 + 1);
    assert!(
        warned.contains("Ann: 2 of 2 recorded trials were off"),
        "{warned}"
    );
    let (said, ratings, felt, warned) = spectra(&["--off-target", "leave-out"]);
    assert_eq!(
        (&said["off_target"], &said["recordings"]),
        (&2.into(), &0.into())
    );
    assert_eq!((ratings.len(), felt.len()), (2, 0));
    assert!(
        warned.contains("left out: there is no spectrum"),
        "{warned}"
    );
    // What stops the spectra costs no rating.
    fs::remove_file(place.path("r.csv")).unwrap();
    let export = [
        "study",
        "export",
        "answers",
        "-o",
        "r.csv",
        "--spectra",
        "s.csv",
    ];
    assert_eq!(place.run(&export).code(), 1);
    assert!(place.path("r.csv").exists());
    fs::remove_dir_all(place.path("answers")).unwrap();
    place.write(
        "short.csv",
        rows(1).lines().take(200).collect::<Vec<_>>().join("\n"),
    );
    let (code, error) = run("\n4\n\n5\n", "file:short.csv");
    assert_eq!(code, Some(1), "{error}");
    assert!(
        error.contains("the source ended") && error.contains("the trial is repeated"),
        "{error}"
    );
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
        assert!(
            run.error().contains("pip install htex[lab]"),
            "{}",
            run.error()
        );
    }
}
