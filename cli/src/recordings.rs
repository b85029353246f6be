//! Arguments for reading recordings, shared by the commands that read them.

use std::path::{Path, PathBuf};

use clap::Args;
use htex_author::recording::{MOST_VALUES, read_recording};
use htex_author::settings::ReadingSettings;
use htex_author::{Exploration, SpectrumOptions, Take, validate_recording};
use htex_base::finding::Report;

use crate::failure::{Failure, Result};
use crate::located;
use crate::output::{note, shown};
#[cfg(feature = "lab")]
use htex_lab::record::KnownTake;

/// Options for reading recordings.
#[derive(Args, Default)]
#[command(
    next_help_heading = "Reading recordings",
    mut_arg("response", |arg| arg.value_parser(located::RECORDING))
)]
pub(crate) struct RecordingArgs {
    #[command(flatten)]
    pub(crate) settings: ReadingSettings,

    /// Scanning speed of the recordings, mm/s. This value replaces a speed in the recording
    #[arg(long, value_name = "MM_S")]
    speed: Option<f64>,

    /// Normal force of the recordings, N. This value replaces a force in the recording
    #[arg(long, value_name = "N")]
    force: Option<f64>,

    /// Speed and normal force, e.g. speed=80,force=0.4 (mm/s, N). Give one such pair for all
    /// recordings, or one pair for each recording, in the order of the recordings. If a recording
    /// contains the finger's motion, htex leaves out segments whose speed or force differs from
    /// this pair by more than 10 %
    #[arg(long, value_name = "CONDITION")]
    at: Vec<String>,

    /// Refuse a recording that has errors or warnings in `htex validate`, e.g. clipping, spikes, a
    /// stuck sensor, or a speed or force that leaves its target by more than 10 %
    #[arg(long)]
    strict: bool,
}

impl RecordingArgs {
    /// Returns the files that are read together with the recordings: a response and trackers.
    pub(crate) fn inputs(&self) -> impl Iterator<Item = &Path> {
        let trackers = self.settings.tracker.iter().flatten();
        let files = self.settings.response.iter().chain(trackers);
        files.map(PathBuf::as_path)
    }

    pub(crate) fn strict(&self) -> bool {
        self.strict
    }

    /// Reads recordings, each with its given condition.
    pub(crate) fn read(&self, files: &[PathBuf]) -> Result<Vec<Take>> {
        self.read_with(files, &self.settings)
    }

    fn read_with(&self, files: &[PathBuf], settings: &ReadingSettings) -> Result<Vec<Take>> {
        let options = settings.read_options(files.len())?;
        let given = self.conditions(files.len())?;
        let given = options.iter().zip(given);
        files
            .iter()
            .zip(given)
            .map(|(file, (options, given))| {
                let recording = read_recording(file, options)?;
                Ok(Take { recording, given })
            })
            .collect()
    }

    /// Reads one recording with its condition. A recording made by `htex record` or a study is read
    /// as its JSON file says, unless flags say what its columns are.
    pub(crate) fn read_one(&self, file: &Path) -> Result<Take> {
        let own = known_take(file)?.filter(|_| !self.settings.says_columns());
        self.read_as(file, own)
    }

    /// Reads one of several recordings with its condition. A recording made by `htex record` or a
    /// study is read as its JSON file says, even if flags say what the columns of the others are.
    pub(crate) fn read_among(&self, file: &Path) -> Result<Take> {
        let own = known_take(file)?;
        if own.is_some() && self.settings.says_columns() {
            note(&[format!(
                "{}: its columns, rate, quantity and motion come from the JSON file next to it",
                shown(file)
            )]);
        }
        self.read_as(file, own)
    }

    fn read_as(&self, file: &Path, own: Option<KnownTake>) -> Result<Take> {
        let takes = match own {
            Some(own) => {
                let file = own.recording.clone();
                self.read_with(&[file], &own.with_given(&self.settings))
            }
            None => self.read(&[file.to_owned()]),
        };
        let missing = || Failure::Usage("a recording is missing".to_owned());
        takes?.pop().ok_or_else(missing)
    }

    /// Returns the findings in one recording.
    pub(crate) fn validate(&self, file: &Path) -> Result<Report> {
        let given = self.conditions(1)?.pop().unwrap_or_default();
        let settings = &self.settings;
        let read = settings.read_options(1)?.pop().unwrap_or_default();
        Ok(validate_recording(file, &read, given, &settings.spectrum_options()?)?)
    }

    /// Whether any option for reading recordings was given.
    pub(crate) fn is_given(&self) -> bool {
        let condition = self.speed.is_some() || self.force.is_some() || !self.at.is_empty();
        // clap fills in the default, so only another value shows that the user gave one.
        let bounded = self.settings.most_values.is_some_and(|most| most != MOST_VALUES);
        condition || self.strict || bounded || !self.settings.recorded().is_empty()
    }

    pub(crate) fn spectrum_options(&self) -> Result<SpectrumOptions> {
        Ok(self.settings.spectrum_options()?)
    }

    /// Returns one condition for each of `count` recordings.
    fn conditions(&self, count: usize) -> Result<Vec<Exploration>> {
        let common = Exploration { speed_mm_s: self.speed, force_n: self.force };
        let given: Vec<Exploration> =
            self.at.iter().map(|text| parse_condition(text, common)).collect::<Result<_, _>>()?;
        match given.len() {
            0 => Ok(vec![common; count]),
            1 => Ok(vec![given[0]; count]),
            n if n == count => Ok(given),
            n => Err(Failure::Usage(format!(
                "{n} conditions (--at) for {count} recordings; give one for each, or one for all"
            ))),
        }
    }
}

#[cfg(feature = "lab")]
fn known_take(file: &Path) -> Result<Option<KnownTake>> {
    Ok(KnownTake::find(file)?)
}

/// In a build without `htex record` and studies, this type replaces the settings of their
/// recordings.
#[cfg(not(feature = "lab"))]
struct KnownTake {
    recording: PathBuf,
}

#[cfg(not(feature = "lab"))]
impl KnownTake {
    fn with_given(self, given: &ReadingSettings) -> ReadingSettings {
        given.clone()
    }
}

#[cfg(not(feature = "lab"))]
fn known_take(_: &Path) -> Result<Option<KnownTake>> {
    Ok(None)
}

/// Parses `speed=80,force=0.4`. A quantity that the text does not give keeps its value in
/// `condition`.
pub(crate) fn parse_condition(text: &str, mut condition: Exploration) -> Result<Exploration> {
    let wrong = |what: &str| {
        Failure::Usage(format!("--at {text}: {what}; it looks like speed=80,force=0.4 (mm/s, N)"))
    };
    for part in text.split(',') {
        let (key, value) = part.split_once('=').ok_or_else(|| wrong("`=` is missing"))?;
        let value: f64 = value.trim().parse().map_err(|_| wrong("a value is not a number"))?;
        match key.trim() {
            "speed" | "speed_mm_s" => condition.speed_mm_s = Some(value),
            "force" | "force_n" => condition.force_n = Some(value),
            other => return Err(wrong(&format!("`{other}` is neither speed nor force"))),
        }
    }
    Ok(condition)
}
