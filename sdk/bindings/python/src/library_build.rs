//! Builds libraries. The jobs of a build can run in any process on any machine.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use htex::model::WasmLimits;
use htex_base::files::{FileError, FileProblem};
use htex_build::{BuildError, BuildOptions, Destination, Job, Workbench};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;

use crate::author::TOOL;
use crate::errors::{BuildError as Raised, of_file, option};
use crate::python::from_json;

/// A planned build of a library from a recipe.
#[pyclass(frozen, module = "htex._htex")]
pub(crate) struct Build(Mutex<Option<htex_build::Build>>, Destination);

#[pymethods]
impl Build {
    /// Reads a recipe and hashes its recordings.
    #[new]
    fn new(
        py: Python<'_>,
        recipe: PathBuf,
        output: OsString,
        keep_going: bool,
        work: Option<PathBuf>,
        plugins: Vec<PathBuf>,
        no_removals: bool,
    ) -> PyResult<Self> {
        let to = Destination::parse(&output, work.as_deref()).map_err(raised)?;
        let options = BuildOptions {
            keep_going,
            plugins,
            no_removals,
            published: to.remote().cloned(),
            ..BuildOptions::new(TOOL)
        };
        let build = py
            .detach(|| htex_build::Build::open(&recipe, to.folder(), options))
            .map_err(|error| failed(&to, error))?;
        Ok(Self(Mutex::new(Some(build)), to))
    }

    /// Returns the pending jobs. Each has a key, the job as JSON, and the size of its recordings in
    /// bytes.
    fn pending(&self) -> PyResult<Vec<(String, String, u64)>> {
        let build = self.lock();
        let jobs = open(&build)?.pending().map(|(key, job)| {
            let text = serde_json::to_string(job).map_err(|error| option(error.to_string()))?;
            Ok((key.to_owned(), text, job.recording_bytes()))
        });
        jobs.collect()
    }

    /// Number of textures in the recipe.
    #[getter]
    fn textures(&self) -> PyResult<usize> {
        Ok(open(&self.lock())?.plan().textures.len())
    }

    /// Stores the result of a job.
    fn store(&self, py: Python<'_>, key: &str, made: PyBackedBytes) -> PyResult<()> {
        py.detach(|| match &mut *self.lock() {
            Some(build) => build.store(key, &made).map_err(|error| failed_while_open(build, error)),
            None => Err(finished()),
        })
    }

    /// Runs the pending jobs in this process.
    fn run(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| match &mut *self.lock() {
            Some(build) => {
                let ready = match build.pending().len() {
                    // If there is something to fit, first tests that the store accepts files.
                    // Otherwise the time for fitting could be lost.
                    0 => Ok(()),
                    _ => self.1.try_out(),
                };
                let ran = ready.and_then(|()| build.run(&|_| ()));
                ran.map_err(|error| failed_while_open(build, error))
            }
            None => Err(finished()),
        })
    }

    /// Writes the library and the report, and returns the report.
    fn finish<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let build = self.lock().take().ok_or_else(finished)?;
        let built = py
            .detach(|| {
                let built = build.finish()?;
                self.1.publish().map(|_| built)
            })
            .map_err(|error| failed(&self.1, error))?;
        let report = serde_json::to_value(&built);
        from_json(py, &report.map_err(|error| option(error.to_string()))?)
    }
}

impl Build {
    fn lock(&self) -> MutexGuard<'_, Option<htex_build::Build>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn open<'a>(
    build: &'a MutexGuard<'_, Option<htex_build::Build>>,
) -> PyResult<&'a htex_build::Build> {
    build.as_ref().ok_or_else(finished)
}

fn finished() -> PyErr {
    option("the build is finished; make another one")
}

/// Returns the folder on this machine in which the results are made.
#[pyfunction]
pub(crate) fn work_folder(output: OsString, work: Option<PathBuf>) -> PyResult<OsString> {
    let to = Destination::parse(&output, work.as_deref()).map_err(raised)?;
    Ok(to.folder().into())
}

/// Returns the recordings of a recipe whose hashes are not yet known, as paths and URIs.
#[pyfunction]
pub(crate) fn unhashed(
    py: Python<'_>,
    recipe: PathBuf,
    output: PathBuf,
) -> PyResult<Vec<OsString>> {
    let files = py.detach(|| htex_build::unhashed(&recipe, &output));
    Ok(files.map_err(raised)?.into_iter().map(OsString::from).collect())
}

/// Hashes a file of a recipe, and returns the hash as JSON.
#[pyfunction]
pub(crate) fn hash_file(py: Python<'_>, recipe: PathBuf, file: PathBuf) -> PyResult<String> {
    let hashed = py.detach(|| htex_build::hash_file(&recipe, &file)).map_err(raised)?;
    serde_json::to_string(&hashed).map_err(|error| option(error.to_string()))
}

/// Stores the hashes of files, so that the next build need not compute them.
#[pyfunction]
pub(crate) fn remember(
    py: Python<'_>,
    output: PathBuf,
    hashed: Vec<(PathBuf, String)>,
) -> PyResult<()> {
    let hashed = hashed
        .into_iter()
        .map(|(file, text)| {
            let hashed = serde_json::from_str(&text);
            Ok((file, hashed.map_err(|error| option(error.to_string()))?))
        })
        .collect::<PyResult<Vec<_>>>()?;
    py.detach(|| htex_build::remember(&output, hashed)).map_err(raised)
}

/// Runs a job, which is given as its key and as JSON, and returns the result.
#[pyfunction]
pub(crate) fn run_job<'py>(py: Python<'py>, key: &str, job: &str) -> PyResult<Bound<'py, PyBytes>> {
    let job: Job = serde_json::from_str(job)
        .map_err(|error| option(format!("the job cannot be read: {error}")))?;
    if job.program != TOOL || job.key() != key {
        let given = &job.program;
        return Err(option(format!(
            "the job is one of {given} and this is {TOOL}; install the same version everywhere"
        )));
    }
    let made = py.detach(|| {
        let made = job.run(&mut Workbench::of_job(WasmLimits::default(), &job)?)?;
        made.to_bytes(key)
    });
    Ok(PyBytes::new(py, &made.map_err(raised)?))
}

/// Converts an error to an exception. Also writes it to the report in the folder, as `htex build`
/// does.
fn failed(to: &Destination, error: BuildError) -> PyErr {
    if matches!(error, BuildError::Removes { .. }) {
        return raised(error);
    }
    // If the report cannot be written either, the error that is raised already concerns that
    // folder.
    let _ = htex_build::report_failure(to.folder(), TOOL, &lines(&error));
    raised(error)
}

/// Does the same as [`failed`], for a build that has opened its folder.
fn failed_while_open(build: &htex_build::Build, error: BuildError) -> PyErr {
    let _ = build.report_failure(&lines(&error));
    raised(error)
}

fn lines(error: &BuildError) -> Vec<String> {
    error.to_string().lines().map(str::to_owned).collect()
}

fn raised(error: BuildError) -> PyErr {
    match error {
        BuildError::File(FileError {
            file,
            problem: FileProblem::Read(error) | FileProblem::Write(error),
        }) => of_file(&file, &error),
        other => Raised::new_err(other.to_string()),
    }
}
