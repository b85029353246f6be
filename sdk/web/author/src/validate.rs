//! Checks of files, and what their findings mean.

use std::path::Path;

use htex::host::Registry;
use htex_author::Exploration;
use htex_author::recording::{ReadOptions, rules};
use htex_author::{SpectrumOptions, validate_recording_bytes};
use htex_finding::{FINDINGS_TRUNCATED, Rule};
use htex_format::{Limits, Representation, validate_with};
use htex_library::{EXTENSION, MAGIC};
use serde::Deserialize;
use serde_json::json;

use crate::call::{Answer, Files, parsed};
use crate::describe;
use crate::refusal::Refusal;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Validate {
    /// Its name, whose extension tells what it is where its bytes do not.
    #[serde(default)]
    name: String,
}

/// Validates a texture, a library or a recording, the file.
pub(crate) fn validate(json: &[u8], files: Files<'_>) -> Result<Answer, Refusal> {
    let call: Validate = parsed(json)?;
    let [bytes] = files else {
        return Err(Refusal::argument("give one file"));
    };
    let path = Path::new(&call.name);
    let called = |extension: &str| {
        path.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(extension))
    };
    let (kind, report) = if called(EXTENSION) || bytes.starts_with(&MAGIC) {
        (
            "library",
            htex_library::validate_source(*bytes, &htex_library::Limits::default())?,
        )
    } else if called("htex") || bytes.starts_with(b"PK") || call.name.is_empty() {
        ("texture", of_texture(bytes))
    } else {
        let (options, spectrum) = (ReadOptions::default(), SpectrumOptions::default());
        let given = Exploration::default();
        (
            "recording",
            validate_recording_bytes(path, bytes, &options, given, &spectrum)?,
        )
    };
    let findings = describe::findings(&report.findings);
    Answer::new(
        &json!({ "kind": kind, "valid": report.valid, "findings": findings }),
        Vec::new(),
    )
}

fn of_texture(bytes: &[u8]) -> htex_finding::Report {
    let models = Registry::builtin();
    let known = |r: &Representation| {
        let model = htex::model_of(&models, r).ok()?;
        Some(model.descriptor())
    };
    validate_with(bytes, &Limits::default(), &known)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Explain {
    code: String,
}

/// What the code of a finding means; `null` for one that is not known.
pub(crate) fn explain(json: &[u8], _: Files<'_>) -> Result<Answer, Refusal> {
    let call: Explain = parsed(json)?;
    let all = [htex_format::RULES, htex_library::RULES, rules::RULES];
    let mut all = all.into_iter().flatten().chain([FINDINGS_TRUNCATED]);
    let explained = all.find(|rule| rule.code == call.code).map(|rule: &Rule| {
        json!({
            "code": rule.code,
            "severity": rule.severity,
            "summary": rule.summary,
            "explanation": rule.explanation,
            "fix": rule.fix,
            "settings": rule.hint.settings(),
        })
    });
    Answer::new(&explained, Vec::new())
}
