//! Exports ratings as a table.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use htex_base::files::AtFile;
use htex_base::finding::as_text;

use crate::error::LabError;
use crate::study::lines::{Answer, FeltFile, Header, Line};
use crate::study::log;

/// Columns of the table. Analyses read the first five.
const COLUMNS: [&str; 11] = [
    "participant",
    "texture",
    "model",
    "repetition",
    "rating",
    "attribute",
    "hidden_reference",
    "response_ms",
    "gain_db",
    "simulated",
    "off_target",
];

/// Ratings of all participants in a folder.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// The table as CSV. The rows of each participant are together, in the order of the trials.
    pub csv: String,
    pub participants: usize,
    pub ratings: usize,
    /// Number of trials whose speed or force left the study's target, according to the column
    /// `off_target`.
    pub off_target: usize,
    /// Warnings that an analysis must consider: incomplete sessions, trials whose motion left the
    /// study's target, and devices with different settings.
    pub warnings: Vec<String>,
    /// A sentence for each participant whose session is incomplete. `warnings` also contains these
    /// sentences.
    pub incomplete: Vec<String>,
}

/// How the table of spectra treats trials whose speed or force left the study's target. The ratings
/// of such trials are always exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum OffTarget {
    /// Include these trials in the averages, and report their number.
    #[default]
    Keep,
    /// Leave these trials out, and report their number.
    LeaveOut,
}

/// Reads all answers in a folder. The ratings of the training are left out. If the answers have
/// several attributes, `attribute` selects the attribute whose ratings are exported.
///
/// # Errors
/// Returns [`LabError::NoAnswers`] if the folder has no answers. Returns [`LabError::OtherVersion`]
/// if the answers belong to several versions of a study, or to both simulated and real
/// participants. Returns [`LabError::Attribute`] if the attribute is not in the answers. Returns
/// other errors if a file cannot be read.
pub fn export(folder: &Path, attribute: Option<&str>) -> Result<Export, LabError> {
    let sessions = sessions_of(folder)?;
    let answers = sessions.iter().flat_map(|session| &session.answers);
    let all: BTreeSet<String> = answers.map(|answer| answer.attribute.clone()).collect();
    let attribute = chosen(&all, attribute)?;
    table(&sessions, &attribute, folder)
}

/// A participant's answers, without training.
pub(crate) struct Answers {
    file: PathBuf,
    pub(crate) header: Header,
    pub(crate) answers: Vec<Answer>,
}

/// Reads the answers of all participants in a folder. All answers must belong to the same version
/// of a study.
pub(crate) fn sessions_of(folder: &Path) -> Result<Vec<Answers>, LabError> {
    let mut sessions = Vec::new();
    for file in files(folder)? {
        let (header, lines) = log::read(&file)?;
        let answers = lines
            .into_iter()
            .filter_map(|line| match line {
                Line::Answer(answer) => Some(answer),
                _ => None,
            })
            .collect();
        sessions.push(Answers { file, header, answers });
    }
    same_study(&sessions)?;
    Ok(sessions)
}

fn files(folder: &Path) -> Result<Vec<PathBuf>, LabError> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).reading(folder)? {
        let path = entry.reading(folder)?.path();
        if path.extension().is_some_and(|e| e == "jsonl") {
            files.push(path);
        }
    }
    // A folder lists its files in any order, but the table must not depend on this order.
    files.sort();
    if files.is_empty() {
        Err(LabError::NoAnswers { folder: folder.to_owned() })
    } else {
        Ok(files)
    }
}

fn same_study(sessions: &[Answers]) -> Result<(), LabError> {
    let Some(first) = sessions.first() else {
        return Ok(());
    };
    let of_first = &first.header;
    for Answers { file, header, .. } in sessions {
        let first = first.file.display();
        let changed = if let Some(name) = log::other_file(of_first, header) {
            format!("{name} is another one than for {first}")
        } else if header.simulated.is_some() != of_first.simulated.is_some() {
            format!("one of this and {first} is of a simulated participant")
        } else if header.device.adapter != of_first.device.adapter
            || header.device.profile != of_first.device.profile
        {
            format!("the device is another one than for {first}")
        } else {
            continue;
        };
        let file = file.clone();
        return Err(LabError::OtherVersion { file, changed });
    }
    Ok(())
}

