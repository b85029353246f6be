//! Sources of recordings, and settings for reading them.

use std::path::{Path, PathBuf};

use htex_author::recording::{
    ReadError, ReadOptions, ReadProblem, read_recording, recording_from_bytes,
};
use htex_author::settings::ReadingSettings;
use htex_author::{
    AuthorError, Exploration, Recording, SegmentedTake, SpectrumOptions, Take, TextureSpectrum,
    segment_take,
};
use htex_lab::record::KnownTake;
use pyo3::prelude::*;
use pyo3::pybacked::{PyBackedBytes, PyBackedStr};
use serde::Deserialize;

use crate::errors::{IntoPyErr, of_file, option, raised};
use crate::python::parsed;

/// A recording: a file, or the name and the bytes of a file.
#[derive(FromPyObject)]
pub(crate) enum Source {
    /// The name of a file, and its bytes.
    Bytes(String, PyBackedBytes),
    /// A path.
    #[pyo3(transparent)]
    File(PathBuf),
}

/// How recordings are read.
pub(crate) struct Reading {
    /// The settings that also exist as flags of the command.
    settings: ReadingSettings,
    besides: Besides,
}

/// How recordings are read, in the form that the package passes: the settings, and the other
/// keywords, both as JSON.
pub(crate) type ReadingText = (PyBackedStr, PyBackedStr);

/// Keywords for reading recordings that are not settings of the command.
#[derive(Deserialize, Default)]
#[serde(default, deny_unknown_fields)]
struct Besides {
    speed_mm_s: Option<f64>,
    force_n: Option<f64>,
    strict: Option<bool>,
}

/// A speed and a force, mm/s and newtons.
pub(crate) type Pair = (Option<f64>, Option<f64>);

impl Reading {
    pub(crate) fn new((settings, besides): &ReadingText) -> PyResult<Self> {
        Ok(Self { settings: parsed(settings)?, besides: parsed(besides)? })
    }

    /// Whether recordings are refused if they have a finding that is an error or a warning.
    pub(crate) fn strict(&self) -> bool {
        self.besides.strict.unwrap_or_default()
    }

    pub(crate) fn settings(&self) -> &ReadingSettings {
        &self.settings
    }

    /// Reads recordings. `conditions` has one entry for each recording, or one for all of them, or
    /// none.
    pub(crate) fn takes(&self, sources: &[Source], conditions: &[Pair]) -> PyResult<Vec<Take>> {
        let options =
            self.settings().read_options(sources.len()).map_err(|error| self.raised(error))?;
        if conditions.len() > 1 && conditions.len() != sources.len() {
            let (given, wanted) = (conditions.len(), sources.len());
            return Err(option(format!(
                "{given} conditions for {wanted} recordings; give one for each, or one for all"
            )));
        }
        let given = |i: usize| {
            let own = conditions.get(i).or(conditions.first());
            let (speed_mm_s, force_n) = own.copied().unwrap_or_default();
            Exploration {
                speed_mm_s: speed_mm_s.or(self.besides.speed_mm_s),
                force_n: force_n.or(self.besides.force_n),
            }
        };
        let take = |(i, (source, options))| {
            Ok(Take { recording: self.read(source, options)?, given: given(i) })
        };
        sources.iter().zip(&options).enumerate().map(take).collect()
    }

    /// Reads one recording. Returns it, the segments that were read, and their texture spectrum.
    pub(crate) fn spectrum(
        &self,
        source: Source,
    ) -> PyResult<(Recording, SegmentedTake, TextureSpectrum)> {
        let options = self.spectrum_options()?;
        let take = self.takes(&[source], &[])?.pop().ok_or_else(|| option("no recording"))?;
        let read = segment_take(&take, &options, self.strict()).map_err(raised)?;
        let part = std::slice::from_ref(&read.spectra);
        let spectrum = TextureSpectrum::average(part, options.averaging).map_err(raised)?;
        Ok((take.recording, read, spectrum))
    }

    /// Reads a recording. If it comes from `htex record` or a study, the JSON file next to it
    /// specifies how it is read, unless a setting names the columns.
    fn read(&self, source: &Source, options: &ReadOptions) -> PyResult<Recording> {
        let path = match source {
            Source::Bytes(name, bytes) => {
                // Bytes have no JSON file next to them.
                return recording_from_bytes(Path::new(name), bytes, options).map_err(raised);
            }
            Source::File(path) => path,
        };
        let known = KnownTake::find(path).map_err(raised)?;
        let Some(known) = known.filter(|_| !self.settings().says_columns()) else {
            return read_recording(path, options).map_err(|error| unreadable(path, error));
        };
        let file = known.recording.clone();
        let settings = known.with_given(self.settings());
        let options = settings.read_options(1).map_err(|error| self.raised(error))?.pop();
        let read = read_recording(&file, &options.unwrap_or_default());
        read.map_err(|error| unreadable(&file, error))
    }

    /// Returns the options for computing spectra.
    pub(crate) fn spectrum_options(&self) -> PyResult<SpectrumOptions> {
        let options = self.settings().spectrum_options();
        options.map_err(|error| self.raised(error))
    }

    /// Makes the exception for a setting.
    pub(crate) fn raised(&self, error: AuthorError) -> PyErr {
        match (error, &self.settings().response) {
            // The response of the recording setup is the only file that a setting names.
            (AuthorError::Read(error), Some(file)) => unreadable(file, error),
            (other, _) => other.into_py_err(),
        }
    }
}

/// Makes the exception for a name that is not one of the known names.
pub(crate) fn unknown(what: &str, got: &str, known: &str) -> PyErr {
    option(format!("{what} is {got:?}; known are {known}"))
}

/// Makes the exception for a file that cannot be read, with its full path.
fn unreadable(path: &Path, error: ReadError) -> PyErr {
    match &error.problem {
        ReadProblem::Io(source) => of_file(path, source),
        _ => error.into_py_err(),
    }
}
