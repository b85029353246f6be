//! Converts findings, warnings, notes and spectra to JSON documents. Each finding, warning or note
//! names the settings that may solve its problem.

use htex_author::TextureSpectrum;
use htex_base::finding::{Finding, Hint, Notice, Severity};
use htex_format::Quantity;
use serde::Serialize;

/// Returns the settings that a hint suggests, with their names in the tables of settings. The hint
/// itself uses the names of command-line flags.
pub(crate) fn settings(hint: Hint) -> Vec<&'static str> {
    let named = |flag: &&'static str| match *flag {
        "rate" => "rate_hz",
        "from" => "from_s",
        "to" => "to_s",
        "speed" => "speed_mm_s",
        "force" => "force_n",
        "most_numbers" => "most_values",
        at if at.starts_with("at") => "conditions",
        other => other,
    };
    hint.settings().iter().map(named).collect()
}

#[derive(Serialize)]
pub(crate) struct DescribedFinding<'a> {
    code: &'a str,
    severity: Severity,
    pointer: &'a str,
    message: &'a str,
    settings: Vec<&'static str>,
}

pub(crate) fn finding(finding: &Finding) -> DescribedFinding<'_> {
    DescribedFinding {
        code: &finding.code,
        severity: finding.severity,
        pointer: &finding.pointer,
        message: &finding.message,
        settings: settings(finding.hint),
    }
}

pub(crate) fn findings(all: &[Finding]) -> Vec<DescribedFinding<'_>> {
    all.iter().map(finding).collect()
}

/// A warning or a note.
#[derive(Serialize)]
pub(crate) struct DescribedNotice<'a> {
    text: &'a str,
    settings: Vec<&'static str>,
}

impl<'a> DescribedNotice<'a> {
    fn new(notice: &'a Notice) -> Self {
        Self { text: &notice.text, settings: settings(notice.hint) }
    }
}

pub(crate) fn notices(all: &[Notice]) -> Vec<DescribedNotice<'_>> {
    all.iter().map(DescribedNotice::new).collect()
}

#[derive(Serialize)]
pub(crate) struct DescribedSpectrum<'a> {
    frequency_hz: &'a [f64],
    magnitude: &'a [f64],
    quantity: Quantity,
    unit: &'static str,
    band_hz: [f64; 2],
    segments: usize,
    repeatability_rms_db: Option<f64>,
}

pub(crate) fn spectrum(spectrum: &TextureSpectrum) -> DescribedSpectrum<'_> {
    DescribedSpectrum {
        frequency_hz: &spectrum.frequency_hz,
        magnitude: &spectrum.magnitude,
        quantity: spectrum.quantity,
        unit: spectrum.quantity.unit(),
        band_hz: [spectrum.band.low_hz, spectrum.band.high_hz],
        segments: spectrum.segments,
        repeatability_rms_db: spectrum.repeatability_rms_db(),
    }
}
