//! The second stage of a fit: averages the spectra of recordings at the same speed and force. The
//! average is the spectrum of one condition.

use htex_base::finding::{Finding, Findings, Notice};
use htex_format::{Condition, Contact, Law, Source};
use htex_host::FitCondition;

use crate::blocks::block_power;
use crate::findings::{differing, level_of};
use crate::law::law;
use crate::odd_and_even::odd_and_even;
use crate::spectrum::SegmentSpectra;
use crate::take::{SegmentedTake, refuse, sentence};
use crate::{
    AssetRequest, AuthorError, Exploration, SpectrumOptions, TextureSpectrum, between, tilted,
};

/// The spectrum of one condition.
#[derive(Debug, Clone)]
pub(crate) struct ConditionSpectrum {
    pub(crate) condition: Condition,
    pub(crate) spectrum: TextureSpectrum,
    /// Power of each block of time on the spectrum's grid; `None` if there are fewer than four
    /// blocks, or if the spectrum was not averaged from blocks.
    pub(crate) block_power: Option<Vec<Vec<f64>>>,
    /// The spectra of the odd and of the even blocks of time. `None` in the same cases as
    /// `block_power`.
    pub(crate) halves: Option<[TextureSpectrum; 2]>,
}

impl ConditionSpectrum {
    /// A condition without blocks of time, which states the repeatability of its spectrum.
    pub(crate) fn new(motion: Condition, spectrum: TextureSpectrum) -> Self {
        let own = spectrum.repeatability;
        let condition = Condition {
            repeatability_rms_db: own.map(|of| of.band_rms_db),
            repeatability_third_octave_rms_db: own.and_then(|of| of.third_octave_rms_db),
            ..motion
        };
        Self { condition, spectrum, block_power: None, halves: None }
    }

    /// Returns the speed and force of the condition, as far as they are known.
    pub(crate) fn motion(&self) -> FitCondition {
        let Condition { speed_mm_s, force_n, .. } = self.condition;
        FitCondition { speed_mm_s, force_n }
    }
}

/// The spectra of all conditions of an asset.
pub(crate) struct ConditionSpectra {
    /// Recorded conditions, followed by conditions computed between them.
    pub(crate) all: Vec<ConditionSpectrum>,
    pub(crate) contact: Contact,
    pub(crate) law: Law,
    pub(crate) recordings: RecordingsReport,
}

/// A finding about one of several recordings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordingFinding {
    /// The recording's name, as it appears in warnings.
    pub recording: String,
    pub finding: Finding,
}

/// What an asset states about its recordings.
#[derive(Default)]
pub(crate) struct RecordingsReport {
    pub(crate) sources: Vec<Source>,
    /// Whether a recording is simulated.
    pub(crate) simulated: bool,
    pub(crate) warnings: Warnings,
    pub(crate) notes: Warnings,
    pub(crate) findings: Vec<RecordingFinding>,
}

impl RecordingsReport {
    /// Adds the source, notices and findings of one recording.
    pub(crate) fn add(
        &mut self,
        source: Source,
        simulated: bool,
        [warnings, notes]: [Vec<Notice>; 2],
        findings: Vec<Finding>,
    ) {
        self.warnings.add(&source.file, warnings);
        self.notes.add(&source.file, notes);
        self.add_findings(&source.file, findings);
        self.simulated |= simulated;
        self.sources.push(source);
    }

    pub(crate) fn add_findings(&mut self, recording: &str, findings: Vec<Finding>) {
        let recording = || recording.to_owned();
        let named = findings.into_iter();
        self.findings
            .extend(named.map(|finding| RecordingFinding { recording: recording(), finding }));
    }
}

/// The takes of one condition.
struct Gathering {
    condition: Exploration,
    parts: Vec<SegmentSpectra>,
    /// Names of the recordings, one for each part.
    names: Vec<String>,
}

impl Gathering {
    /// Returns the recordings whose level differs from the level of the others, with the findings.
    fn differing(&self) -> impl Iterator<Item = (&str, Vec<Finding>)> {
        let levels: Vec<f64> = self.parts.iter().map(level_of).collect();
        let found = differing(&levels).into_iter().map(Findings::into_list);
        let named = self.names.iter().map(String::as_str).zip(found);
        named.filter(|(_, found)| !found.is_empty())
    }
}

