//! Reads recordings that are in memory, according to the settings in the call.

use std::path::{Path, PathBuf};

use htex_author::recording::{ReadOptions, recording_from_bytes, response_from_bytes};
use htex_author::settings::ReadingSettings;
use htex_author::{Exploration, Recording, SpectrumOptions, Take};
use serde_json::Value;

use super::progress;
use crate::answer::Files;
use crate::document::Document;
use crate::refusal::Refusal;

/// A speed in mm/s and a force in N.
#[derive(Clone, Copy, Default)]
pub(crate) struct GivenCondition {
    pub(crate) speed: Option<f64>,
    pub(crate) force: Option<f64>,
}

pub(crate) fn given(condition: Value) -> Result<GivenCondition, Refusal> {
    let mut condition = Document::from_value(condition)?;
    let given =
        GivenCondition { speed: condition.number("speed")?, force: condition.number("force")? };
    condition.finish()?;
    Ok(given)
}

/// Recordings, and how to read them.
pub(crate) struct Reading<'a> {
    pub(crate) settings: ReadingSettings,
    pub(crate) spectrum: SpectrumOptions,
    pub(crate) strict: bool,
    /// Name of the file with the setup's response, for the provenance.
    pub(crate) response: Option<String>,
    given: GivenCondition,
    recordings: Vec<(String, &'a [u8])>,
    options: Vec<ReadOptions>,
}

impl<'a> Reading<'a> {
    /// Takes the settings for reading. The files come in this order: the recordings, the response,
    /// the trackers.
    pub(crate) fn new(
        mut names: Document,
        settings: &mut Document,
        files: Files<'a>,
    ) -> Result<Self, Refusal> {
        // These three settings are not in the table that follows.
        let given = GivenCondition {
            speed: settings.number("speed_mm_s")?,
            force: settings.number("force_n")?,
        };
        let strict = settings.flag("strict")?;
        let settings: ReadingSettings = settings.table(ReadingSettings::NAMES)?;
        if settings.response.is_some() || settings.tracker.is_some() {
            return Err(Refusal::argument(
                "the response and the tracker are files; give name and bytes",
            ));
        }
        let recordings = names.texts("recordings")?;
        let response = names.text("response")?;
        let trackers = names.texts("trackers")?;
        names.finish()?;
        let mut files = files.iter().copied();
        let mut next = || files.next().ok_or_else(|| Refusal::argument("a file is missing"));
        let recordings = recordings
            .into_iter()
            .map(|name| Ok((name, next()?)))
            .collect::<Result<Vec<_>, Refusal>>()?;
        let mut spectrum = settings.spectrum_options()?;
        if let Some(name) = &response {
            spectrum.response = Some(response_from_bytes(name, next()?)?);
        }
        let named = trackers.iter().map(PathBuf::from).collect();
        let settings =
            ReadingSettings { tracker: (!trackers.is_empty()).then_some(named), ..settings };
        let mut options = settings.read_options(recordings.len())?;
        let tracked = trackers.iter().map(|_| next()).collect::<Result<Vec<_>, _>>()?;
        for (i, own) in options.iter_mut().enumerate() {
            // There is one tracker for each recording, or one for all.
            let bytes = tracked.get(i).or(tracked.first());
            let tracker = own.tracker.take().zip(bytes);
            own.tracker = tracker.map(|(tracker, bytes)| tracker.with_bytes(*bytes));
        }
        Ok(Self { settings, spectrum, strict, response, given, recordings, options })
    }

    /// Returns the name of the first recording without its extension.
    pub(crate) fn stem(&self) -> Option<String> {
        let (name, _) = self.recordings.first()?;
        Some(Path::new(name).file_stem()?.to_string_lossy().into_owned())
    }

    /// Returns the only recording, and its options.
    pub(crate) fn only(&self) -> Result<(&Path, &'a [u8], &ReadOptions), Refusal> {
        match (&self.recordings[..], &self.options[..]) {
            ([(name, bytes)], [options]) => Ok((Path::new(name), bytes, options)),
            _ => Err(Refusal::argument("give one recording")),
        }
    }

    /// Reads the recordings. `conditions` has one entry for each recording, or one for all of them,
    /// or none.
    pub(crate) fn takes(&self, conditions: &[GivenCondition]) -> Result<Vec<Take>, Refusal> {
        let (given, wanted) = (conditions.len(), self.recordings.len());
        if given > 1 && given != wanted {
            return Err(Refusal::argument(format!(
                "{given} conditions for {wanted} recordings; give one for each, or one for all"
            )));
        }
        let takes = self.recordings.iter().zip(&self.options).enumerate();
        let take = |(i, ((name, bytes), options)): (usize, (&(String, &[u8]), &ReadOptions))| {
            progress::begin("read", name);
            let own = conditions.get(i).or(conditions.first()).copied().unwrap_or_default();
            let recording: Recording = recording_from_bytes(Path::new(name), bytes, options)?;
            Ok(Take {
                recording,
                given: Exploration {
                    speed_mm_s: own.speed.or(self.given.speed),
                    force_n: own.force.or(self.given.force),
                },
            })
        };
        takes.map(take).collect()
    }

    /// Returns the number of recordings.
    pub(crate) fn count(&self) -> usize {
        self.recordings.len()
    }
}
