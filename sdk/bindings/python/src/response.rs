//! Frequency responses of recording rigs and finger displays.

use htex_author::SetupResponse;
use htex_lab::LabError;
use htex_lab::response::{Record, ResponseSettings, measure};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::json;

use crate::errors::{IntoPyErr, RecordingError, option, raised};
use crate::python::{from_json, parsed};

/// Measures a response from recordings of an input and an output. Each pair in `records` is one
/// recording.
#[pyfunction]
pub(crate) fn response<'py>(
    py: Python<'py>,
    records: Vec<(Vec<f64>, Vec<f64>)>,
    rate_hz: f64,
    settings: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let settings = parsed::<ResponseSettings>(settings)?;
    let measured = py.detach(|| {
        let record = |(i, (input, output)): (usize, (Vec<f64>, Vec<f64>))| {
            Record::new(format!("recording {}", i + 1), rate_hz, input, output)
        };
        let records: Result<Vec<Record>, _> = records.into_iter().enumerate().map(record).collect();
        measure(&records?, &settings)
    });
    from_json(py, &json!({"measured": measured.map_err(raised)?, "settings": settings.resolved()}))
}

/// Returns a response as the bytes of a CSV file.
#[pyfunction]
pub(crate) fn response_csv(
    py: Python<'_>,
    frequency_hz: Vec<f64>,
    magnitude: Vec<f64>,
    phase_rad: Vec<f64>,
) -> PyResult<Bound<'_, PyBytes>> {
    let lengths = [magnitude.len(), phase_rad.len()];
    if lengths.iter().any(|length| *length != frequency_hz.len()) {
        return Err(option(format!(
            "a response of {} frequencies, {} magnitudes and {} phases; give equally many",
            frequency_hz.len(),
            lengths[0],
            lengths[1]
        )));
    }
    let response = SetupResponse { frequency_hz, magnitude, phase_rad };
    let mut csv = Vec::new();
    response.write_csv(&mut csv)?;
    Ok(PyBytes::new(py, &csv))
}

impl IntoPyErr for LabError {
    fn into_py_err(self) -> PyErr {
        match self {
            Self::Option { .. } | Self::Rate { .. } | Self::Lengths { .. } => {
                option(self.to_string())
            }
            other => RecordingError::new_err(other.to_string()),
        }
    }
}
