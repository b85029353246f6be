//! Implementation of the scene calls.

use std::collections::BTreeMap;
use std::ffi::c_char;
use std::io;
use std::path::{Path, PathBuf};

use htex::device::Devices;
use htex::scene::{
    Costs, DeviceOverride, Finger, Limits, LoadError, LoadedScene, Plan, Renderer, SceneError,
    SceneFiles, Surroundings, plan, read_scene,
};
use htex::{AssetData, Quantity};

use super::{htex_finger, htex_scene, htex_scene_options};
use crate::handles::{Kind, Table};
use crate::log::{htex_log_level, log};
use crate::options::{htex_open_options, models, options};
use crate::pointers::{needed_text, place, slice, slice_mut, write_text};
use crate::reader::{Files, htex_files};
use crate::status::{Failure, guarded, htex_status};

/// A playing scene, and its plan as JSON.
struct Playing {
    renderer: Renderer,
    plan_json: String,
}

static SCENES: Table<Playing> = Table::new(Kind::Scene);

/// The device through which a program receives the samples: numbers in the assets' unit.
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
        Self::of_scene(status, error)
    }
}

/// Frees all scenes.
///
/// # Safety
/// As [`Table::clear`].
pub(crate) unsafe fn clear() -> Result<(), Failure> {
    // SAFETY: as here.
    unsafe { SCENES.clear() }
}

/// Where a scene is read from.
pub(super) enum Source<'a> {
    Path(PathBuf),
    Memory(&'a [u8], Files),
}

impl Source<'_> {
    fn load(
        &self,
        around: &Surroundings<'_>,
        device: &DeviceOverride,
    ) -> Result<LoadedScene, LoadError> {
        match self {
            Self::Path(path) => LoadedScene::open(path, around, device),
            Self::Memory(bytes, files) => LoadedScene::from_files(bytes, files, around, device),
        }
    }

    /// Returns the quantity of the first surface's asset. A scene or an asset that cannot be read
    /// is reported later, when the scene is loaded.
    fn quantity(&self) -> Option<Quantity> {
        let first = |bytes: &[u8]| {
            let scene = read_scene(bytes, &Limits::default(), &mut Default::default())?;
            Some(scene.surfaces.first()?.asset.clone())
        };
        let data = match self {
            Self::Path(path) => {
                let asset = first(&bounded(path).ok()?)?;
                AssetData::open(&path.parent()?.join(asset)).ok()?
            }
            Self::Memory(bytes, files) => {
                AssetData::from_bytes(&files.read(&first(bytes)?).ok()?).ok()?
            }
        };
        Some(data.manifest.quantity)
    }
}

/// Reads as much of a scene file as a valid one may have.
fn bounded(path: &Path) -> io::Result<Vec<u8>> {
    use std::io::Read;
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(Limits::default().file_bytes).read_to_end(&mut bytes)?;
    Ok(bytes)
}

impl SceneFiles for Files {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.read_whole(&path.to_string_lossy())
    }
}

pub(super) unsafe fn open_path(
    path: *const c_char,
    open_options: *const htex_open_options,
    scene_options: *const htex_scene_options,
    out: *mut htex_scene,
) -> htex_status {
    // SAFETY: the pointers are the caller's.
    let source = || Ok(Source::Path(unsafe { needed_text(path) }?.into()));
    // SAFETY: as above.
    unsafe { open(source, open_options, scene_options, out) }
}

#[cfg(windows)]
pub(super) unsafe fn open_wide(
    path: *const u16,
    open_options: *const htex_open_options,
    scene_options: *const htex_scene_options,
    out: *mut htex_scene,
) -> htex_status {
    // SAFETY: the pointers are the caller's.
    let source = || Ok(Source::Path(unsafe { crate::pointers::wide_path(path) }?));
    // SAFETY: as above.
    unsafe { open(source, open_options, scene_options, out) }
}

pub(super) unsafe fn from_bytes(
    bytes: *const u8,
    len: usize,
    files: *const htex_files,
    open_options: *const htex_open_options,
    scene_options: *const htex_scene_options,
    out: *mut htex_scene,
) -> htex_status {
    // SAFETY: the pointers are the caller's.
    let source = || unsafe { Ok(Source::Memory(slice(bytes, len)?, Files::of(files)?)) };
    // SAFETY: as above.
    unsafe { open(source, open_options, scene_options, out) }
}

unsafe fn open(
    source: impl FnOnce() -> Result<Source<'static>, Failure>,
    open: *const htex_open_options,
    scene_options: *const htex_scene_options,
    out: *mut htex_scene,
) -> htex_status {
    guarded(|| {
        let zeros = htex_scene_options { size: 0, rate_hz: 0.0 };
        let source = source()?;
        // SAFETY: the pointers are the caller's.
        let (models, asked, out) =
            unsafe { (models(open)?, options(scene_options, zeros)?, place(out)?) };
        let devices = Devices::new(htex_device_builtin::devices());
        let around =
            Surroundings { models: &models.registry, embedded: models.embedded, devices: &devices };
        let device = DeviceOverride {
            adapter: Some(ADAPTER.to_owned()),
            // The quantity is a setting of the device, so it is read before the scene is loaded.
            settings: settings(source.quantity()),
            rate_hz: (asked.rate_hz != 0.0).then_some(asked.rate_hz),
            rehearsal: true,
            ..DeviceOverride::default()
        };
        let scene = source.load(&around, &device)?;
        for note in &scene.notes {
            log(htex_log_level::HTEX_LOG_WARNING, &note.to_string());
        }
        let (renderer, plan) = start(&scene, &devices)?;
        for note in &plan.notes {
            log(htex_log_level::HTEX_LOG_INFO, note);
        }
        let plan_json = serde_json::to_string(&plan)
            .map_err(|error| Failure::of(htex_status::HTEX_STATUS_INTERNAL, error))?;
        out.id = SCENES.insert(Playing { renderer, plan_json })?;
        Ok(())
    })
}

/// The setting that gives the device the quantity of the samples.
fn settings(quantity: Option<Quantity>) -> BTreeMap<String, String> {
    let quantity = quantity.map(|quantity| ("quantity".to_owned(), quantity.name().to_owned()));
    quantity.into_iter().collect()
}

fn start(scene: &LoadedScene, devices: &Devices) -> Result<(Renderer, Plan), Failure> {
    let device = |error| Failure::of(htex_status::HTEX_STATUS_INVALID_SCENE, error);
    let adapter = &devices.find_output(ADAPTER).map_err(device)?.adapter;
    let capabilities = adapter.capabilities(&scene.settings).map_err(device)?;
    // Not the costs measured on this machine, so that the plan depends on no file of the user.
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
        if (finger.size as usize) < size_of::<htex_finger>() {
            return Err(Failure::argument(
                "the finger's size is not that of its struct; set it to sizeof(htex_finger)",
            ));
        }
        // A single NaN is a failed reading, not an unknown position.
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
        scene.renderer.take_failure().map_or(Ok(()), |error| Err(error.into()))
    })
}

pub(super) fn stop(scene: htex_scene) -> htex_status {
    guarded(|| {
        SCENES.exclusive(scene.id)?.renderer.stop();
        Ok(())
    })
}
