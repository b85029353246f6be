//! Implementation of the scene calls.

use std::ffi::c_char;
use std::io;
use std::path::{Path, PathBuf};

use htex::Motion;
use htex::scene::{DeviceOverride, FileSource, Renderer, Scene, SceneError, Surroundings};

use super::{htex_finger, htex_scene, htex_scene_options};
use crate::handles::{Kind, Table};
use crate::log::{htex_log_level, log};
use crate::options::{htex_open_options, models, options};
use crate::pointers::{needed_text, place, slice, slice_mut, write_text};
use crate::reader::{Files, htex_files};
use crate::status::{Failure, guarded, htex_status};

/// A scene that plays, and its plan as JSON.
struct Playing {
    renderer: Renderer,
    plan_json: String,
}

static SCENES: Table<Playing> = Table::new(Kind::Scene);

/// Default sample rate, Hz.
const USUAL_RATE_HZ: f64 = 20_000.0;

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
    fn open(&self, around: &Surroundings<'_>) -> Result<Scene, SceneError> {
        let device = DeviceOverride::default();
        match self {
            Self::Path(path) => Scene::open_with(path, around, &device),
            Self::Memory(bytes, files) => Scene::from_files(bytes, files, around, &device),
        }
    }
}

impl FileSource for Files {
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
    // SAFETY: the caller passed these pointers.
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
    // SAFETY: the caller passed these pointers.
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
    // SAFETY: the caller passed these pointers.
    let source = || unsafe { Ok(Source::Memory(slice(bytes, len)?, Files::from_raw(files)?)) };
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
        // SAFETY: the caller passed these pointers.
        let (models, asked, out) =
            unsafe { (models(open)?, options(scene_options, zeros)?, place(out)?) };
        // No devices, because the program itself takes the samples.
        let around = Surroundings {
            models: &models.registry,
            embedded: models.embedded,
            devices: None,
            signers: models.signed.signers_of_files()?,
        };
        let scene = source.open(&around)?;
        for note in &scene.notes {
            log(htex_log_level::HTEX_LOG_WARNING, &note.to_string());
        }
        let rate_hz = if asked.rate_hz == 0.0 { USUAL_RATE_HZ } else { asked.rate_hz };
        let plan = scene.plan(rate_hz)?;
        for note in &plan.notes {
            log(htex_log_level::HTEX_LOG_INFO, note);
        }
        let plan_json = serde_json::to_string(&plan)
            .map_err(|error| Failure::new(htex_status::HTEX_STATUS_INTERNAL, error))?;
        let renderer = Renderer::new(&scene, &plan)?;
        out.id = SCENES.insert(Playing { renderer, plan_json })?;
        Ok(())
    })
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
        // SAFETY: the caller passed these pointers.
        unsafe { write_text(&scene.plan_json, out, capacity, length) }
    })
}

pub(super) unsafe fn rate_hz(scene: htex_scene, out: *mut f64) -> htex_status {
    guarded(|| {
        let scene = SCENES.exclusive(scene.id)?;
        // SAFETY: the caller passed this pointer.
        *unsafe { place(out) }? = scene.renderer.rate_hz();
        Ok(())
    })
}

pub(super) unsafe fn set_finger(scene: htex_scene, finger: *const htex_finger) -> htex_status {
    guarded(|| {
        let mut scene = SCENES.exclusive(scene.id)?;
        // SAFETY: the caller passed this pointer to a finger.
        let finger = unsafe { slice(finger, 1) }?[0];
        if (finger.size as usize) < size_of::<htex_finger>() {
            return Err(Failure::argument(
                "the finger's `size` is wrong; set it to sizeof(htex_finger)",
            ));
        }
        // If only one of them is NaN, the reading failed, and the position does not count as
        // unknown.
        let unknown = finger.x_mm.is_nan() && finger.y_mm.is_nan();
        let place_mm = (!unknown).then_some([finger.x_mm, finger.y_mm]);
        let motion = Motion::new(finger.speed_mm_s, finger.force_n).with_place_mm(place_mm);
        Ok(scene.renderer.set_motion(motion)?)
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
        // SAFETY: the caller passed these pointers.
        let (out, rendered) = unsafe { (slice_mut(out, frames)?, place(rendered)?) };
        // `rendered` is set first, because all frames up to the end of the scene are rendered even
        // after an error.
        let left = scene.renderer.frames_left().unwrap_or(u64::MAX);
        *rendered = usize::try_from(left).map_or(out.len(), |left| left.min(out.len()));
        *rendered = scene.renderer.render(out)?;
        Ok(())
    })
}

pub(super) fn stop(scene: htex_scene) -> htex_status {
    guarded(|| {
        SCENES.exclusive(scene.id)?.renderer.stop();
        Ok(())
    })
}
