//! Recordings: where they come from, and how they are read.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use htex::Quantity;
use htex_author::read::{ColumnMap, ReadOptions, read_recording, recording_from_bytes};
use htex_author::response::read_response;
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
        let options = self.read_options()?;
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
        let take = |(i, source)| {
            Ok(Take {
                recording: read(source, &options)?,
                given: given(i),
            })
        };
        sources.iter().enumerate().map(take).collect()
    }

    /// Returns the options of computing spectra.
    pub(crate) fn spectrum_options(&self) -> PyResult<SpectrumOptions> {
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
        let response = self.response.as_deref().map(|file| {
            let read = read_response(file);
            read.map_err(|error| raised(file, error))
        });
        Ok(SpectrumOptions::default()
            .with_segments(segments)
            .with_averaging(averaging)
            .with_response(response.transpose()?))
    }

    /// Returns the options that differ from their defaults, under the names that the command gives them.
    pub(crate) fn recorded(&self) -> BTreeMap<String, String> {
        let number = |value: Option<f64>| value.map(|x| x.to_string());
        let unless = |text: &str, usual: &str| (text != usual).then(|| text.replace('_', "-"));
        let file = self.response.as_deref().and_then(Path::file_name);
        let entries = [
            ("rate", number(self.rate_hz)),
            ("map", self.map.clone()),
            (
                "quantity",
                unless(&self.quantity, Quantity::default().name()),
            ),
            ("scale", number(self.scale)),
            ("from", number(self.from_s)),
            ("to", number(self.to_s)),
            ("frf", file.map(|name| name.to_string_lossy().into_owned())),
            ("segments", unless(&self.segments, "auto")),
            ("averaging", unless(&self.averaging, "rms")),
        ];
        let said = entries.into_iter();
        said.filter_map(|(key, value)| Some((key.to_owned(), value?)))
            .collect()
    }

    fn read_options(&self) -> PyResult<ReadOptions> {
        let map = self.map.as_ref().map(|text| {
            let map = text.parse::<ColumnMap>();
            map.map_err(|error| option(format!("map {text}: {error}")))
        });
        let quantity = Quantity::from_name(&self.quantity).ok_or_else(|| {
            let known: Vec<&str> = Quantity::ALL.iter().map(|q| q.name()).collect();
            unknown("quantity", &self.quantity, &known.join(", "))
        })?;
        Ok(ReadOptions::default()
            .with_rate_hz(self.rate_hz)
            .with_map(map.transpose()?)
            .with_quantity(quantity)
            .with_scale(self.scale)
            .with_from_s(self.from_s)
            .with_to_s(self.to_s)
            .with_most_values(self.most_values))
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
fn raised(path: &Path, error: htex_author::read::ReadError) -> PyErr {
    match error {
        htex_author::read::ReadError::Io { source, .. } => of_file(path, &source),
        other => other.into_py_err(),
    }
}
