//! The specification's conformance files, through the command: one process for all files of a
//! format.

use crate::common::{Place, entries};
use serde_json::Value;

/// Reports of a command on files of a folder, each with its exit status as one of all.
fn reports(folder: &str, arguments: &[&str], files: &[&str]) -> Vec<Value> {
    let place = Place::new();
    let mut command = place.command(&[arguments, &["--json"], files].concat());
    let output = command.current_dir(folder).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    let reports: Vec<Value> =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{files:?}: {error}"));
    let all_valid = reports.iter().all(|report| report["valid"] == true);
    assert_eq!(output.status.code(), Some(i32::from(!all_valid)), "{files:?}: {error}");
    reports
}

/// The findings of a report without some keys.
fn findings(report: &Value, left_out: &[&str]) -> Value {
    let mut findings = report["findings"].clone();
    for finding in findings.as_array_mut().unwrap() {
        finding.as_object_mut().unwrap().retain(|key, _| !left_out.contains(&key.as_str()));
    }
    findings
}

#[test]
fn the_conformance_files_validate_as_their_reports_say() {
    let explained = Place::new().run(&["explain"]).text();
    let validate = ["validate"];
    for (folder, least, arguments, left_out) in [
        // The command also validates documents against their schema, and names its rule.
        ("conformance", 20, &validate[..], &["schema_rule"][..]),
        // The list of devices in a message is this program's.
        ("scene-conformance", 40, &validate, &["schema_rule", "message"]),
        ("recording-conformance", 15, &validate, &[]),
        ("library-conformance", 50, &validate, &[]),
        ("library-conformance", 50, &["lib", "verify"], &[]),
    ] {
        let folder = format!("{}/../spec/{folder}", env!("CARGO_MANIFEST_DIR"));
        let mut golden: Vec<Value> = entries(folder.as_ref())
            .iter()
            .filter(|name| name.ends_with(".report.json"))
            .map(|name| std::fs::read(format!("{folder}/{name}")).unwrap())
            .map(|report| serde_json::from_slice(&report).unwrap())
            .collect();
        // Reported under smaller limits than the command's.
        golden.retain(|report| report.get("limits").is_none());
        assert!(golden.len() > least, "{folder}: {}", golden.len());
        // Together with all others that are read without flags; and one of each alone, and each
        // that is read with flags.
        let flags = |report: &Value| -> Vec<String> {
            serde_json::from_value(report["arguments"].clone()).unwrap_or_default()
        };
        let together = golden.iter().filter(|report| flags(report).is_empty());
        let mut sets = vec![together.collect::<Vec<_>>()];
        for valid in [true, false] {
            sets.push(vec![golden.iter().find(|report| report["valid"] == valid).unwrap()]);
        }
        sets.extend(golden.iter().filter(|report| !flags(report).is_empty()).map(|r| vec![r]));
        for set in sets {
            let files: Vec<&str> = set.iter().map(|r| r["file"].as_str().unwrap()).collect();
            let flags = flags(set[0]);
            let flags: Vec<&str> = flags.iter().map(String::as_str).collect();
            let got = reports(&folder, &[arguments, &flags].concat(), &files);
            assert_eq!(got.len(), set.len());
            for (got, golden) in got.iter().zip(set) {
                let name = &golden["file"];
                assert_eq!((&got["file"], &got["valid"]), (name, &golden["valid"]));
                let mut found = findings(got, left_out);
                if golden["valid"] == false {
                    // The command also finds what breaks its schema after the first wrong value.
                    found.as_array_mut().unwrap().retain(|f| f["code"] != "SCHEMA_BROKEN");
                }
                assert_eq!(found, findings(golden, left_out), "{name}");
                for finding in golden["findings"].as_array().unwrap() {
                    assert!(explained.contains(finding["code"].as_str().unwrap()), "{finding}");
                }
            }
        }
        if folder.ends_with("recording-conformance") {
            strict_refuses_warnings(&folder, &golden);
        }
    }
}

fn strict_refuses_warnings(folder: &str, golden: &[Value]) {
    let is_clean = |report: &Value| {
        let mut findings = report["findings"].as_array().unwrap().iter();
        findings.all(|finding| finding["severity"] == "info")
    };
    let place = Place::new();
    for report in golden.iter().filter(|report| report["valid"] == true) {
        let flags = report["arguments"].as_array().unwrap().iter().map(|a| a.as_str().unwrap());
        let mut command = place.command(&["validate", "--strict"]);
        let run = command.args(flags).arg(report["file"].as_str().unwrap());
        let code = run.current_dir(folder).output().unwrap().status.code();
        assert_eq!(code, Some(i32::from(!is_clean(report))), "{}", report["file"]);
    }
}

