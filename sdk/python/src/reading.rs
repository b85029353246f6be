//! Recordings: where they come from, and how they are read.

use std::path::{Path, PathBuf};

use htex::Quantity;
use htex_author::recording::{
    ReadError, ReadOptions, ReadProblem, read_recording, recording_from_bytes,
};
use htex_author::settings::{ReadingSettings, SettingsError};
use htex_author::{Averaging, Exploration, Recording, SegmentChoice, SpectrumOptions, Take};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;

use crate::errors::{IntoPyErr, OrRaise, of_file, option};

/// A recording: a file, or a name and the bytes of a file.
#[derive(FromPyObject)]
pub(crate) enum Source {
    /// A name, and bytes.
    Bytes(String, PyBackedBytes),
    /// A path.
    #[pyo3(transparent)]
    File(PathBuf),
}

/// Options of reading recordings: the keywords of the package's functions.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Reading {
    rate_hz: Option<f64>,
    map: Option<String>,
    tracker: Option<PathBuf>,
    tracker_map: Option<String>,
    quantity: String,
    scale: Option<f64>,
    response: Option<PathBuf>,
    from_s: Option<f64>,
    to_s: Option<f64>,
    most_values: Option<usize>,
    segments: String,
    averaging: String,
    speed_mm_s: Option<f64>,
    force_n: Option<f64>,
    pub(crate) strict: bool,
}

/// A speed and a force, mm/s and newtons.
pub(crate) type Pair = (Option<f64>, Option<f64>);

impl Reading {
    /// Reads recordings. `conditions` has one entry for each of them, or one for all, or none.
    pub(crate) fn takes(&self, sources: &[Source], conditions: &[Pair]) -> PyResult<Vec<Take>> {
        let options = self.settings()?.read_options(sources.len());
        let options = options.map_err(|error| self.raised(error))?;
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
                speed_mm_s: speed_mm_s.or(self.speed_mm_s),
                force_n: force_n.or(self.force_n),
            }
        };
        let take = |(i, (source, options))| {
            Ok(Take {
                recording: read(source, options)?,
                given: given(i),
            })
        };
        sources.iter().zip(&options).enumerate().map(take).collect()
    }

    /// Returns the keywords as settings.
    pub(crate) fn settings(&self) -> PyResult<ReadingSettings> {
        let segments = match &self.segments[..] {
            "auto" => SegmentChoice::Auto,
            "sweeps" => SegmentChoice::Sweeps,
            "windows" => SegmentChoice::Windows,
            other => return Err(unknown("segments", other, "auto, sweeps, windows")),
        };
        let averaging = match &self.averaging[..] {
            "rms" => Averaging::Rms,
            "magnitude" => Averaging::Magnitude,
            "complex" => Averaging::Complex,
            other => return Err(unknown("averaging", other, "rms, magnitude, complex")),
        };
        let quantity = Quantity::from_name(&self.quantity).ok_or_else(|| {
            let known: Vec<&str> = Quantity::ALL.iter().map(|q| q.name()).collect();
            unknown("quantity", &self.quantity, &known.join(", "))
        })?;
        Ok(ReadingSettings {
            rate_hz: self.rate_hz,
            map: self.map.clone(),
            tracker: self.tracker.clone().map(|file| vec![file]),
            tracker_map: self.tracker_map.clone(),
            quantity: Some(quantity),
            scale: self.scale,
            response: self.response.clone(),
            from_s: self.from_s,
            to_s: self.to_s,
            most_values: self.most_values,
            segments: Some(segments),
            averaging: Some(averaging),
        })
    }

    /// Returns the options of computing spectra.
    pub(crate) fn spectrum_options(&self) -> PyResult<SpectrumOptions> {
        let options = self.settings()?.spectrum_options();
        options.map_err(|error| self.raised(error))
    }

    /// Makes the exception of a setting.
    pub(crate) fn raised(&self, error: SettingsError) -> PyErr {
        match (error, &self.response) {
            (SettingsError::Response(error), Some(file)) => raised(file, *error),
            (SettingsError::Response(error), None) => (*error).into_py_err(),
            (SettingsError::Model(error), _) => error.into_py_err(),
            (SettingsError::Grid(error), _) => (*error).into_py_err(),
            (other, _) => option(other.to_string()),
        }
    }
}

/// Makes the exception of a text that is not one of some names.
pub(crate) fn unknown(what: &str, got: &str, known: &str) -> PyErr {
    option(format!("{what} is {got:?}; known are {known}"))
}

fn read(source: &Source, options: &ReadOptions) -> PyResult<Recording> {
    match source {
        Source::Bytes(name, bytes) => {
            recording_from_bytes(Path::new(name), bytes, options).or_raise()
        }
        Source::File(path) => read_recording(path, options).map_err(|error| raised(path, error)),
    }
}

/// Makes the exception of a file that cannot be read, with its whole path.
fn raised(path: &Path, error: ReadError) -> PyErr {
    match &error.problem {
        ReadProblem::Io(source) => of_file(path, source),
        _ => error.into_py_err(),
    }
}
