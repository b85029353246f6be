//! Models that are written in Python. Such models run only in this process, and under the global
//! interpreter lock.
//!
//! Each model is an object that implements [`RuntimeModel`]. The host checks the arguments and
//! results of this object as for any other model. The host passes on only the text of an exception.
//! So the package raises a new exception to the user, and sets the original exception as its cause.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use htex::model::{Descriptor, Registry, RuntimeModel, RuntimeVoice, read_descriptor};
use htex_dsp::Band;
use htex_dsp::grid::level_rms;
use htex_dsp::shaped_noise::{ShapedNoise, economical_rate_hz};
use htex_model::{Error, Fit, FitInput, Values};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::causes::failed;
use crate::errors::{option, raised};
use crate::python_voice::PlayedVoice;

/// Names the origin of these models in messages and assets.
const ORIGIN: &str = "Python, this process only";

/// The registered models, in the order of registration.
static REGISTERED: Mutex<Vec<(Descriptor, Arc<PythonModel>)>> = Mutex::new(Vec::new());

/// Locks the list. This may wait for another thread, so call it only while the interpreter is
/// released.
fn registered() -> MutexGuard<'static, Vec<(Descriptor, Arc<PythonModel>)>> {
    REGISTERED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Registers a model, and replaces a registered model with the same id. `adapter` converts
/// parameters and checks results.
#[pyfunction]
pub(crate) fn register_model(
    py: Python<'_>,
    descriptor: &str,
    adapter: Py<PyAny>,
    plays: bool,
) -> PyResult<()> {
    let descriptor = read_descriptor(descriptor).map_err(|error| option(error.to_string()))?;
    let id = descriptor.id.clone();
    let builtin = Registry::builtin();
    if builtin.models().iter().any(|model| model.id() == id) {
        let text = format!("a built-in model has the id {id}; choose another id");
        return Err(option(text));
    }
    let model = Arc::new(PythonModel { adapter, plays });
    let old = py.detach(|| {
        let mut all = registered();
        let old = all.iter().position(|(other, _)| other.id == id).map(|i| all.remove(i));
        all.push((descriptor, model));
        old
    });
    // The old model is dropped here, where this thread holds the interpreter but not the lock,
    // because the drop may run the author's code.
    drop(old);
    Ok(())
}

/// Removes a registered model, so that later searches do not find it. Returns whether a model with
/// this id was registered.
#[pyfunction]
pub(crate) fn unregister_model(py: Python<'_>, id: &str) -> bool {
    let old = py.detach(|| {
        let mut all = registered();
        let old = all.iter().position(|(other, _)| other.id == id);
        old.map(|i| all.remove(i))
    });
    old.is_some()
}

/// Adds the registered models to the results of a search.
pub(crate) fn add_to(registry: &mut Registry) -> PyResult<()> {
    // A copy, so that the lock is free while the models are checked and added.
    let all = registered().clone();
    for (descriptor, model) in all {
        registry.add_runtime_model(ORIGIN, descriptor, model).map_err(raised)?;
    }
    Ok(())
}

/// A model that is written in Python. It holds an object of the package that calls the author's
/// class.
pub(crate) struct PythonModel {
    adapter: Py<PyAny>,
    /// Whether the class makes its own voices. If not, voices play noise with the magnitudes of the
    /// class.
    plays: bool,
}

fn array<'py>(py: Python<'py>, numbers: &[f64]) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, numbers)
}

/// Converts an array or a sequence to numbers. It must have `wanted` entries.
fn numbers(value: &Bound<'_, PyAny>, wanted: usize) -> PyResult<Vec<f64>> {
    let numbers: Vec<f64> = value.extract()?;
    if numbers.len() == wanted {
        Ok(numbers)
    } else {
        Err(option(format!("{} numbers for {wanted} frequencies", numbers.len())))
    }
}

impl PythonModel {
    /// Returns the magnitudes for parameters, at frequencies in the band. They are scaled so that
    /// the RMS over the band's grid is 1.
    pub(crate) fn curve(
        &self,
        parameters: &[f64],
        band: Band,
        frequency_hz: &[f64],
    ) -> Result<Vec<f64>, Error> {
        // A single call to Python gets the magnitudes at the grid, which determine the level, and
        // then at `frequency_hz`.
        let mut all = band.grid_hz();
        let bins = all.len();
        all.extend(frequency_hz);
        let mut magnitude = Python::attach(|py| {
            let called = || {
                let adapter = self.adapter.bind(py);
                let arguments = (array(py, parameters), array(py, &all));
                numbers(&adapter.call_method1("magnitude", arguments)?, all.len())
            };
            called().map_err(|error| failed(py, error))
        })?;
        let level = level_rms(&magnitude[..bins]);
        if !(level.is_finite() && level > 0.0) {
            return Err(Error::parameters(
                "the magnitude is 0 at all frequencies of the band's grid, or too large",
            ));
        }
        let mut asked = magnitude.split_off(bins);
        asked.iter_mut().for_each(|m| *m /= level);
        Ok(asked)
    }
}

impl RuntimeModel for PythonModel {
    fn fit(&self, input: &FitInput<'_>) -> Result<Fit, Error> {
        let parameters = Python::attach(|py| {
            let called = || {
                let arguments = (array(py, input.frequency_hz), array(py, input.magnitude));
                let fitted = self.adapter.bind(py).call_method1("fit", arguments)?;
                fitted.extract::<Vec<f64>>()
            };
            called().map_err(|error| failed(py, error))
        })?;
        Ok(Fit { parameters, level_rms: level_rms(input.magnitude) })
    }

    fn magnitude(
        &self,
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        let inside: Vec<f64> =
            frequency_hz.iter().copied().filter(|hz| band.contains(*hz)).collect();
        let mut curve = self.curve(parameters.flat(), band, &inside)?.into_iter();
        for (m, hz) in magnitude.iter_mut().zip(frequency_hz) {
            let found = band.contains(*hz).then(|| curve.next()).flatten();
            *m = found.unwrap_or(0.0);
        }
        Ok(())
    }

    fn voice_rate_hz(&self, _: &Values<'_>, band: Band, wanted_hz: f64) -> f64 {
        if self.plays { wanted_hz } else { economical_rate_hz(wanted_hz, band) }
    }

    fn voice(
        &self,
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Box<dyn RuntimeVoice>, Error> {
        let model =
            // A `Py` can be cloned only while this thread holds the interpreter.
            Python::attach(|py| Self { adapter: self.adapter.clone_ref(py), plays: self.plays });
        if self.plays {
            let voice = Python::attach(|py| {
                let arguments = (array(py, parameters.flat()), rate_hz, seed);
                let made = model.adapter.bind(py).call_method1("voice", arguments);
                made.map(Bound::unbind).map_err(|error| failed(py, error))
            })?;
            return Ok(Box::new(PlayedVoice::new(voice)));
        }
        let mut noise = ShapedNoise::new(rate_hz, band, seed);
        let curve = model.curve(parameters.flat(), band, noise.component_hz())?;
        noise.start(|i, _| curve[i]);
        Ok(Box::new(ShapedVoice { model, band, noise }))
    }
}

/// A voice that plays noise with a model's magnitudes. Changing the parameters calls Python;
/// rendering does not.
struct ShapedVoice {
    model: PythonModel,
    band: Band,
    noise: ShapedNoise,
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
