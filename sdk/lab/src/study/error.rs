//! Errors of running a study.

use std::path::PathBuf;

use crate::record::RecordError;

/// Error of running or reading a study. No recorded answer is lost because of one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The study has no such participant.
    #[error("the study has no participant {name:?}; it has {known}")]
    NoParticipant { name: String, known: String },
    /// A file could not be read or written.
    #[error(transparent)]
    File(#[from] htex_base::files::FileError),
    /// Another program is recording answers of the same participant.
    #[error("{}: another htex is running this participant; wait for it to end", .file.display())]
    Busy {
        /// The file of answers.
        file: PathBuf,
    },
    /// A line in a file of answers is invalid.
    #[error("{}, line {line}: {problem}; restore the file from a copy, or give another folder", .file.display())]
    Line {
        /// The file of answers.
        file: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        problem: String,
    },
    /// The file was begun under other conditions. Results of two versions must not be mixed.
    #[error(
        "{}: the answers there were begun with another version: {changed}. Restore what was there (the earlier settings, in the case of a \
         device), or start anew in another folder (-o)",
        .file.display()
    )]
    OtherVersion {
        /// The file of answers.
        file: PathBuf,
        changed: String,
    },
    /// A folder has no answers.
    #[error("{}: there are no answers (*.jsonl); name the folder that `htex study run -o` wrote to", .folder.display())]
    NoAnswers { folder: PathBuf },
    /// A simulated participant needs the measured error of each representation.
    #[error(
        "{texture}: the asset has no measured nine-band error for {model}, by which simulated participants rate; fit it again with `htex fit`"
    )]
    NoBandError { texture: String, model: String },
    /// The device ran dry in every attempt of a trial.
    #[error(
        "the device ran dry in {times} attempts of the same trial; the last: {error}. Close other programs or give the device a larger \
         buffer (in another folder, -o, since settings are not mixed); the trial is repeated when the same command is run again"
    )]
    RanDry {
        /// Number of attempts.
        times: u32,
        /// The last error.
        error: String,
    },
    /// What was felt could not be recorded.
    #[error(
        "recording what is felt: {0}; the trial is repeated when the same command is run again"
    )]
    Felt(#[from] RecordError),
    /// A recording of what was felt is not the one that was rated, or a recording or an asset has
    /// no spectrum that an analysis can use.
    #[error(transparent)]
    Content(#[from] htex_base::files::ContentError),
    /// There are no recordings of what was felt.
    #[error("{}: the felt force was not recorded; give `htex study run` a source (--source)", .folder.display())]
    NotRecorded {
        /// The folder of answers.
        folder: PathBuf,
    },
    /// The page cannot be served.
    #[error(transparent)]
    Page(#[from] crate::page::PageError),
    /// The requested attribute is not in the answers.
    #[error("the answers have the attributes {known}; name one of them")]
    Attribute { known: String },
}
