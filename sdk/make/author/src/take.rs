//! The first stage of a fit. From a recording, this stage computes the spectra of the segments, the
//! motion in the segments, and the findings. No later stage reads the recording again.

use std::path::Path;

use htex_base::finding::{Finding, Findings, Notice, Report, Severity};
use htex_format::Source;
use htex_recording::{
    ReadError, ReadOptions, ReadProblem, RecordedFile, read_recording, recording_from_bytes,
};

use crate::exploration::SegmentMotion;
use crate::findings::{
    RECORDING_NOTED, RECORDING_UNREADABLE, RECORDING_UNUSABLE, judge_segments, recording_findings,
};
use crate::segments::choose_segments;
use crate::spectrum::spectra_of_segments;
use crate::{AuthorError, Exploration, Recording, SegmentSpectra, SpectrumOptions, Spread};

/// A recording, with the speed and force that the user gives for it.
#[derive(Debug, Clone)]
pub struct Take {
    pub recording: Recording,
    /// Speed and force given by the user. Given values take precedence over measured values.
    pub given: Exploration,
}

/// The spectra of a recording's segments, with the motion in them and all findings.
#[derive(Debug, Clone)]
pub struct SegmentedTake {
    /// The recording's entry in the provenance of an asset, without the hash of its file.
    pub source: Source,
    /// The recording's file. The file is hashed only if an asset needs the hash, because hashing
    /// adds about a tenth to the time of reading the file.
    pub file: RecordedFile,
    /// Whether the recording is simulated.
    pub simulated: bool,
    pub spectra: SegmentSpectra,
    /// Speed and force: the given values or, if none are given, the medians of the values measured
    /// in the segments.
    pub motion: Exploration,
    /// Ranges of speed and force over the segments.
    pub spread: Spread,
    /// All findings, in the order of `spec/recording-findings.md`.
    pub findings: Vec<Finding>,
    /// The reader's warnings, and the findings that are errors or warnings, as sentences.
    pub warnings: Vec<Notice>,
    /// The findings whose severity is info, as sentences.
    pub notes: Vec<Notice>,
}

/// Computes the segment spectra of a recording and checks its signals. Segments whose motion
/// differs from the given condition by more than 10 % are left out.
///
/// # Errors
/// Returns an error if the recording is too short, its sample rate is too low, or no segment
/// remains. Also returns an error if the setup's response is zero or not finite in the band, or if
/// a speed or force is out of range. If `strict` is true, findings that are errors or warnings also
/// cause an error.
pub fn segment_take(
    take: &Take,
    options: &SpectrumOptions,
    strict: bool,
) -> Result<SegmentedTake, AuthorError> {
    let recording = &take.recording;
    let all = choose_segments(recording, options.segments);
    let SegmentMotion { segments, motion, spread, off_target, unsteady } =
        SegmentMotion::new(recording, all, take.given)?;
    let spectra = spectra_of_segments(recording, segments, options.response.as_ref())?;
    let mut of_segments = off_target;
    judge_segments(recording, &spectra, &mut of_segments);
    // As in the specification: findings about signals first, findings about the motion last.
    let mut findings = recording_findings(recording);
    findings.extend(of_segments.into_list());
    findings.extend(unsteady.into_list());
    let [warnings, notes] = notices(recording, &spectra.warnings, &findings, strict)?;
    let source = source_of(recording, spectra.spectra.len());
    Ok(SegmentedTake {
        source,
        file: recording.file.clone(),
        simulated: recording.simulated,
        spectra,
        motion,
        spread,
        findings,
        warnings,
        notes,
    })
}

/// Returns the provenance entry of a recording, without the hash of its file. `segments` is the
/// number of segments that are read.
pub(crate) fn source_of(recording: &Recording, segments: usize) -> Source {
    Source {
        file: recording.source.clone(),
        rate_hz: recording.rate_hz,
        segments: segments as u64,
        blake3: None,
    }
}

/// Returns a recording's warnings and notes as sentences: the reader's warnings, the warnings about
/// its spectra, and its findings.
///
/// # Errors
/// With `strict`, when a finding is an error or a warning.
pub(crate) fn notices(
    recording: &Recording,
    of_spectra: &[String],
    findings: &[Finding],
    strict: bool,
) -> Result<[Vec<Notice>; 2], AuthorError> {
    let source = &recording.source;
    if strict {
        refuse(source, findings)?;
    }
    let mut warnings = recording.warnings.clone();
    warnings.extend(of_spectra.iter().cloned().map(Notice::from));
    let mut notes = Vec::new();
    for finding in findings {
        let is_note = finding.severity == Severity::Info;
        let list = if is_note { &mut notes } else { &mut warnings };
        list.push(sentence(source, finding));
    }
    Ok([warnings, notes])
}

/// Returns a finding as a sentence that names its recording.
pub(crate) fn sentence(source: &str, finding: &Finding) -> Notice {
    Notice::new(format!("{source}: {}: {}", finding.code, finding.message), finding.hint)
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

/// Validates a recording and returns all findings. The recording is valid if no finding is an
/// error.
///
/// # Errors
/// Returns an error if the file cannot be opened, or an option does not apply. A file that is not a
/// recording is reported as a finding.
pub fn validate_recording(
    path: &Path,
    read: &ReadOptions,
    given: Exploration,
    options: &SpectrumOptions,
) -> Result<Report, ReadError> {
    report(read_recording(path, read), given, options)
}

/// Validates a recording that is given as bytes, in the same way as [`validate_recording`]. The
/// file `path` is not opened.
///
/// # Errors
/// Returns an error if an option does not apply.
pub fn validate_recording_bytes(
    path: &Path,
    bytes: &[u8],
    read: &ReadOptions,
    given: Exploration,
    options: &SpectrumOptions,
) -> Result<Report, ReadError> {
    report(recording_from_bytes(path, bytes, read), given, options)
}

fn report(
    read: Result<Recording, ReadError>,
    given: Exploration,
    options: &SpectrumOptions,
) -> Result<Report, ReadError> {
    let mut rest = Findings::default();
    let recording = match read {
        // A missing file or a wrong option is the caller's mistake and says nothing about the
        // recording.
        Err(error) if matches!(error.problem, ReadProblem::Io(_) | ReadProblem::Option { .. }) => {
            return Err(error);
        }
        Err(error) => {
            rest.add(RECORDING_UNREADABLE, "", error.to_string());
            return Ok(rest.into_report());
        }
        Ok(recording) => recording,
    };
    let take = Take { recording, given };
    let mut noticed = take.recording.warnings.clone();
    let mut findings = match segment_take(&take, options, false) {
        Ok(read) => {
            noticed.extend(read.spectra.warnings.into_iter().map(Notice::from));
            read.findings
        }
        Err(error) => {
            // The signals can still be judged, and their findings often explain why nothing could
            // be read.
            rest.add(RECORDING_UNUSABLE, "", error.to_string());
            recording_findings(&take.recording)
        }
    };
    noticed.into_iter().for_each(|sentence| rest.add(RECORDING_NOTED, "", sentence));
    findings.extend(rest.into_list());
    Ok(Report::new(findings))
}
