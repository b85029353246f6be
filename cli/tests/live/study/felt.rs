//! Studies in which what is felt is recorded during each trial.

use std::fs;
use std::io::Write;
use std::process::Stdio;

use crate::common::{Place, words};
use crate::studies::*;

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
    assert!(whole.status.success(), "{}", String::from_utf8_lossy(&whole.stderr));
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
        assert!(error.contains(words) && error.contains("what is felt"), "{error}");
        // A source that cannot be opened stops nothing that plays.
        let stops = fault.starts_with("DAQmxRead");
        let text = &answers(&place.path(&folder))["Ann.jsonl"];
        assert_eq!(text.contains("\"reason\":\"failed\""), stops, "{fault}: {text}");
        let so_far = &unstopped(&place.path(&folder))["Ann.jsonl"];
        assert!(
            expected["Ann.jsonl"].starts_with(&so_far[..])
                && so_far.len() < expected["Ann.jsonl"].len()
        );
        let again = on_card(&place, &folder, &ann).output().unwrap();
        assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
        assert_eq!(unstopped(&place.path(&folder)), expected, "{fault}");
        let found = felt(&place.path(&folder), "Ann");
        assert!(found == felt(&place.path("whole"), "Ann"), "{fault}");
    }
    // Answers with another source, and recordings that do not belong to their trials.
    let other =
        on_card(&place, "whole", &["--participant", "Ann", "--format", "csv"]).output().unwrap();
    assert_eq!(other.status.code(), Some(1));
    let error = String::from_utf8_lossy(&other.stderr).into_owned();
    assert!(error.contains("source") && error.contains("format"), "{error}");
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
    // A longer buffer is no other device: the motion is not live, and the session goes on.
    assert!(!before["Ann.jsonl"].contains("buffer_ms"));
    let patient = ["--participant", "Ann", "--set", "buffer_ms=380"];
    let patient = on_card(&place, "whole", &patient).output().unwrap();
    let error = String::from_utf8_lossy(&patient.stderr).into_owned();
    assert!(patient.status.success(), "{error}");
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
    let export = ["study", "export", "whole", "-o", "r.csv", "--spectra", "s.csv"];
    let run = place.run(&export);
    assert!(run.code() == 1 && run.error().contains("--recorded vinyl=FILE"), "{}", run.error());
    // One of the recordings stands for the real texture.
    let trials = felt(&place.path("whole"), "Ann");
    let trials: Vec<&String> = trials.keys().filter(|name| name.ends_with(".npy")).collect();
    assert_eq!(trials.len(), 4, "{trials:?}");
    let recorded = format!("vinyl=whole/Ann/felt/{}", trials[0]);
    let real = ["--recorded", &recorded, "--map", "lateral=#1:1", "--rate", "20000"];
    let run = place.run(&[&export[..], &real].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
    assert_eq!(fs::read_to_string(place.path("s.csv")).unwrap().lines().count(), 1 + 2 + 1);
    fs::write(place.path("whole/Ann/felt").join(trials[1]), b"other").unwrap();
    let run = place.run(&[&export[..], &real].concat());
    assert!(run.code() == 1 && run.error().contains("hash"), "{}", run.error());
}

/// In real time, the recording begins when the output does and has the length of the trial; a
/// source that ends too early is an error.
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
        let line = format!("study run study.toml --participant Ann --source {source} --format csv");
        let mut command = place.command(&words(&line));
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
        let done = child.wait_with_output().unwrap();
        (done.status.code(), String::from_utf8(done.stderr).unwrap())
    };
    let (code, error) = run("\n4\n\n5\n", "file:felt.csv");
    assert_eq!(code, Some(0), "{error}");
    let text = fs::read_to_string(place.path("answers/Ann.jsonl")).unwrap();
    let lines: Vec<serde_json::Value> =
        text.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    assert_eq!(lines[0]["source"]["name"], "file:felt.csv");
    assert_eq!(lines[0]["source"]["signals"][0][0], "lateral");
    let answered = lines.iter().filter(|line| line["kind"] == "answer");
    let answered: Vec<_> = answered.collect();
    assert_eq!(answered.len(), 2);
    for line in answered {
        let file = line["felt"]["file"].as_str().unwrap();
        let bytes = fs::read(place.path("answers").join(file)).unwrap();
        assert_eq!(line["felt"]["blake3"], blake3::hash(&bytes).to_hex().as_str());
        assert_eq!(String::from_utf8(bytes).unwrap().lines().count(), 1 + 1000, "{file}");
        let beside = fs::read(place.path("answers").join(file).with_extension("json")).unwrap();
        let beside: serde_json::Value = serde_json::from_slice(&beside).unwrap();
        assert_eq!(beside["trial"]["speed_mm_s"], 80.0);
        assert_eq!(beside["trial"]["texture"], line["texture"]);
    }
    // Each trial was off its target. The command says so at once, and still exports its rating and
    // its spectrum.
    assert!(error.contains("note: trial-0001 was off its target: force: mean 0.6000"), "{error}");
    let spectra = |more: &[&str]| {
        let export = ["study", "export", "answers", "-o", "r.csv", "--spectra", "s.csv", "--json"];
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
    assert_eq!((&said["off_target"], &said["recordings"]), (&2.into(), &2.into()));
    assert!(
        ratings.len() == 2 && ratings.iter().all(|row| row.ends_with(",no,yes")),
        "{ratings:?}"
    );
    assert_eq!(felt.len(), 2 + 1);
    assert!(warned.contains("Ann: 2 of 2 trials whose motion was measured were off"), "{warned}");
    let (said, ratings, felt, warned) = spectra(&["--off-target", "leave-out"]);
    assert_eq!((&said["off_target"], &said["recordings"]), (&2.into(), &0.into()));
    assert_eq!((ratings.len(), felt.len()), (2, 0));
    assert!(warned.contains("left out: there is no spectrum"), "{warned}");
    // What stops the spectra costs no rating.
    fs::remove_file(place.path("r.csv")).unwrap();
    let export = ["study", "export", "answers", "-o", "r.csv", "--spectra", "s.csv"];
    assert_eq!(place.run(&export).code(), 1);
    assert!(place.path("r.csv").exists());
    fs::remove_dir_all(place.path("answers")).unwrap();
    place.write("short.csv", rows(1).lines().take(200).collect::<Vec<_>>().join("\n"));
    let (code, error) = run("\n4\n\n5\n", "file:short.csv");
    assert_eq!(code, Some(1), "{error}");
    assert!(
        error.contains("the source ended") && error.contains("the trial is repeated"),
        "{error}"
    );
}
