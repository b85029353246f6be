//! Measures the accuracy of models against their size in bytes and their computing time.

use std::path::PathBuf;

use htex_author::settings::named_models;
use htex_author::tradeoff::{ErrorAxis, Journal, Model, Request, Subject, Tradeoff, sweep};
use pyo3::prelude::*;

use crate::errors::{of_file, raised};
use crate::models::registry;
use crate::python::from_json;
use crate::reading::{Reading, ReadingText, Source, unknown};

/// Options for a sweep: keywords of the package's function `tradeoff`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Sweep {
    models: Vec<String>,
    quick: bool,
    error: Option<String>,
    plugins: Vec<PathBuf>,
    installed: bool,
    journal: Option<PathBuf>,
}

/// Measures models and options on recordings. Returns the points, knees and warnings.
#[pyfunction]
pub(crate) fn tradeoff(
    py: Python<'_>,
    sources: Vec<Source>,
    reading: ReadingText,
    request: Sweep,
) -> PyResult<Bound<'_, PyAny>> {
    let reading = Reading::new(&reading)?;
    // Only the same build of htex may continue a journal. The running program is Python, so the
    // file of this extension module identifies the build.
    let program: PathBuf = py.import("htex._htex")?.getattr("__file__")?.extract()?;
    let tradeoff = py.detach(|| measured(&sources, &reading, &request, program))?;
    from_json(py, &tradeoff)
}

fn measured(
    sources: &[Source],
    reading: &Reading,
    request: &Sweep,
    program: PathBuf,
) -> PyResult<Tradeoff> {
    let error_named = |name: &String| {
        let known = ErrorAxis::ALL.map(ErrorAxis::id).join(", ");
        ErrorAxis::find(name).ok_or_else(|| unknown("error", name, &known))
    };
    let error = request.error.as_ref().map(error_named).transpose()?;
    let registry = registry(&request.plugins, request.installed)?;
    let models = named_models(&registry, &request.models)
        .map_err(raised)?
        .into_iter()
        .map(|model| Model { ways: vec![(model.origin().to_string(), model)] });
    let swept = Request { models: models.collect(), quick: request.quick, error, program };
    let options = reading.spectrum_options()?;
    let takes = reading.takes(sources, &[])?;
    let mut subjects: Vec<Subject> = Vec::new();
    for (i, take) in takes.iter().enumerate() {
        let mut subject = Subject::new(take, &options, reading.strict()).map_err(raised)?;
        if subjects.iter().any(|other| other.name == subject.name) {
            subject.name += &format!(" #{}", i + 1);
        }
        subjects.push(subject);
    }
    // The folder is always made, because it must outlive the journal.
    let folder = tempfile::tempdir().map_err(|error| of_file(&std::env::temp_dir(), &error))?;
    let kept = request.journal.clone();
    let file = kept.unwrap_or_else(|| folder.path().join("sweep.part"));
    let mut journal = Journal::new(&file);
    let swept = sweep(&subjects, &swept, &mut journal, &|_, _, _| {}).map_err(raised)?;
    journal.discard().map_err(raised)?;
    let tool = concat!("htex ", env!("CARGO_PKG_VERSION"));
    Ok(Tradeoff::new(tool, &subjects, swept))
}
