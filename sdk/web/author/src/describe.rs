//! Findings, notices and spectra as JSON, with what helps.

use htex_author::TextureSpectrum;
use htex_finding::{Finding, Hint, Notice};
use serde_json::{Value, json};

fn settings(hint: Hint) -> Vec<&'static str> {
    hint.settings().to_vec()
}

/// A finding; `settings` are those that help.
pub(crate) fn finding(finding: &Finding) -> Value {
    json!({
        "code": finding.code,
        "severity": finding.severity,
        "pointer": finding.pointer,
        "message": finding.message,
        "settings": settings(finding.hint),
    })
}

pub(crate) fn findings(all: &[Finding]) -> Vec<Value> {
    all.iter().map(finding).collect()
}

/// Warnings or notes, each with the settings that help.
pub(crate) fn notices(all: &[Notice]) -> Vec<Value> {
    let one = |notice: &Notice| json!({ "text": notice.text, "settings": settings(notice.hint) });
    all.iter().map(one).collect()
}

pub(crate) fn spectrum(spectrum: &TextureSpectrum) -> Value {
    json!({
        "frequency_hz": spectrum.frequency_hz,
        "magnitude": spectrum.magnitude,
        "quantity": spectrum.quantity,
        "unit": spectrum.quantity.unit(),
        "band_hz": [spectrum.band.low_hz, spectrum.band.high_hz],
        "segments": spectrum.segments,
        "repeatability_rms_db": spectrum.repeatability_rms_db,
    })
}
