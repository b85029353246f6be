//! Voices of models that are written in Python: shaped noise, and objects with a method `render`.

use htex::host::RuntimeVoice;
use htex_dsp::Band;
use htex_dsp::shaped_noise::ShapedNoise;
use htex_model::{Error, Values};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::errors::option;
use crate::python_model::{PythonModel, failed};

/// Noise with the magnitudes of a model. Rendering does not call Python; changing the parameters does.
pub(crate) struct ShapedVoice {
    model: PythonModel,
    band: Band,
    noise: ShapedNoise,
}

impl ShapedVoice {
    /// Makes a voice of noise that was started with the model's magnitudes.
    pub(crate) fn new(model: PythonModel, band: Band, noise: ShapedNoise) -> Self {
        Self { model, band, noise }
    }
}

impl RuntimeVoice for ShapedVoice {
    fn render(&mut self, out: &mut [f32]) -> Result<(), Error> {
        self.noise.render(out);
        Ok(())
    }

    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        let hz = self.noise.component_hz();
        let curve = self.model.curve(parameters.flat(), self.band, hz)?;
        self.noise.retune(|i, _| curve[i]);
        Ok(())
    }
}

/// An object of the package that calls the voice of the author's class.
pub(crate) struct PlayedVoice {
    adapter: Py<PyAny>,
}

impl PlayedVoice {
    /// Makes a voice of an object with the methods `render` and `retune`.
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
