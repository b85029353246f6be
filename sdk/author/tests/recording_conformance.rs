//! The generated files for recordings are up to date, and valid recordings have no findings.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

#[path = "common/recordings.rs"]
mod recordings;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use htex_author::findings::{RULES, explain, findings_page};
use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::{Exploration, SpectrumOptions, Take, read_take};
use htex_format::Severity;
use recordings::cases;
use serde_json::Value;

const RENEW: &str = "stale: cargo run -p htex-author --example recording_pages";

fn spec() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec")
}

#[test]
fn every_recording_gets_its_report_and_every_code_has_a_recording() {
    let folder = spec().join("recording-conformance");
    let (mut expected, mut raised) = (BTreeSet::new(), BTreeSet::new());
    for case in cases() {
        let read = |name: &str| fs::read_to_string(folder.join(name)).expect(name);
        assert_eq!(read(&case.file()), case.text, "{} {RENEW}", case.name);
        assert_eq!(
            read(&case.report()),
            case.golden(&folder),
            "{} {RENEW}",
            case.name
        );
        let golden: Value = serde_json::from_str(&read(&case.report())).unwrap();
        let of = |finding: &Value, key: &str| finding[key].as_str().unwrap().to_owned();
        let findings = golden["findings"].as_array().unwrap();
        let own = case.name.to_uppercase();
        for finding in findings {
            let code = of(finding, "code");
            // Each case has only the finding of its own code.
            assert!(
                code == own || of(finding, "severity") == "info" || case.may_also_raise(&code),
                "{} raises {finding}",
                case.name
            );
            raised.insert(code);
        }
        let is_raised = findings.iter().any(|finding| of(finding, "code") == own);
        assert!(
            is_raised || case.name == "valid",
            "{}: {findings:?}",
            case.name
        );
        let worst = findings
            .iter()
            .any(|finding| of(finding, "severity") == "error");
        assert_eq!(golden["valid"], !worst, "{}", case.name);
        expected.extend([case.file(), case.report()]);
    }
    let names = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name());
    let found: BTreeSet<String> = names.map(|name| name.into_string().unwrap()).collect();
    assert_eq!(found, expected, "{RENEW}");
    let silent: Vec<_> = RULES
        .iter()
        .filter(|rule| !raised.contains(rule.code))
        .collect();
    assert!(silent.is_empty(), "{silent:?}");
    let page = fs::read_to_string(spec().join("recording-findings.md")).unwrap();
    assert_eq!(page, findings_page(), "{RENEW}");
    for rule in htex_format::RULES {
        assert!(
            explain(rule.code).is_none(),
            "{} is a code of assets too",
            rule.code
        );
    }
}

/// The simulated hand varies by a few percent, and the surfaces have knots and ribs: the only finding is a
/// sweep that is cut off.
#[test]
fn sound_recordings_at_any_rate_and_speed_have_no_warning() {
    let surfaces = [
        Surface::Sandpaper,
        Surface::FineFabric,
        Surface::CoarseFabric,
        Surface::CorrugatedPaper,
        Surface::Vinyl,
    ];
    for surface in surfaces {
        for (rate_hz, speed_mm_s, seed) in [
            (20_000.0, 80.0, 1),
            (2_000.0, 120.0, 2),
            (1_000.0, 160.0, 3),
        ] {
            let options = SimulationOptions {
                rate_hz,
                speed_mm_s,
                seed,
                ..SimulationOptions::new(surface)
            };
            let recording = simulate(&options).unwrap().to_recording("sound").unwrap();
            let target = Exploration {
                speed_mm_s: Some(speed_mm_s),
                force_n: Some(0.4),
            };
            for given in [target, Exploration::default()] {
                let take = Take {
                    recording: recording.clone(),
                    given,
                };
                let reading = read_take(&take, &SpectrumOptions::default(), false).unwrap();
                assert!(reading.part.segments.from_sweeps);
                let grave: Vec<_> = reading
                    .findings
                    .iter()
                    .filter(|f| f.severity != Severity::Info)
                    .collect();
                assert!(
                    grave.is_empty(),
                    "{surface} {rate_hz} {speed_mm_s}: {grave:?}"
                );
            }
        }
    }
}
