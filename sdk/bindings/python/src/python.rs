//! Converts values for Python: JSON to dicts, and results to the package's data classes.

use numpy::IntoPyArray;
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::errors::option;

/// Converts a value to its JSON, and the JSON to Python dicts, lists, strings and numbers. NaN
/// becomes `None`.
pub(crate) fn from_json<'py>(
    py: Python<'py>,
    value: &impl Serialize,
) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|error| option(error.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}

/// Parses a value that the package passes as JSON, such as the settings of a function.
pub(crate) fn parsed<T: DeserializeOwned>(json: &str) -> PyResult<T> {
    let value: Value = serde_json::from_str(json).map_err(|error| option(error.to_string()))?;
    serde_path_to_error::deserialize(value).map_err(|error| {
        let (path, problem) = (error.path().to_string(), error.into_inner());
        option(match &path[..] {
            "." => problem.to_string(),
            path => format!("{path}: {problem}"),
        })
    })
}

/// Makes an instance of one of the package's data classes.
pub(crate) fn data<'py>(
    py: Python<'py>,
    class: &str,
    fields: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyAny>> {
    let class = py.import("htex._data")?.getattr(class)?;
    class.call((), Some(fields))
}

/// Makes a `Spectrum`.
pub(crate) fn spectrum(
    py: Python<'_>,
    quantity: htex::format::Quantity,
    band: htex::model::Band,
    frequency_hz: Vec<f64>,
    magnitude: Vec<f64>,
) -> PyResult<Bound<'_, PyAny>> {
    let fields = PyDict::new(py);
    fields.set_item("frequency_hz", frequency_hz.into_pyarray(py))?;
    fields.set_item("magnitude", magnitude.into_pyarray(py))?;
    fields.set_item("quantity", quantity.name())?;
    fields.set_item("unit", quantity.unit())?;
    fields.set_item("band_hz", band.edges())?;
    data(py, "Spectrum", &fields)
}

/// Returns a vector of `n` zeros.
///
/// # Errors
/// `MemoryError` when there is not enough memory.
pub(crate) fn zeros(n: usize) -> PyResult<Vec<f32>> {
    let mut samples = Vec::new();
    // `vec!` would abort the whole interpreter if there is not enough memory.
    let reserved = samples.try_reserve_exact(n);
    reserved.map_err(|_| {
        PyMemoryError::new_err(format!("no memory for {n} samples; render fewer at a time"))
    })?;
    samples.resize(n, 0.0);
    Ok(samples)
}