const SPEC: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec");

/// Runs a reader on the conformance files, and returns the report.
fn reader(command: &str, more: &[&str]) -> Value {
    let place = Place::new();
    let arguments = ["conformance", "run", "--files", SPEC, "--json", "--command", command];
    let run = place.run(&[&arguments[..], more].concat());
    let report: Value =
        serde_json::from_str(&run.text()).unwrap_or_else(|_| panic!("{}", run.error()));
    assert_eq!(run.code(), i32::from(report["passed"] != true), "{report:#}");
    report
}

/// Each count of the matrix is whole, and every class has one for each part that concerns it.
fn passes(report: &Value, cells: usize) {
    assert_eq!(report["differences"], serde_json::json!([]));
    assert_eq!(report["passed"], true);
    let mut counts = 0;
    for row in report["matrix"]["rows"].as_array().unwrap() {
        for (part, count) in row["counts"].as_object().unwrap() {
            assert_eq!(count["passed"], count["all"], "{part}");
            assert!(count["all"].as_u64().unwrap() > 10, "{part}: {count}");
            counts += 1;
        }
    }
    assert_eq!(counts, cells);
    assert_eq!(report["left_out"].as_array().unwrap().len(), 0);
}

/// This program as a third-party reader: with and without the few files that have options.
#[test]
fn this_program_passes_as_a_reader() {
    let own = format!("'{}' conformance answer {{part}} {{file}}", env!("CARGO_BIN_EXE_htex"));
    let report = reader(&format!("{own} --options {{options}}"), &["--jobs", "4"]);
    passes(&report, 5 + 5 + 2);
    let place = Place::new();
    let arguments = ["conformance", "run", "--files", SPEC, "--command", &own];
    let more = ["--part", "libraries,playing", "--badge", "badge.svg", "--markdown"];
    let run = place.run(&[&arguments[..], &more].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
    assert!(run.text().starts_with("| class | libraries | playing |\n"), "{}", run.text());
    assert!(!run.text().contains("- `"), "{}", run.text());
    let badge = std::fs::read_to_string(place.path("badge.svg")).unwrap();
    assert!(badge.starts_with("<svg ") && badge.contains(" passed</text>"), "{badge}");
    // Files are looked for beside the command, where a build has none.
    let run = place.run(&["conformance", "run", "--command", &own]);
    run.failed(2, &["the conformance files are not in", "--files DIR"]);
    let run = place.run(&["conformance", "run", "--files", SPEC, "--command", "reader"]);
    run.failed(2, &["has no `{file}` among its arguments"]);
    let run = place.run(&["conformance", "run", "--files", SPEC, "--command", "/absent {file}"]);
    run.failed(2, &["the command `/absent {file}` cannot be started"]);
}

/// The reader and player in Python that was written from the specifications alone. Starting it for
/// each file takes minutes, so this is a sample; another test compares it in one process.
#[test]
fn the_independent_reader_passes_as_a_process() {
    let python = xtask::bench::python().filter(|python| {
        let mut imports = std::process::Command::new(python);
        let output = imports.args(["-c", "import blake3, cryptography, jsonschema"]).output();
        output.is_ok_and(|output| output.status.success())
    });
    if !xtask::needs::PEERS.met(python.is_some()) {
        return;
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/peers/conformance_reader.py");
    let python = python.unwrap().display().to_string();
    let command = format!("'{python}' -B '{script}' {{part}} {{file}} {{options}}");
    let some = ["--part", "recordings,baked", "--jobs", "4", "--timeout", "120"];
    passes(&reader(&command, &some), 2 + 2 + 1);
}

/// A reader that finds nothing is told of each invalid file.
#[cfg(unix)]
#[test]
fn a_reader_that_accepts_everything_fails() {
    let yes = r#"sh -c 'echo "{\"verdict\": \"valid\", \"findings\": []}"' {file}"#;
    let report = reader(yes, &["--part", "libraries", "--class", "reader"]);
    let count = &report["matrix"]["rows"][0]["counts"]["libraries"];
    let differences = report["differences"].as_array().unwrap();
    let missed = count["all"].as_u64().unwrap() - count["passed"].as_u64().unwrap();
    assert_eq!(missed, differences.len() as u64);
    assert!(missed > 50, "{missed}");
    let place = Place::new();
    let arguments =
        ["conformance", "run", "--files", SPEC, "--part", "libraries", "--command", yes];
    let run = place.run(&arguments);
    assert_eq!(run.code(), 1);
    let first = "library-conformance/library_asset_changed.htexlib (validator): findings: no finding \
         instead of LIBRARY_ASSET_CHANGED";
    assert!(run.text().starts_with(first), "{}", run.text());
}
