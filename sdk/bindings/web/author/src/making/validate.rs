//! Checks files, and explains findings.

use std::path::Path;

use htex::model::Registry;
use htex_author::recording::{ReadOptions, rules};
use htex_author::{Exploration, SpectrumOptions, validate_recording_bytes};
use htex_base::finding::{FINDINGS_TRUNCATED, Report, Rule, Severity};
use htex_format::library::{EXTENSION, MAGIC, validate_source};
use htex_format::{Limits, Representation, validate_with};
use serde::Serialize;

use super::describe::{self, DescribedFinding};
use crate::answer::{Answer, Files};
use crate::document::Document;
use crate::refusal::Refusal;

#[derive(Serialize)]
struct ValidationAnswer<'a> {
    kind: &'static str,
    valid: bool,
    findings: Vec<DescribedFinding<'a>>,
}

/// Checks a texture, a library or a recording, which is the only file.
pub(crate) fn validate(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let name = call.text("name")?.unwrap_or_default();
    call.finish()?;
    let [bytes] = files else {
        return Err(Refusal::argument("give one file"));
    };
    let path = Path::new(&name);
    let extension = path.extension().unwrap_or_default();
    let called = |own: &str| extension.eq_ignore_ascii_case(own);
    let (kind, report) = if called(EXTENSION) || bytes.starts_with(&MAGIC) {
        let limits = htex_format::library::Limits::default();
        ("library", validate_source(*bytes, &limits)?)
    } else if called("htex") || bytes.starts_with(b"PK") || name.is_empty() {
        ("texture", of_texture(bytes))
    } else {
        ("recording", of_recording(path, bytes)?)
    };
    let validated = ValidationAnswer {
        kind,
        valid: report.valid,
        findings: describe::findings(&report.findings),
    };
    Answer::new(&validated, Vec::new())
}

fn of_texture(bytes: &[u8]) -> Report {
    let models = Registry::builtin();
    let known = |r: &Representation| {
        let model = htex::play::model_of(&models, r).ok()?;
        Some(model.descriptor())
    };
    validate_with(bytes, &Limits::default(), &known)
}

fn of_recording(path: &Path, bytes: &[u8]) -> Result<Report, Refusal> {
    let (read, spectrum) = (ReadOptions::default(), SpectrumOptions::default());
    let given = Exploration::default();
    Ok(validate_recording_bytes(path, bytes, &read, given, &spectrum)?)
}

#[derive(Serialize)]
struct RuleExplanation {
    code: &'static str,
    severity: Severity,
    summary: &'static str,
    explanation: &'static str,
    fix: &'static str,
    settings: Vec<&'static str>,
}

/// Returns the meaning of a finding's code, or `null` for an unknown code.
pub(crate) fn explain(mut call: Document, _: Files<'_>) -> Result<Answer, Refusal> {
    let code = call.text("code")?.unwrap_or_default();
    call.finish()?;
    let mut all = [htex_format::RULES, htex_format::library::RULES, rules::RULES]
        .into_iter()
        .flatten()
        .chain([FINDINGS_TRUNCATED]);
    let explained = all.find(|rule| rule.code == code).map(|rule: &Rule| RuleExplanation {
        code: rule.code,
        severity: rule.severity,
        summary: rule.summary,
        explanation: rule.explanation,
        fix: rule.fix,
        settings: describe::settings(rule.hint),
    });
    Answer::new(&explained, Vec::new())
}
