//! Compares recordings with textures and with other recordings.

use htex_author::{Difference, FluctuationDifference, compare as compared, fluctuation};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::author::condition;
use crate::errors::{RecordingError, raised};
use crate::python::from_json;
use crate::reading::{Reading, ReadingText, Source};
use crate::texture::Texture;

/// The texture or the other recording with which a recording is compared.
#[derive(FromPyObject)]
pub(crate) enum Other<'py> {
    Texture(PyRef<'py, Texture>),
    Recording(Source),
}

/// Compares a recording with each representation of a texture, or with another recording.
#[pyfunction]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    source: Source,
    other: Other<'py>,
    reading: ReadingText,
) -> PyResult<Bound<'py, PyAny>> {
    let reading = Reading::new(&reading)?;
    let found = match other {
        Other::Texture(texture) => {
            let texture = &*texture;
            py.detach(|| with_texture(source, texture, &reading))
        }
        Other::Recording(other) => py.detach(|| with_recording(source, other, &reading)),
    };
    from_json(py, &found?)
}

fn with_texture(source: Source, texture: &Texture, reading: &Reading) -> PyResult<Value> {
    let (recording, read, spectrum) = reading.spectrum(source)?;
    let fluctuates = fluctuation(&recording);
    let models = compared(texture.asset(), &spectrum, read.motion, fluctuates.as_ref());
    let models = models.map_err(raised)?;
    Ok(json!({
        "condition": condition(read.motion, &spectrum),
        "representations": models,
        "other": null,
        "other_condition": null,
        "warnings": read.warnings,
    }))
}

fn with_recording(source: Source, other: Source, reading: &Reading) -> PyResult<Value> {
    let (recording, read, spectrum) = reading.spectrum(source)?;
    let (other_recording, other_read, other) = reading.spectrum(other)?;
    let both = fluctuation(&recording).zip(fluctuation(&other_recording));
    let fluctuates = both.map(|(a, b)| FluctuationDifference::new(&a, &b));
    let difference = Difference::between(&spectrum, &other).ok_or_else(|| {
        RecordingError::new_err(format!(
            "{} at {} to {} Hz cannot be compared with {} at {} to {} Hz; compare recordings of one quantity and rate",
            other.quantity,
            other.band.low_hz,
            other.band.high_hz,
            spectrum.quantity,
            spectrum.band.low_hz,
            spectrum.band.high_hz,
        ))
    })?;
    let mut different = serde_json::to_value(&difference).unwrap_or_default();
    if let Value::Object(entries) = &mut different {
        entries.insert("fluctuation".to_owned(), json!(fluctuates));
    }
    let warnings = [read.warnings, other_read.warnings].concat();
    Ok(json!({
        "condition": condition(read.motion, &spectrum),
        "representations": [],
        "other": different,
        "other_condition": condition(other_read.motion, &other),
        "warnings": warnings,
    }))
}
