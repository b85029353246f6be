//! Voices that are written in Python: objects with a method `render`.

use htex::model::RuntimeVoice;
use htex_model::{Error, Values};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::causes::failed;
use crate::errors::option;

/// A voice that is written in Python. It holds an object of the package that calls the author's
/// voice.
pub(crate) struct PlayedVoice {
    adapter: Py<PyAny>,
}

impl PlayedVoice {
    /// Makes a voice from an object with the methods `render` and `retune`.
    pub(crate) fn new(adapter: Py<PyAny>) -> Self {
        Self { adapter }
    }
}

impl RuntimeVoice for PlayedVoice {
    fn render(&mut self, out: &mut [f32]) -> Result<(), Error> {
        let adapter = &self.adapter;
        Python::attach(|py| {
            let mut called = || {
                let rendered = adapter.bind(py).call_method1("render", (out.len(),))?;
                let samples = rendered.cast::<PyArray1<f32>>()?.try_readonly();
                let samples = samples.map_err(|error| option(error.to_string()))?;
                let samples = samples.as_slice()?;
                if samples.len() != out.len() {
                    let (got, wanted) = (samples.len(), out.len());
                    return Err(option(format!("render returned {got} samples of {wanted}")));
                }
                out.copy_from_slice(samples);
                Ok(())
            };
            called().map_err(|error| failed(py, error))
        })
    }

    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        let adapter = &self.adapter;
        Python::attach(|py| {
            let flat = PyArray1::from_slice(py, parameters.flat());
            let called = adapter.bind(py).call_method1("retune", (flat,));
            called.map(|_| ()).map_err(|error| failed(py, error))
        })
    }
}
