//! The calls of scenes.

use std::collections::BTreeMap;
use std::ffi::c_char;
use std::path::Path;

use htex::AssetData;
use htex::device::Devices;
use htex::scene::{
    Costs, DeviceOverride, Finger, Limits, LoadError, LoadedScene, Plan, Renderer, SceneError,
    Surroundings, plan, read_scene,
};

use super::{htex_finger, htex_scene, htex_scene_options};
use crate::handles::Table;
use crate::log::{htex_log_level, log};
use crate::options::{htex_open_options, models, options};
use crate::pointers::{needed_text, place, slice, slice_mut, write_text};
use crate::status::{Failure, guarded, htex_status};

/// A scene that plays, and its plan as JSON.
struct Playing {
    renderer: Renderer,
    plan_json: String,
}

static SCENES: Table<Playing> = Table::new();

/// The device whose samples a program gets: numbers in the assets' unit.
const ADAPTER: &str = "org.htex.file";

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Self {
        let status = match &error {
            LoadError::Io { .. } => htex_status::HTEX_STATUS_IO,
            _ => htex_status::HTEX_STATUS_INVALID_SCENE,
        };
        Self::of(status, error)
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        let status = match error {
            SceneError::Motion { .. } => htex_status::HTEX_STATUS_INVALID_MOTION,
            SceneError::Surface { .. } => htex_status::HTEX_STATUS_MODEL,
            SceneError::NoModel { .. } => htex_status::HTEX_STATUS_NO_MODEL,
            _ => htex_status::HTEX_STATUS_INVALID_SCENE,
        };
        Self::of(status, error)
    }
}

pub(super) unsafe fn open(
    path: *const c_char,
    open: *const htex_open_options,
    scene_options: *const htex_scene_options,
    out: *mut htex_scene,
) -> htex_status {
    guarded(|| {
        let zeros = htex_scene_options {
            size: 0,
            rate_hz: 0.0,
        };
        // SAFETY: the pointers are the caller's.
        let (path, models, asked, out) = unsafe {
            (
                needed_text(path)?,
                models(open)?,
                options(scene_options, zeros)?,
                place(out)?,
            )
        };
        let devices = Devices::new(htex_device_builtin::devices());
        let around = Surroundings {
            models: &models.registry,
            embedded: models.embedded,
            devices: &devices,
        };
        let device = DeviceOverride {
            adapter: Some(ADAPTER.to_owned()),
            settings: settings(path.as_ref(), asked.rate_hz),
            rehearsal: true,
            ..DeviceOverride::default()
        };
        let scene = LoadedScene::open(path.as_ref(), &around, &device)?;
        for note in &scene.notes {
            log(htex_log_level::HTEX_LOG_WARNING, &note.to_string());
        }
        let (renderer, plan) = start(&scene, &devices)?;
        for note in &plan.notes {
            log(htex_log_level::HTEX_LOG_INFO, note);
        }
        let plan_json = serde_json::to_string(&plan)
            .map_err(|error| Failure::of(htex_status::HTEX_STATUS_INTERNAL, error))?;
        out.id = SCENES.insert(Playing {
            renderer,
            plan_json,
        })?;
        Ok(())
    })
}

/// Settings of the device: the rate, and the quantity of the first surface's asset. A scene or an asset that cannot be read is
/// an error of loading it.
fn settings(path: &Path, rate_hz: f64) -> BTreeMap<String, String> {
    let quantity = || {
        let bytes = std::fs::read(path).ok()?;
        let scene = read_scene(&bytes, &Limits::default(), &mut Default::default())?;
        let asset = path.parent()?.join(&scene.surfaces.first()?.asset);
        Some(AssetData::open(&asset).ok()?.manifest.quantity)
    };
    let quantity = quantity().map(|quantity| ("quantity", quantity.name().to_owned()));
    let rate = (rate_hz != 0.0).then(|| ("rate_hz", rate_hz.to_string()));
    let given = [quantity, rate].into_iter().flatten();
    given
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

fn start(scene: &LoadedScene, devices: &Devices) -> Result<(Renderer, Plan), Failure> {
    let device = |error| Failure::of(htex_status::HTEX_STATUS_INVALID_SCENE, error);
    let adapter = &devices.find(ADAPTER).map_err(device)?.adapter;
    let capabilities = adapter.capabilities(&scene.settings).map_err(device)?;
    let plan = plan(scene, &capabilities, &Costs::embedded())?;
    Ok((Renderer::new(scene, &plan)?, plan))
}

pub(super) fn free(scene: htex_scene) -> htex_status {
    guarded(|| SCENES.remove(scene.id).map(drop))
}

pub(super) unsafe fn plan_json(
    scene: htex_scene,
    out: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> htex_status {
    guarded(|| {
        let scene = SCENES.exclusive(scene.id)?;
        // SAFETY: the pointers are the caller's.
        unsafe { write_text(&scene.plan_json, out, capacity, length) }
    })
}

pub(super) unsafe fn rate_hz(scene: htex_scene, out: *mut f64) -> htex_status {
    guarded(|| {
        let scene = SCENES.exclusive(scene.id)?;
        // SAFETY: the place is the caller's.
        *unsafe { place(out) }? = scene.renderer.rate_hz();
        Ok(())
    })
}

pub(super) unsafe fn set_finger(scene: htex_scene, finger: *const htex_finger) -> htex_status {
    guarded(|| {
        let mut scene = SCENES.exclusive(scene.id)?;
        // SAFETY: the finger is the caller's.
        let finger = unsafe { slice(finger, 1) }?[0];
        let unknown = finger.x_mm.is_nan() && finger.y_mm.is_nan();
        Ok(scene.renderer.set_motion(Finger {
            speed_mm_s: finger.speed_mm_s,
            force_n: finger.force_n,
            at_mm: (!unknown).then_some([finger.x_mm, finger.y_mm]),
        })?)
    })
}

pub(super) unsafe fn render(
    scene: htex_scene,
    out: *mut f32,
    frames: usize,
    rendered: *mut usize,
) -> htex_status {
    guarded(|| {
        let mut scene = SCENES.exclusive(scene.id)?;
        // SAFETY: the pointers are the caller's.
        let (out, rendered) = unsafe { (slice_mut(out, frames)?, place(rendered)?) };
        *rendered = scene.renderer.render(out);
        scene
            .renderer
            .take_failure()
            .map_or(Ok(()), |error| Err(error.into()))
    })
}

pub(super) fn stop(scene: htex_scene) -> htex_status {
    guarded(|| {
        SCENES.exclusive(scene.id)?.renderer.stop();
        Ok(())
    })
}
