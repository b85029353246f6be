//! Voices: endless streams of samples that follow a motion.

use std::sync::{Mutex, MutexGuard, PoisonError};

use htex::Motion;
use htex::play::Reach;
use numpy::{IntoPyArray, PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::raised;
use crate::path::{Path, Series, located};
use crate::python::{data, zeros};

/// A voice: an endless stream of samples in the texture's unit, which follows the motion of the
/// finger.
#[pyclass(frozen, module = "htex")]
pub(crate) struct Voice {
    voice: Mutex<htex::Voice>,
    model: String,
    rate_hz: f64,
    seed: u64,
    unit: &'static str,
}

impl Voice {
    pub(crate) fn new(
        voice: htex::Voice,
        model: String,
        rate_hz: f64,
        seed: u64,
        unit: &'static str,
    ) -> Self {
        Self { voice: Mutex::new(voice), model, rate_hz, seed, unit }
    }

    /// Locks the voice. This may wait for a call in another thread, so call it only while the
    /// interpreter is released.
    fn lock(&self) -> MutexGuard<'_, htex::Voice> {
        self.voice.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Voice {
    /// Id of the model.
    #[getter]
    fn model(&self) -> &str {
        &self.model
    }

    /// Sample rate, hertz.
    #[getter]
    fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Seed of the noise.
    #[getter]
    fn seed(&self) -> u64 {
        self.seed
    }

    /// Unit of the samples.
    #[getter]
    fn unit(&self) -> &'static str {
        self.unit
    }

    /// Returns the next `n` samples.
    fn render<'py>(&self, py: Python<'py>, n: usize) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let samples = py.detach(|| {
            let mut samples = zeros(n)?;
            self.lock().render(&mut samples).map_err(raised)?;
            Ok::<_, PyErr>(samples)
        })?;
        Ok(samples.into_pyarray(py))
    }

    /// Fills an array with the next samples. Neither copies nor allocates.
    fn render_into(&self, py: Python<'_>, array: &Bound<'_, PyAny>) -> PyResult<()> {
        let Ok(array) = array.cast::<PyArray1<f32>>() else {
            let text = "expected a one-dimensional NumPy array of float32";
            return Err(PyTypeError::new_err(text));
        };
        // `as_slice_mut` would also refuse such an array, but its error gives no advice.
        if !array.is_c_contiguous() {
            let text = "the array is not contiguous; give one without gaps, or render and copy";
            return Err(PyValueError::new_err(text));
        }
        let mut borrowed = array.try_readwrite().map_err(|error| {
            PyValueError::new_err(format!("the array cannot be written to: {error}"))
        })?;
        let samples =
            borrowed.as_slice_mut().map_err(|error| PyValueError::new_err(error.to_string()))?;
        py.detach(|| self.lock().render(samples).map_err(raised))
    }

    /// Sets the motion of the following samples.
    #[pyo3(signature = (speed_mm_s, force_n, position_mm=None, *, x_mm=None, y_mm=None))]
    fn set_motion(
        &self,
        py: Python<'_>,
        speed_mm_s: f64,
        force_n: f64,
        position_mm: Option<f64>,
        x_mm: Option<f64>,
        y_mm: Option<f64>,
    ) -> PyResult<()> {
        let motion = Motion::new(speed_mm_s, force_n);
        let motion = located(motion, position_mm, [x_mm, y_mm])?;
        py.detach(|| self.lock().set_motion(motion).map_err(raised))
    }

    /// Returns the samples of a path, which has one motion for each block of samples.
    #[pyo3(signature = (speed_mm_s, force_n, position_mm=None, block=64, *, x_mm=None, y_mm=None))]
    #[allow(clippy::too_many_arguments)]
    fn render_path<'py>(
        &self,
        py: Python<'py>,
        speed_mm_s: Series,
        force_n: Series,
        position_mm: Option<Series>,
        block: usize,
        x_mm: Option<Series>,
        y_mm: Option<Series>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let samples = py.detach(|| {
            let place = [x_mm.as_ref(), y_mm.as_ref()];
            let path = Path::new(&speed_mm_s, &force_n, position_mm.as_ref(), place, block)?;
            let mut samples = path.buffer()?;
            let mut voice = self.lock();
            for (motion, block) in path.motions.iter().zip(samples.chunks_mut(path.block)) {
                voice.set_motion(*motion).map_err(raised)?;
                voice.render(block).map_err(raised)?;
            }
            Ok::<_, PyErr>(samples)
        })?;
        Ok(samples.into_pyarray(py))
    }

    /// Sets the gain. The voice reaches the new gain within 10 ms.
    fn set_gain(&self, py: Python<'_>, gain: f64) -> PyResult<()> {
        py.detach(|| self.lock().set_gain(gain).map_err(raised))
    }

    /// Whether the voice is silent: its samples are 0 until the finger slides again.
    #[getter]
    fn is_silent(&self, py: Python<'_>) -> bool {
        py.detach(|| self.lock().is_silent())
    }

    /// Edges of the bands of `envelope`, hertz. There is one edge more than bands.
    #[getter]
    fn envelope_edges_hz<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let edges_hz = py.detach(|| self.lock().envelope_edges_hz().to_vec());
        edges_hz.into_pyarray(py)
    }

    /// Returns the level, the mean frequency and the mean square in each band of what was rendered
    /// since the last call.
    fn envelope<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (envelope, bands) = py.detach(|| {
            let mut voice = self.lock();
            let mut bands = vec![0.0; voice.envelope_edges_hz().len().saturating_sub(1)];
            let envelope = voice.envelope(&mut bands).map_err(raised)?;
            Ok::<_, PyErr>((envelope, bands))
        })?;
        let fields = PyDict::new(py);
        fields.set_item("level_rms", envelope.level_rms)?;
        fields.set_item("centroid_hz", envelope.centroid_hz)?;
        fields.set_item("frames", envelope.frames)?;
        fields.set_item("bands", bands.into_pyarray(py))?;
        data(py, "Envelope", &fields)
    }

    /// Returns how this voice plays a motion, and whether the motion lies within the recorded
    /// conditions.
    fn coverage<'py>(
        &self,
        py: Python<'py>,
        speed_mm_s: f64,
        force_n: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let motion = Motion::new(speed_mm_s, force_n).checked().map_err(raised)?;
        let coverage = py.detach(|| self.lock().coverage(motion));
        let fields = PyDict::new(py);
        fields.set_item("inside", coverage.is_inside())?;
        fields.set_item("slides", coverage.slides)?;
        fields.set_item("excess", coverage.excess())?;
        fields.set_item("description", coverage.to_string())?;
        fields.set_item("frequency_factor", coverage.scaling.frequency)?;
        fields.set_item("level_factor", coverage.scaling.level)?;
        fields.set_item("speed", reach(py, coverage.speed)?)?;
        fields.set_item("force", reach(py, coverage.force)?)?;
        data(py, "Coverage", &fields)
    }

    fn __repr__(&self) -> String {
        let (model, rate, unit) = (&self.model, self.rate_hz, self.unit);
        format!("<htex.Voice of {model} at {rate} Hz in {unit}, seed {}>", self.seed)
    }
}

fn reach(py: Python<'_>, reach: Reach) -> PyResult<Bound<'_, PyAny>> {
    let fields = PyDict::new(py);
    let kind = match reach {
        Reach::Inside => "inside",
        Reach::Unknown => "unknown",
        Reach::Followed => "followed",
        Reach::Outside { asked, recorded } => {
            fields.set_item("asked", asked)?;
            fields.set_item("recorded", recorded)?;
            "outside"
        }
    };
    fields.set_item("kind", kind)?;
    data(py, "Reach", &fields)
}
