//! Scenes: surfaces, a motion of the finger over them, and a device.

use std::collections::BTreeMap;
use std::path::PathBuf;

use htex::format::signing::Signers;
use htex::model::{Registry, folders};
use htex_device::{Capabilities, Devices};
use htex_scene::file::Motion;
use htex_scene::{Costs, DeviceOverride, Plan, Renderer, Surroundings, plan};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use crate::device::devices;
use crate::errors::{MotionError, SceneError, option, raised};
use crate::models::registry;
use crate::path::{Series, count};
use crate::python::{from_json, zeros};
use crate::signed::{Keys, Signed};

/// A scene: surfaces, a motion of the finger, and the device for which samples are made. The device
/// itself is not opened.
#[pyclass(frozen, module = "htex")]
pub(crate) struct Scene {
    file: PathBuf,
    models: Registry,
    embedded: bool,
    signers: Option<Signers>,
    devices: Devices,
    device: DeviceOverride,
    loaded: htex_scene::Scene,
    able: Capabilities,
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (path, *, plugins=Vec::new(), embedded=true, installed=false, device=None, profile=None,
                        settings=BTreeMap::new(), quantity_gain=None, only_signed_by=None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        plugins: Vec<PathBuf>,
        embedded: bool,
        installed: bool,
        device: Option<String>,
        profile: Option<String>,
        settings: BTreeMap<String, Bound<'_, PyAny>>,
        quantity_gain: Option<f64>,
        only_signed_by: Option<Keys>,
    ) -> PyResult<Self> {
        let signers = Signed::new(only_signed_by, None)?.signers;
        let mut texts = BTreeMap::new();
        for (name, value) in settings {
            texts.insert(name, value.str()?.to_string());
        }
        let device = DeviceOverride {
            adapter: device,
            profile,
            settings: texts,
            quantity_gain,
            rehearsal: true,
            ..DeviceOverride::default()
        };
        py.detach(|| {
            let models = registry(&plugins, installed)?;
            let devices = devices(installed).map_err(raised)?;
            let around = Surroundings {
                models: &models,
                embedded,
                devices: Some(&devices),
                signers: signers.as_ref(),
            };
            let loaded = htex_scene::Scene::open_with(&path, &around, &device).map_err(raised)?;
            let known = devices.find_output(&loaded.file.device.adapter).map_err(raised)?;
            let able = known.adapter.capabilities(&loaded.settings).map_err(raised)?;
            Ok(Self { file: path, models, embedded, signers, device, loaded, able, devices })
        })
    }

    /// Unit of the samples, which is the device's unit.
    #[getter]
    fn unit(&self) -> &'static str {
        self.able.quantity.unit()
    }

    /// Remarks about the scene that are not errors.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.loaded.notes.iter().map(ToString::to_string).collect()
    }

    /// Returns the plan of the scene: its processing stages with reasons and costs, the effects
    /// that are left out, and the chosen models.
    fn plan<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let plan = py.detach(|| self.planned(&self.loaded))?;
        from_json(py, &plan)
    }

    /// Sample rate, hertz.
    #[getter]
    fn rate_hz(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(py.detach(|| self.planned(&self.loaded))?.rate_hz)
    }

    /// Returns the samples of the scene at its own motion.
    #[pyo3(signature = (seconds=None))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        seconds: Option<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let samples = py.detach(|| {
            // A copy, because the length is changed for this call only.
            let mut loaded = self.loaded.clone();
            if let Some(seconds) = seconds {
                if !(seconds > 0.0 && seconds <= 1e9) {
                    return Err(option(format!("seconds is {seconds}; more than 0, at most 1e9")));
                }
                loaded.file.duration_s = Some(seconds);
            }
            if loaded.file.motion == Motion::Live {
                let text = "the motion of the scene is live; give it to render_path";
                return Err(SceneError::new_err(text));
            }
            let plan = self.planned(&loaded)?;
            let frames = plan.frames.ok_or_else(|| {
                SceneError::new_err("the scene has no end; give seconds, or add duration_s to it")
            })?;
            let mut samples = zeros(usize::try_from(frames).unwrap_or(usize::MAX))?;
            let mut renderer = Renderer::new(&loaded, &plan).map_err(raised)?;
            let rendered = renderer.render(&mut samples).map_err(raised)?;
            samples.truncate(rendered);
            Ok(samples)
        })?;
        Ok(samples.into_pyarray(py))
    }

    /// Returns the samples of the scene at another motion: one speed, force and position for each
    /// block of samples.
    #[pyo3(signature = (speed_mm_s, force_n, x_mm=None, y_mm=None, block=64))]
    fn render_path<'py>(
        &self,
        py: Python<'py>,
        speed_mm_s: Series,
        force_n: Series,
        x_mm: Option<Series>,
        y_mm: Option<Series>,
        block: usize,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        if x_mm.is_some() != y_mm.is_some() {
            return Err(option("a position has two coordinates; give x_mm and y_mm, or neither"));
        }
        let samples = py.detach(|| {
            let given = [Some(&speed_mm_s), Some(&force_n), x_mm.as_ref(), y_mm.as_ref()];
            let samples = count(&given, block)?;
            let loaded = self.live()?;
            let plan = self.planned(&loaded)?;
            let mut renderer = Renderer::new(&loaded, &plan).map_err(raised)?;
            let mut samples = zeros(samples)?;
            for (i, part) in samples.chunks_mut(block).enumerate() {
                let place = x_mm.as_ref().zip(y_mm.as_ref()).map(|(x, y)| [x.at(i), y.at(i)]);
                let motion = htex::Motion::new(speed_mm_s.at(i), force_n.at(i));
                let moved = renderer.set_motion(motion.with_place_mm(place));
                moved.map_err(|error| MotionError::new_err(format!("block {i}: {error}")))?;
                renderer.render(part).map_err(raised)?;
            }
            Ok::<_, PyErr>(samples)
        })?;
        Ok(samples.into_pyarray(py))
    }

    fn __repr__(&self) -> String {
        let (file, surfaces) = (self.file.display(), self.loaded.file.surfaces.len());
        let device = &self.loaded.file.device.adapter;
        format!("<htex.Scene {file}: {surfaces} surface(s), device {device} in {}>", self.unit())
    }
}

impl Scene {
    fn planned(&self, loaded: &htex_scene::Scene) -> PyResult<Plan> {
        plan(loaded, &self.able, &costs()).map_err(raised)
    }

    /// Loads the scene for a motion that is set while it plays.
    fn live(&self) -> PyResult<htex_scene::Scene> {
        let around = Surroundings {
            models: &self.models,
            embedded: self.embedded,
            devices: Some(&self.devices),
            signers: self.signers.as_ref(),
        };
        let device = DeviceOverride { live: true, ..self.device.clone() };
        // Loads the scene again, because some device settings have another default for a live
        // motion.
        let mut loaded =
            htex_scene::Scene::open_with(&self.file, &around, &device).map_err(raised)?;
        loaded.file.motion = Motion::Live;
        loaded.file.duration_s = None;
        loaded.trace = None;
        Ok(loaded)
    }
}

/// Returns the computing costs of models that the command measured on this machine, or the built-in
/// costs if there are none.
fn costs() -> Costs {
    let file = folders::cache().map(|folder| folder.join("costs.json"));
    let kept = file.and_then(|file| Costs::load(&file));
    kept.unwrap_or_else(Costs::embedded)
}
