//! Devices play samples. A program selects a device by its name.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use htex_device::{
    Capabilities, DeviceError, Devices, Direction, Output, Quantity, Search, Settings, StreamFormat,
};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;

use crate::errors::{DeviceError as Failed, option};
use crate::python::{data, from_json};

/// An open device, which plays samples. If it is closed without `finish`, it goes to rest at once.
#[pyclass(module = "htex")]
pub(crate) struct Device {
    name: String,
    /// `None` when the device is closed. The lock is only needed to make the class thread-safe for
    /// PyO3: each call already has the object to itself.
    device: Mutex<Option<Box<dyn Output>>>,
    can: Capabilities,
    rate_hz: f64,
}

#[pymethods]
impl Device {
    #[new]
    #[pyo3(signature = (name, *, rate_hz=None, profile=None, settings=BTreeMap::new(), installed=false))]
    fn new(
        py: Python<'_>,
        name: String,
        rate_hz: Option<f64>,
        profile: Option<&str>,
        settings: BTreeMap<String, Bound<'_, PyAny>>,
        installed: bool,
    ) -> PyResult<Self> {
        let mut given = BTreeMap::new();
        for (name, value) in settings {
            given.insert(name, value.str()?.to_string());
        }
        py.detach(|| {
            let devices = devices(installed).map_err(raised)?;
            let known = devices.find_output(&name).map_err(raised)?;
            let settings = Settings::resolve(known.descriptor(), profile, &given).map_err(raised)?;
            let can = known.adapter.capabilities(&settings).map_err(raised)?;
            if can.quantity == Quantity::DisplayVoltage && can.paced {
                let text = format!(
                    "{name} drives a display by a voltage, which a process beside the program must take away if the program dies; use `htex play`"
                );
                return Err(Failed::new_err(text));
            }
            let rate_hz = rate_hz.unwrap_or(can.default_rate_hz);
            let format = StreamFormat {
                rate_hz,
                block_frames: can.block_frames,
            };
            let device = known.adapter.open_output(&settings, &format).map_err(raised)?;
            Ok(Self {
                name,
                device: Mutex::new(Some(device)),
                can,
                rate_hz,
            })
        })
    }

    /// Sample rate, hertz.
    #[getter]
    fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Unit of the samples. It is empty for fractions of full scale.
    #[getter]
    fn unit(&self) -> &'static str {
        self.can.quantity.unit()
    }

    /// Passes samples to the device, as many as it accepts within `timeout_s`, and returns their
    /// number.
    #[pyo3(signature = (samples, timeout_s=1.0))]
    fn write(
        &mut self,
        py: Python<'_>,
        samples: PyReadonlyArray1<'_, f32>,
        timeout_s: f64,
    ) -> PyResult<usize> {
        let timeout = Duration::try_from_secs_f64(timeout_s)
            .map_err(|_| option(format!("timeout_s is {timeout_s}; at least 0")))?;
        // The samples are copied, because other threads may change the array while the interpreter
        // is released.
        let samples = samples.as_slice()?.to_vec();
        let device = self.open()?;
        py.detach(|| device.write(&samples, timeout)).map_err(raised)
    }

    /// What the device has done so far.
    #[getter]
    fn status<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let status = self.open()?.status();
        let fields = PyDict::new(py);
        fields.set_item("frames_written", status.frames_written)?;
        fields.set_item("frames_played", status.frames_played)?;
        fields.set_item("underruns", status.underruns)?;
        fields.set_item("latency_s", status.latency_s)?;
        fields.set_item("peak", status.peak)?;
        data(py, "DeviceStatus", &fields)
    }

    /// Plays all samples that were written, then brings the device to rest. The device `file` saves
    /// its file.
    fn finish(&mut self, py: Python<'_>) -> PyResult<()> {
        let device = self.open()?;
        py.detach(|| device.finish()).map_err(raised)
    }

    /// Closes the device. It goes to rest at once, without playing the remaining samples.
    fn close(&mut self, py: Python<'_>) {
        let device = self.slot().take();
        // The interpreter is released, because going to rest may take a while.
        py.detach(|| drop(device));
    }

    fn __enter__(this: PyRef<'_, Self>) -> PyRef<'_, Self> {
        this
    }

    #[pyo3(signature = (kind, _value, _traceback))]
    fn __exit__(
        &mut self,
        py: Python<'_>,
        kind: Option<Bound<'_, PyAny>>,
        _value: Option<Bound<'_, PyAny>>,
        _traceback: Option<Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        // After an exception, the remaining samples are not played: the device goes to rest at
        // once.
        let finished = match (kind, self.slot().is_some()) {
            (None, true) => self.finish(py),
            _ => Ok(()),
        };
        self.close(py);
        finished
    }

    fn __repr__(&self) -> String {
        format!("<htex.Device {}: {} Hz>", self.name, self.rate_hz)
    }
}

impl Device {
    fn slot(&mut self) -> &mut Option<Box<dyn Output>> {
        self.device.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    fn open(&mut self) -> PyResult<&mut Box<dyn Output>> {
        let closed = Failed::new_err(format!("{} is closed", self.name));
        self.slot().as_mut().ok_or(closed)
    }
}

/// Lists the output devices, as `htex device list` does. Each has a `descriptor`, which includes
/// its settings, and `endpoints`, the devices that are connected now. If the connected devices
/// cannot be listed, `problem` states why.
#[pyfunction(name = "devices")]
#[pyo3(signature = (*, installed=false))]
pub(crate) fn listed(py: Python<'_>, installed: bool) -> PyResult<Bound<'_, PyAny>> {
    let all: Vec<_> = py.detach(|| {
        let devices = devices(installed).map_err(raised)?;
        let described = devices.of_direction(Direction::Output).map(|known| {
            let (endpoints, problem) = match known.adapter.endpoints() {
                Ok(endpoints) => (endpoints, None),
                Err(problem) => (Vec::new(), Some(problem.to_string())),
            };
            json!({ "descriptor": known.descriptor(), "endpoints": endpoints, "problem": problem })
        });
        Ok::<_, PyErr>(described.collect())
    })?;
    from_json(py, &all)
}

/// Returns the built-in devices and, if requested, the installed ones.
pub(crate) fn devices(installed: bool) -> Result<Devices, DeviceError> {
    let search = Search { env: installed, user_dir: installed, ..Search::default() };
    Devices::search(htex_device_builtin::devices(), &search)
}

/// Makes the exception for an error of a device.
fn raised(error: DeviceError) -> PyErr {
    match error {
        DeviceError::Setting { .. } | DeviceError::Rate { .. } | DeviceError::Unknown { .. } => {
            option(error.to_string())
        }
        other => Failed::new_err(other.to_string()),
    }
}
