//! Reading of a recording: the spectra of its segments, its condition and its findings.

use std::path::Path;

use htex_base::finding::{Finding, Findings, Notice, Report, Severity};

use crate::exploration::{exploration, keep_on_target};
use crate::findings::{
    RECORDING_NOTED, RECORDING_UNREADABLE, RECORDING_UNUSABLE, judge_segments, recording_findings,
};
use crate::spectrum::{Trend, spectra_of};
use crate::take::Take;
use crate::{AuthorError, Exploration, Recording, SegmentSpectra, SpectrumOptions, Spread};
use htex_recording::{ReadError, ReadOptions, ReadProblem, read_recording, recording_from_bytes};

/// The result of reading a recording.
#[derive(Debug, Clone)]
pub struct Reading {
    pub part: SegmentSpectra,
    /// Speed and force: the given values, or else the medians of the measured ones over the
    /// segments.
    pub condition: Exploration,
    /// Ranges of speed and force over the segments.
    pub spread: Spread,
    /// All findings, in the order of `spec/recording-findings.md`.
    pub findings: Vec<Finding>,
    /// The reader's warnings, and the findings that are errors or warnings, as sentences.
    pub warnings: Vec<Notice>,
    /// The findings of severity info, as sentences.
    pub notes: Vec<Notice>,
}

/// Reads the texture of a recording: checks its signals, chooses its segments, removes segments
/// whose motion differs from the given condition by more than 10 %, and computes their spectra.
///
/// # Errors
/// When the recording is too short, its sample rate is too low, no segment remains, the setup's
/// response cannot be divided by, or a speed or force is out of range. With `strict`, also when a
/// finding is an error or a warning.
pub fn read_take(
    take: &Take,
    options: &SpectrumOptions,
    strict: bool,
) -> Result<Reading, AuthorError> {
    let recording = &take.recording;
    let mut of_segments = Findings::default();
    let part = spectra_of(recording, options, Trend::Mean, |segments| {
        keep_on_target(recording, segments, take.given, &mut of_segments)
    })?;
    judge_segments(recording, &part, &mut of_segments);
    let (condition, spread) = exploration(recording, &part.segments, take.given, &mut of_segments)?;
    // In the specification the findings of signals come first, so those of segments are added
    // after.
    let mut findings = recording_findings(recording);
    findings.extend(of_segments.into_list());
    if strict {
        refuse(&recording.source, &findings)?;
    }
    let of_part = part.warnings.iter().cloned().map(Notice::from);
    let noticed = recording.warnings.iter().cloned().chain(of_part);
    Ok(Reading {
        warnings: noticed.chain(sentences(&recording.source, &findings, false)).collect(),
        notes: sentences(&recording.source, &findings, true).collect(),
        part,
        condition,
        spread,
        findings,
    })
}

/// Returns findings as sentences: with `info` the findings of severity info, otherwise all others.
pub(crate) fn sentences(
    source: &str,
    findings: &[Finding],
    info: bool,
) -> impl Iterator<Item = Notice> {
    let chosen = findings.iter().filter(move |f| (f.severity == Severity::Info) == info);
    chosen.map(move |f| {
        let text = format!("{source}: {}: {}", f.code, f.message);
        Notice::new(text, f.hint)
    })
}

/// Returns an error if a finding is an error or a warning.
pub(crate) fn refuse(source: &str, findings: &[Finding]) -> Result<(), AuthorError> {
    let grave = findings.iter().filter(|f| f.severity != Severity::Info);
    let findings: Vec<Finding> = grave.cloned().collect();
    if findings.is_empty() {
        Ok(())
    } else {
        Err(AuthorError::Strict { source_name: source.to_owned(), findings })
    }
}

/// Validates a recording and returns all findings; it is valid when none is an error.
///
/// # Errors
/// When the file cannot be opened, or an option does not apply. A file that is not a recording is
/// reported as a finding.
pub fn validate_recording(
    path: &Path,
    read: &ReadOptions,
    given: Exploration,
    options: &SpectrumOptions,
) -> Result<Report, ReadError> {
    validated(read_recording(path, read), given, options)
}

/// Validates a recording given as bytes, as [`validate_recording`] does; `path` is not opened.
///
/// # Errors
/// When an option does not apply.
pub fn validate_recording_bytes(
    path: &Path,
    bytes: &[u8],
    read: &ReadOptions,
    given: Exploration,
    options: &SpectrumOptions,
) -> Result<Report, ReadError> {
    validated(recording_from_bytes(path, bytes, read), given, options)
}

fn validated(
    read: Result<Recording, ReadError>,
    given: Exploration,
    options: &SpectrumOptions,
) -> Result<Report, ReadError> {
    let findings = match read {
        // A missing file or a wrong option is the caller's mistake and says nothing about the
        // recording.
        Err(error) if matches!(error.problem, ReadProblem::Io(_) | ReadProblem::Option { .. }) => {
            return Err(error);
        }
        Err(error) => {
            let mut findings = Findings::default();
            findings.add(RECORDING_UNREADABLE, "", error.to_string());
            findings.into_list()
        }
        Ok(recording) => all_findings(Take { recording, given }, options),
    };
    Ok(Report::new(findings))
}

/// Returns the findings and the reader's warnings for a readable recording.
fn all_findings(take: Take, options: &SpectrumOptions) -> Vec<Finding> {
    let mut rest = Findings::default();
    let mut noticed = take.recording.warnings.clone();
    let mut findings = match read_take(&take, options, false) {
        Ok(reading) => {
            noticed.extend(reading.part.warnings.into_iter().map(Notice::from));
            reading.findings
        }
        Err(error) => {
            // The signals can still be judged, and their findings often say why nothing could be
            // read.
            rest.add(RECORDING_UNUSABLE, "", error.to_string());
            recording_findings(&take.recording)
        }
    };
    noticed.into_iter().for_each(|sentence| rest.add(RECORDING_NOTED, "", sentence));
    findings.extend(rest.into_list());
    findings
}