impl ConditionSpectra {
    /// Averages the spectra of each condition, and estimates the law of the texture from them. If
    /// frequencies change with the speed in this law, adds conditions between the recorded
    /// conditions.
    ///
    /// # Errors
    /// Returns an error if quantities or bands differ, or if only some conditions have a known
    /// speed and force. If `strict` is set, also returns an error if the levels of a condition's
    /// recordings differ.
    pub(crate) fn new(
        takes: Vec<SegmentedTake>,
        request: &AssetRequest,
    ) -> Result<Self, AuthorError> {
        let AssetRequest { spectrum: SpectrumOptions { averaging, .. }, strict, .. } = *request;
        let simulated = takes.iter().map(|take| take.simulated);
        let contact = request.contact.unwrap_or_else(|| contact(simulated));
        let mut gatherings = Vec::<Gathering>::new();
        let mut recordings = RecordingsReport::default();
        for take in takes {
            let (condition, part, name) = (take.motion, take.spectra, take.source.file.clone());
            let notices = [take.warnings, take.notes];
            let source = Source { blake3: take.file.blake3(), ..take.source };
            recordings.add(source, take.simulated, notices, take.findings);
            // The first recording of a condition determines the speed and force of the condition.
            // Therefore, the order of recordings can matter if their speeds and forces are close
            // together.
            match gatherings.iter_mut().find(|g| same(g.condition, condition)) {
                Some(gathering) => {
                    gathering.parts.push(part);
                    gathering.names.push(name);
                }
                None => {
                    gatherings.push(Gathering { condition, parts: vec![part], names: vec![name] });
                }
            }
        }
        // This has to wait until all recordings are added, because each level is compared with the
        // median of its whole condition.
        for (name, found) in gatherings.iter().flat_map(Gathering::differing) {
            if strict {
                refuse(name, &found)?;
            }
            recordings.warnings.add(name, found.iter().map(|f| sentence(name, f)).collect());
            recordings.add_findings(name, found);
        }
        check_known(&gatherings)?;
        let (mut all, mut all_parts) = (Vec::new(), Vec::new());
        for Gathering { condition, parts, .. } in gatherings {
            let spectrum = TextureSpectrum::average(&parts, averaging)?;
            let condition = Condition {
                speed_mm_s: condition.speed_mm_s.map(four_digits),
                force_n: condition.force_n.map(four_digits),
                ..Condition::default()
            };
            all.push(ConditionSpectrum {
                block_power: block_power(&parts),
                halves: odd_and_even(&parts, averaging).map(|halves| [halves.odd, halves.even]),
                ..ConditionSpectrum::new(condition, spectrum)
            });
            all_parts.push(parts);
        }
        let differ = |of: fn(&TextureSpectrum, &TextureSpectrum) -> bool| {
            all.windows(2).any(|pair| of(&pair[0].spectrum, &pair[1].spectrum))
        };
        if differ(|a, b| a.quantity != b.quantity) {
            return Err(AuthorError::QuantitiesDiffer);
        }
        if differ(|a, b| a.band != b.band) {
            return Err(AuthorError::BandsDiffer);
        }
        let law = law(&all, contact);
        let quantity = all.first().map_or_else(Default::default, |one| one.spectrum.quantity);
        let given = request.law.map(|given| given.over(law).reassumed(quantity, contact));
        let law = given.unwrap_or(law);
        let follow = request.models.iter().all(|one| one.model.follows_motion());
        if !(request.recorded_only || follow) {
            let mut computed = between::conditions(&all, &law);
            computed.extend(tilted::conditions(&all, &all_parts, &law, contact, averaging)?);
            all.extend(computed);
        }
        Ok(Self { all, contact, law, recordings })
    }
}

/// Returns what slid over the surface: a finger if all recordings are simulated, because the
/// simulator always uses a finger. Otherwise it is unknown.
pub(crate) fn contact(mut simulated: impl Iterator<Item = bool>) -> Contact {
    if simulated.all(|is| is) { Contact::Finger } else { Contact::Unknown }
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
    // The number is rounded by writing it as text. Of all numbers with the same four digits, the
    // result has the shortest form in the manifest.
    format!("{x:.3e}").parse().unwrap_or(x)
}

/// Warnings of several recordings, in the order in which they first occurred. Equal warnings become
/// one sentence that names the recordings.
#[derive(Debug, Default)]
pub(crate) struct Warnings(Vec<Warning>);

#[derive(Debug)]
struct Warning {
    /// The warning as it was first given.
    notice: Notice,
    /// The sentence without the recording's name.
    text: String,
    recordings: Vec<String>,
}

impl Warnings {
    pub(crate) fn add(&mut self, recording: &str, notices: Vec<Notice>) {
        let name = format!("{recording}: ");
        for notice in notices {
            let text = notice.text.strip_prefix(&name).unwrap_or(&notice.text);
            match self.0.iter_mut().find(|warning| warning.text == text) {
                Some(warning) => warning.recordings.push(recording.to_owned()),
                None => self.0.push(Warning {
                    text: text.to_owned(),
                    recordings: vec![recording.to_owned()],
                    notice,
                }),
            }
        }
    }

    /// Returns the warnings, each once.
    pub(crate) fn into_notices(self) -> Vec<Notice> {
        let notice = |Warning { notice, text, recordings }| match recordings.len() {
            1 => notice,
            n => Notice {
                text: format!("{n} recordings ({}): {text}", recordings.join(", ")),
                ..notice
            },
        };
        self.0.into_iter().map(notice).collect()
    }
}
