//! Recordings from bytes, read as settings say.

use std::path::{Path, PathBuf};

use htex_author::recording::{ReadOptions, Tracker, recording_from_bytes, response_from_bytes};
use htex_author::settings::ReadingSettings;
use htex_author::{Exploration, Recording, SpectrumOptions, Take};
use serde::Deserialize;

use crate::call::Files;
use crate::progress;
use crate::refusal::Refusal;
use crate::settings::Settings;

/// The names of the files of a call: recordings, then the response, then the trackers.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Names {
    recordings: Vec<String>,
    #[serde(default)]
    response: Option<String>,
    #[serde(default)]
    trackers: Vec<String>,
}

/// Settings of reading beside the table.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
struct Besides {
    speed_mm_s: Option<f64>,
    force_n: Option<f64>,
    strict: Option<bool>,
}

/// A speed in mm/s and a force in N.
#[derive(Deserialize, Clone, Copy, Default)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Given {
    pub(crate) speed: Option<f64>,
    pub(crate) force: Option<f64>,
}

/// Recordings and how they are read.
pub(crate) struct Reading<'a> {
    pub(crate) settings: ReadingSettings,
    pub(crate) spectrum: SpectrumOptions,
    pub(crate) strict: bool,
    /// Name of the setup's response, for provenance.
    pub(crate) response: Option<String>,
    given: Given,
    recordings: Vec<(String, &'a [u8])>,
    options: Vec<ReadOptions>,
}

impl<'a> Reading<'a> {
    /// Takes the settings of reading.
    pub(crate) fn new(
        names: Names,
        settings: &mut Settings,
        files: Files<'a>,
    ) -> Result<Self, Refusal> {
        let besides: Besides = settings.take(&["speed_mm_s", "force_n", "strict"])?;
        let settings: ReadingSettings = settings.take(ReadingSettings::NAMES)?;
        if settings.response.is_some() || settings.tracker.is_some() {
            return Err(Refusal::argument(
                "the response and the tracker are files; give name and bytes",
            ));
        }
        let Names {
            recordings,
            response,
            trackers,
        } = names;
        let mut files = files.iter().copied();
        let mut next = || {
            files
                .next()
                .ok_or_else(|| Refusal::argument("a file is missing"))
        };
        let recordings = recordings.into_iter().map(|name| Ok((name, next()?)));
        let recordings: Vec<(String, &[u8])> = recordings.collect::<Result<_, Refusal>>()?;
        let divided = response.as_deref().map(|name| {
            let response = response_from_bytes(name, next()?)?;
            Ok::<_, Refusal>(response)
        });
        let spectrum = settings
            .spectrum_options()?
            .with_response(divided.transpose()?);
        let with_names = ReadingSettings {
            tracker: (!trackers.is_empty()).then(|| trackers.iter().map(PathBuf::from).collect()),
            ..settings
        };
        let mut options = with_names.read_options(recordings.len())?;
        let mut bytes = trackers.iter().map(|_| next());
        let bytes = bytes.by_ref().collect::<Result<Vec<_>, Refusal>>()?;
        for (i, own) in options.iter_mut().enumerate() {
            // One for each recording, or one for all.
            let own_bytes = bytes.get(i).or(bytes.first());
            let tracker = own.tracker.take().zip(own_bytes);
            own.tracker = tracker.map(|(tracker, bytes): (Tracker, _)| tracker.with_bytes(*bytes));
        }
        Ok(Self {
            settings: with_names,
            spectrum,
            strict: besides.strict.unwrap_or_default(),
            response,
            given: Given {
                speed: besides.speed_mm_s,
                force: besides.force_n,
            },
            recordings,
            options,
        })
    }

    /// The name of the first recording without its extension.
    pub(crate) fn stem(&self) -> Option<String> {
        let (name, _) = self.recordings.first()?;
        Some(Path::new(name).file_stem()?.to_string_lossy().into_owned())
    }

    /// The only recording, and its options.
    pub(crate) fn only(&self) -> Result<(&Path, &'a [u8], &ReadOptions), Refusal> {
        match (&self.recordings[..], &self.options[..]) {
            ([(name, bytes)], [options]) => Ok((Path::new(name), bytes, options)),
            _ => Err(Refusal::argument("give one recording")),
        }
    }

    /// Reads the recordings. `conditions` has one entry for each of them, or one for all, or none.
    pub(crate) fn takes(&self, conditions: &[Given]) -> Result<Vec<Take>, Refusal> {
        let (given, wanted) = (conditions.len(), self.recordings.len());
        if given > 1 && given != wanted {
            return Err(Refusal::argument(format!(
                "{given} conditions for {wanted} recordings; give one for each, or one for all"
            )));
        }
        let takes = self.recordings.iter().zip(&self.options).enumerate();
        let take = |(i, ((name, bytes), options)): (usize, (&(String, &[u8]), &ReadOptions))| {
            progress::begin("read", name);
            let own = conditions
                .get(i)
                .or(conditions.first())
                .copied()
                .unwrap_or_default();
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

    /// The number of recordings.
    pub(crate) fn count(&self) -> usize {
        self.recordings.len()
    }
}
