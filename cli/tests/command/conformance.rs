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
