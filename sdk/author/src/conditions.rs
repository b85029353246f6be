//! Grouping of recordings by exploration condition.

use htex_base::finding::{Finding, Findings, Notice};
use htex_format::{Condition, Source};
use htex_host::FitCondition;

use crate::findings::{differing, level_of};
use crate::reading::{read_take, refuse, sentences};
use crate::recording_finding::RecordingFinding;
use crate::spectrum::SegmentSpectra;
use crate::take::{Take, source_of};
use crate::warnings::Warnings;
use crate::{AuthorError, Exploration, SpectrumOptions, TextureSpectrum};

/// The spectrum of one condition.
pub(crate) struct Group {
    pub(crate) spectrum: TextureSpectrum,
    /// The motion at which it was recorded, as far as it is known.
    pub(crate) condition: FitCondition,
}

/// The spectra of all conditions.
pub(crate) struct Grouped {
    pub(crate) groups: Vec<Group>,
    pub(crate) conditions: Vec<Condition>,
    pub(crate) sources: Vec<Source>,
    pub(crate) warnings: Vec<Notice>,
    pub(crate) notes: Vec<Notice>,
    pub(crate) findings: Vec<RecordingFinding>,
}

struct Gathering {
    condition: Exploration,
    parts: Vec<SegmentSpectra>,
    /// Names of the recordings, one for each part.
    names: Vec<String>,
}

impl Gathering {
    /// Recordings whose level differs from the others' level, with the findings.
    fn differing(&self) -> impl Iterator<Item = (&str, Vec<Finding>)> {
        let levels: Vec<f64> = self.parts.iter().map(level_of).collect();
        let found = differing(&levels).into_iter().map(Findings::into_list);
        let named = self.names.iter().map(String::as_str).zip(found);
        named.filter(|(_, found)| !found.is_empty())
    }
}

/// Computes the recordings' spectra and averages the spectra of each condition.
pub(crate) fn group_takes(
    takes: &[Take],
    options: &SpectrumOptions,
    strict: bool,
) -> Result<Grouped, AuthorError> {
    let (mut gatherings, mut sources) = (Vec::<Gathering>::new(), Vec::new());
    let (mut warnings, mut notes) = (Warnings::default(), Warnings::default());
    let mut findings = Vec::new();
    for take in takes {
        let reading = read_take(take, options, strict)?;
        let (condition, part) = (reading.condition, reading.part);
        warnings.add(&take.recording.source, reading.warnings);
        notes.add(&take.recording.source, reading.notes);
        findings.extend(RecordingFinding::all(&take.recording.source, reading.findings));
        sources.push(source_of(take, part.spectra.len()));
        // The first recording of a condition decides its speed and force, so the order of
        // recordings can matter where they lie close together.
        match gatherings.iter_mut().find(|g| same(g.condition, condition)) {
            Some(gathering) => {
                gathering.parts.push(part);
                gathering.names.push(take.recording.source.clone());
            }
            None => gatherings.push(Gathering {
                condition,
                parts: vec![part],
                names: vec![take.recording.source.clone()],
            }),
        }
    }
    // Only after all recordings, because a level differs from the median of its whole condition.
    for (name, found) in gatherings.iter().flat_map(Gathering::differing) {
        if strict {
            refuse(name, &found)?;
        }
        warnings.add(name, sentences(name, &found, false).collect());
        findings.extend(RecordingFinding::all(name, found));
    }
    check_known(&gatherings)?;
    let (mut groups, mut conditions) = (Vec::new(), Vec::new());
    for gathering in gatherings {
        let spectrum = TextureSpectrum::average(&gathering.parts, options.averaging)?;
        let condition = FitCondition {
            speed_mm_s: gathering.condition.speed_mm_s.map(four_digits),
            force_n: gathering.condition.force_n.map(four_digits),
        };
        conditions.push(Condition {
            speed_mm_s: condition.speed_mm_s,
            force_n: condition.force_n,
            repeatability_rms_db: spectrum.repeatability_rms_db,
            segments: None,
        });
        groups.push(Group { spectrum, condition });
    }
    let first = groups.first().map(|group| group.spectrum.quantity);
    if groups.iter().any(|group| Some(group.spectrum.quantity) != first) {
        return Err(AuthorError::QuantitiesDiffer);
    }
    if groups.windows(2).any(|pair| pair[0].spectrum.band != pair[1].spectrum.band) {
        return Err(AuthorError::BandsDiffer);
    }
    Ok(Grouped {
        groups,
        conditions,
        sources,
        warnings: warnings.into_notices(),
        notes: notes.into_notices(),
        findings,
    })
}

/// Whether two recordings have the same condition.
fn same(a: Exploration, b: Exploration) -> bool {
    let near = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => Condition::is_same(a, b),
        (None, None) => true,
        _ => false,
    };
    near(a.speed_mm_s, b.speed_mm_s) && near(a.force_n, b.force_n)
}

/// Checks that, if there are several conditions, all of them have a known speed and force.
fn check_known(gatherings: &[Gathering]) -> Result<(), AuthorError> {
    let known = gatherings
        .iter()
        .filter(|g| g.condition.speed_mm_s.is_some() && g.condition.force_n.is_some())
        .count();
    if gatherings.len() < 2 || known == gatherings.len() {
        return Ok(());
    }
    Err(AuthorError::UnknownConditions { known, all: gatherings.len() })
}

/// Rounds to four digits, the precision of measured speeds and forces.
pub(crate) fn four_digits(x: f64) -> f64 {
    // By way of text: the nearest number to four digits has the shortest form in the manifest.
    format!("{x:.3e}").parse().unwrap_or(x)
}