fn chosen(all: &BTreeSet<String>, wanted: Option<&str>) -> Result<String, LabError> {
    let only = all.first().filter(|_| all.len() == 1);
    let found = match wanted {
        Some(wanted) => all.get(wanted),
        None => only,
    };
    match found {
        Some(found) => Ok(found.clone()),
        // There are no ratings to export yet.
        None if all.is_empty() => Ok(String::new()),
        None => Err(LabError::Attribute { known: Vec::from_iter(all.iter().cloned()).join(", ") }),
    }
}

fn table(sessions: &[Answers], attribute: &str, folder: &Path) -> Result<Export, LabError> {
    let mut csv = csv::WriterBuilder::new().from_writer(Vec::new());
    csv.write_record(COLUMNS).writing(folder)?;
    let (mut ratings, mut off_target) = (0, 0);
    let (mut incomplete, mut warnings) = (Vec::new(), Vec::new());
    for session in sessions {
        let Answers { header, answers, .. } = session;
        if answers.len() < header.ratings {
            incomplete.push(format!(
                "{} is not complete: {} of {} ratings",
                header.participant,
                answers.len(),
                header.ratings
            ));
        }
        let (off, all) = session.off_target();
        off_target += off;
        if off > 0 {
            warnings.push(format!(
                "{}: {off} of {all} trials whose motion was measured were off the study's speed or force by more than 10 %; the column off_target marks them",
                header.participant
            ));
        }
        for answer in answers.iter().filter(|a| a.attribute == attribute) {
            csv.write_record(row(header, answer)).writing(folder)?;
            ratings += 1;
        }
    }
    // Writing to a vector cannot fail.
    let bytes = csv.into_inner().unwrap_or_default();
    Ok(Export {
        csv: String::from_utf8_lossy(&bytes).into_owned(),
        participants: sessions.len(),
        ratings,
        off_target,
        warnings: [incomplete.clone(), other_settings(sessions), warnings].concat(),
        incomplete,
    })
}

/// Returns the device settings in which participants differ from the first one.
fn other_settings(sessions: &[Answers]) -> Vec<String> {
    let Some((first, rest)) = sessions.split_first() else {
        return Vec::new();
    };
    let differing = rest.iter().filter_map(|session| {
        let differences = first.header.device.differences(&session.header.device);
        (!differences.is_empty()).then(|| {
            let (was, is) = (&first.header.participant, &session.header.participant);
            format!("from {was} to {is}: {}", differences.join("; "))
        })
    });
    differing.collect()
}

impl Answers {
    /// Returns the number of trials off their target, and the number of trials whose motion was
    /// measured.
    fn off_target(&self) -> (usize, usize) {
        let recorded = self.answers.iter().filter_map(|answer| {
            let felt = answer.felt.as_ref()?;
            Some((answer.number, felt.is_off_target()?))
        });
        // A trial has one answer for each attribute, but counts only once.
        let recorded: BTreeSet<(u32, bool)> = recorded.collect();
        (recorded.iter().filter(|(_, off)| *off).count(), recorded.len())
    }
}

fn row(header: &Header, answer: &Answer) -> [String; COLUMNS.len()] {
    let yes = |is: bool| if is { "yes" } else { "no" }.to_owned();
    [
        as_text(&header.participant).into_owned(),
        as_text(&answer.texture).into_owned(),
        as_text(&answer.model).into_owned(),
        answer.repetition.to_string(),
        answer.rating.to_string(),
        as_text(&answer.attribute).into_owned(),
        yes(answer.hidden_reference),
        answer.response_ms.to_string(),
        answer.gain_db.map_or(String::new(), |db| format!("{db}")),
        yes(answer.simulated || header.simulated.is_some()),
        // Without a recording of speed or force, it is unknown whether the motion kept to the
        // target.
        (answer.felt.as_ref()).and_then(FeltFile::is_off_target).map_or(String::new(), yes),
    ]
}
