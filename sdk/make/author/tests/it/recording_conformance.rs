//! The conformance recordings in `spec/` with their reports, the page of findings, and valid
//! recordings without findings.

use crate::common::recordings;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use htex_author::findings::{RULES, findings_page};
use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::{Exploration, SpectrumOptions, Take, segment_take};
use htex_base::finding::Severity;
use recordings::cases;
use serde_json::Value;
use xtask::generated::{file, folder};

const FOLDER: &str = "spec/recording-conformance";
/// Codes that need several recordings, or parts of one recording.
const OF_FITS: [&str; 2] = ["GRID_NOT_BETTER", "RECORDING_LEVELS_DIFFER"];

/// [`FOLDER`], relative to this package's folder, in which tests run.
fn conformance() -> PathBuf {
    Path::new("../../..").join(FOLDER)
}

#[test]
fn generated_recordings_reports_and_page_are_fresh() {
    let mut files = Vec::new();
    for case in cases() {
        let recording = (format!("{FOLDER}/{}", case.file()), case.text.as_bytes().to_vec());
        // The report is made from the recording's file, so the file comes first.
        file(&recording.0, &recording.1);
        let report = case.golden(&conformance()).into_bytes();
        files.extend([recording, (format!("{FOLDER}/{}", case.report()), report)]);
    }
    folder(FOLDER, &files);
    file("spec/recording-findings.md", findings_page().as_bytes());
}

#[test]
fn recordings_raise_the_code_they_are_named_after_and_every_code_has_one() {
    let mut raised = BTreeSet::new();
    for case in cases() {
        let golden: Value = serde_json::from_str(&case.golden(&conformance())).unwrap();
        let of = |finding: &Value, key: &str| finding[key].as_str().unwrap().to_owned();
        let findings = golden["findings"].as_array().unwrap();
        let own = case.code();
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
        assert!(is_raised || case.name == "valid", "{}: {findings:?}", case.name);
        let worst = findings.iter().any(|finding| of(finding, "severity") == "error");
        assert_eq!(golden["valid"], !worst, "{}", case.name);
    }
    let silent: Vec<_> = RULES
        .iter()
        // Codes of several recordings come from fits (tested in `grid.rs` and below).
        .filter(|rule| !raised.contains(rule.code) && !OF_FITS.contains(&rule.code))
        .collect();
    assert!(silent.is_empty(), "{silent:?}");
}

/// The simulated hand varies by a few percent, and the surfaces have knots and ribs. The only
/// finding is a sweep that is cut off.
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
        for (rate_hz, speed_mm_s, seed) in
            [(20_000.0, 80.0, 1), (2_000.0, 120.0, 2), (1_000.0, 160.0, 3)]
        {
            let options = SimulationOptions::new(surface)
                .with_rate_hz(rate_hz)
                .with_speed_mm_s(speed_mm_s)
                .with_seed(seed);
            let recording = simulate(&options).unwrap().to_recording("sound").unwrap();
            let target = Exploration { speed_mm_s: Some(speed_mm_s), force_n: Some(0.4) };
            for given in [target, Exploration::default()] {
                let take = Take { recording: recording.clone(), given };
                let reading = segment_take(&take, &SpectrumOptions::default(), false).unwrap();
                assert!(reading.spectra.segments.from_sweeps);
                let grave: Vec<_> =
                    reading.findings.iter().filter(|f| f.severity != Severity::Info).collect();
                assert!(grave.is_empty(), "{surface} {rate_hz} {speed_mm_s}: {grave:?}");
            }
        }
    }
}

/// A fit that averages two recordings of one condition finds that their levels differ; a strict fit
/// refuses them.
#[test]
fn recordings_of_one_condition_with_different_levels_are_found() {
    let take = |gain: f64, name: &str| {
        let simulation = simulate(&SimulationOptions::new(Surface::Vinyl).with_rate_hz(2000.0));
        let mut recording = simulation.unwrap().to_recording(name).unwrap();
        let values = recording.axes.iter_mut().flatten();
        values.for_each(|x| *x *= gain);
        let given = Exploration { speed_mm_s: Some(80.0), force_n: Some(0.4) };
        Take { recording, given }
    };
    let registry = htex_host::Registry::builtin();
    let fit = |gains: &[f64], strict: bool| {
        let names = ["one", "two", "three"];
        let takes: Vec<Take> = gains.iter().zip(names).map(|(g, n)| take(*g, n)).collect();
        let models = vec![htex_author::ModelRequest::new(registry.find("bands").unwrap())];
        let request =
            htex_author::AssetRequest::new("vinyl").with_models(models).with_strict(strict);
        htex_author::fit_asset(&takes, &request)
    };
    let found = |gains: &[f64]| -> Vec<String> {
        let fitted = fit(gains, false).unwrap();
        let all = fitted.findings.iter();
        let differ = all.filter(|f| f.finding.code == "RECORDING_LEVELS_DIFFER");
        differ.map(|f| f.recording.clone()).collect()
    };
    // Level differences of 6 dB, which recordings of one material may have, and of 10 and 20 dB.
    assert!(found(&[1.0, 0.5]).is_empty());
    assert_eq!(found(&[1.0, 0.316]), ["two"]);
    assert_eq!(found(&[0.1, 1.0]), ["one"]);
    assert_eq!(found(&[1.0, 1.0, 10.0]), ["three"]);
    assert!(fit(&[1.0, 0.1], true).unwrap_err().to_string().contains("RECORDING_LEVELS_DIFFER"));
}
