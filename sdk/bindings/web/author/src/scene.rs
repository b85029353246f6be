//! Plays scenes whose files are in memory. A scene is opened once. After that, the program refers
//! to the scene by a number until the scene is freed.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use htex::Motion;
use htex::device::{Capabilities, Devices};
use htex::format::signing::Signers;
use htex::model::{Registry, Search, WasmEngine, WasmLimits};
use htex::scene::{
    Costs, DeviceOverride, FileSource, Plan, Renderer, Scene, SceneError, SceneErrorKind,
    Surroundings, file, plan,
};
use htex_c::htex_status::*;
use serde::Serialize;
use serde_json::Value;

use crate::answer::{Answer, Files, Function};
use crate::document::Document;
use crate::refusal::Refusal;

pub(crate) const FUNCTIONS: &[(&str, Function)] = &[
    ("scene", open),
    ("scene-free", free),
    ("scene-next", next),
    ("scene-path", path),
    ("scene-render", render),
];

/// Longest duration of a scene, s.
const MOST_S: f64 = 1e9;

/// An open scene.
struct OpenScene {
    bytes: Vec<u8>,
    files: FilesByPath,
    models: Registry,
    embedded: bool,
    signers: Option<Signers>,
    devices: Devices,
    device: DeviceOverride,
    loaded: Scene,
    able: Capabilities,
    /// The renderer of the next samples. It is made when samples are first requested.
    playing: Option<Renderer>,
}

/// The files of a scene, by their paths in the scene.
struct FilesByPath(BTreeMap<String, Vec<u8>>);

impl FileSource for FilesByPath {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let found = self.0.get(path.to_string_lossy().as_ref()).cloned();
        found.ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

#[derive(Default)]
struct Scenes {
    open: BTreeMap<u64, OpenScene>,
    last: u64,
}

thread_local! {
    static SCENES: RefCell<Scenes> = RefCell::default();
}

#[derive(Serialize)]
struct SceneSummary<'a> {
    id: u64,
    unit: &'static str,
    rate: f64,
    plan: &'a Plan,
    notes: Vec<String>,
}

/// Opens a scene. The first file is the scene. The other files are those that the scene names.
pub(crate) fn open(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let names = call.texts("files")?;
    let embedded = call.flag("trusted")?;
    let signers = signers(&call.texts("only_signed_by")?)?;
    let device = device(call.object("device")?)?;
    call.finish()?;
    let [scene, others @ ..] = files else {
        return Err(Refusal::argument("give the bytes of a scene"));
    };
    if names.len() != others.len() {
        return Err(Refusal::argument("a file is missing"));
    }
    let named = names.into_iter().zip(others.iter().map(|file| file.to_vec()));
    let models = models(embedded)?;
    let devices = Devices::new(htex_device_builtin::devices());
    let files = FilesByPath(named.collect());
    let signed = signers.as_ref();
    let around =
        Surroundings { models: &models, embedded, devices: Some(&devices), signers: signed };
    let loaded = Scene::from_files(scene, &files, &around, &device)?;
    let known = devices.find_output(&loaded.file.device.adapter);
    let able = known
        .and_then(|known| known.adapter.capabilities(&loaded.settings))
        .map_err(Refusal::scene)?;
    let open = OpenScene {
        bytes: scene.to_vec(),
        files,
        models,
        embedded,
        signers,
        devices,
        device,
        loaded,
        able,
        playing: None,
    };
    let plan = open.planned(&open.loaded)?;
    let notes = open.loaded.notes.iter().map(ToString::to_string).collect();
    let unit = open.able.quantity.unit();
    let id = SCENES.with_borrow_mut(|scenes| {
        // A number is never used again, so a freed scene is never mistaken for another one.
        scenes.last += 1;
        scenes.open.insert(scenes.last, open);
        scenes.last
    });
    let opened = SceneSummary { id, unit, rate: plan.rate_hz, plan: &plan, notes };
    Answer::new(&opened, Vec::new())
}

/// Returns who must have signed the textures; `None` without a key.
fn signers(keys: &[String]) -> Result<Option<Signers>, Refusal> {
    let wrong = |error| Refusal::argument(format!("onlySignedBy: {error}"));
    let keys: Result<Vec<_>, _> = keys.iter().map(|key| key.parse().map_err(wrong)).collect();
    let keys = keys?;
    Ok((!keys.is_empty()).then(|| Signers::new(keys)))
}

/// Returns the built-in models. If `embedded` is true, models that are embedded in textures can
/// also run.
fn models(embedded: bool) -> Result<Registry, Refusal> {
    let engine = if embedded { WasmEngine::Checked } else { WasmEngine::Off };
    let limits = WasmLimits::default().with_engine(engine);
    Ok(Registry::search(&Search::builtin().with_limits(limits))?)
}

/// Returns the device that is given instead of the scene's own. The device is not opened.
fn device(mut given: Document) -> Result<DeviceOverride, Refusal> {
    let device = DeviceOverride {
        adapter: given.text("device")?,
        profile: given.text("profile")?,
        quantity_gain: given.number("quantity_gain")?,
        settings: settings(given.object("settings")?)?,
        rehearsal: true,
        ..DeviceOverride::default()
    };
    given.finish()?;
    Ok(device)
}

fn settings(given: Document) -> Result<BTreeMap<String, String>, Refusal> {
    let text = |(name, value): (String, Value)| match value {
        Value::String(text) => Ok((name, text)),
        Value::Number(_) | Value::Bool(_) => Ok((name, value.to_string())),
        _ => {
            let name = htex_base::finding::plain(&name);
            let sentence = format!("the setting {name} is a text, a number, true or false");
            Err(Refusal::argument(sentence))
        }
    };
    given.rest().into_iter().map(text).collect()
}

/// Renders a scene from its start, for its own duration or a given duration. The bytes of the
/// answer are the samples.
pub(crate) fn render(mut call: Document, _: Files<'_>) -> Result<Answer, Refusal> {
    let id = id(&mut call)?;
    let seconds = call.number("seconds")?;
    call.finish()?;
    of_scene(id, |open| {
        let mut loaded = open.loaded.clone();
        if let Some(seconds) = seconds {
            if !(seconds > 0.0 && seconds <= MOST_S) {
                let sentence = format!("{seconds} seconds; give more than 0, at most {MOST_S}");
                return Err(Refusal::argument(sentence));
            }
            loaded.file.duration_s = Some(seconds);
        }
        let (mut renderer, plan) = open.renderer(&loaded)?;
        let frames = plan.frames.ok_or_else(|| {
            Refusal::argument("the scene has no end; give seconds, or add duration_s to it")
        })?;
        let mut samples = zeros(usize::try_from(frames).unwrap_or(usize::MAX))?;
        let rendered = renderer.render(&mut samples)?;
        samples.truncate(rendered);
        answer(&samples)
    })
}

/// Renders the next samples of a scene. The bytes of the answer are the samples. At the end of the
/// scene they are fewer than requested.
pub(crate) fn next(mut call: Document, _: Files<'_>) -> Result<Answer, Refusal> {
    let id = id(&mut call)?;
    let frames = count(&mut call, "frames")?;
    call.finish()?;
    of_scene(id, |open| {
        // The renderer is taken out of the scene, because making one borrows the whole scene.
        let mut renderer = match open.playing.take() {
            Some(renderer) => renderer,
            None => open.renderer(&open.loaded)?.0,
        };
        let mut samples = zeros(frames)?;
        let rendered = renderer.render(&mut samples);
        open.playing = Some(renderer);
        samples.truncate(rendered?);
        answer(&samples)
    })
}

/// Renders a scene at another motion. Each line of the file has the speed, force and place for one
/// block of samples. The bytes of the answer are the samples.
pub(crate) fn path(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let id = id(&mut call)?;
    let block = count(&mut call, "block")?;
    call.finish()?;
    let [lines] = files else {
        return Err(Refusal::argument("give one motion"));
    };
    let (lines, _) = lines.as_chunks::<8>();
    let numbers: Vec<f64> = lines.iter().map(|x| f64::from_le_bytes(*x)).collect();
    let (motions, _) = numbers.as_chunks::<4>();
    if block == 0 {
        return Err(Refusal::argument("a block has at least one sample"));
    }
    of_scene(id, |open| {
        let loaded = open.live()?;
        let plan = open.planned(&loaded)?;
        let mut renderer = Renderer::new(&loaded, &plan)?;
        let mut samples = zeros(motions.len().saturating_mul(block))?;
        for (i, (part, motion)) in samples.chunks_mut(block).zip(motions).enumerate() {
            let [speed_mm_s, force_n, x_mm, y_mm] = *motion;
            // If only one of them is NaN, the reading failed, and the place does not count as
            // unknown.
            let unknown = x_mm.is_nan() && y_mm.is_nan();
            let motion =
                Motion::new(speed_mm_s, force_n).with_place_mm((!unknown).then_some([x_mm, y_mm]));
            let moved = renderer.set_motion(motion);
            moved.map_err(|error| Refusal::motion(format!("block {i}: {error}")))?;
            renderer.render(part)?;
        }
        answer(&samples)
    })
}

/// Frees a scene.
pub(crate) fn free(mut call: Document, _: Files<'_>) -> Result<Answer, Refusal> {
    let id = id(&mut call)?;
    call.finish()?;
    SCENES.with_borrow_mut(|scenes| scenes.open.remove(&id));
    Answer::new(&(), Vec::new())
}

fn id(call: &mut Document) -> Result<u64, Refusal> {
    Ok(count(call, "id")? as u64)
}

/// A non-negative integer.
fn count(call: &mut Document, name: &'static str) -> Result<usize, Refusal> {
    let number = call.number(name)?.unwrap_or(-1.0);
    let is_whole = number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number);
    if is_whole {
        Ok(number as usize)
    } else {
        Err(Refusal::argument(format!("{name} is a whole number")))
    }
}

fn of_scene(
    id: u64,
    call: impl FnOnce(&mut OpenScene) -> Result<Answer, Refusal>,
) -> Result<Answer, Refusal> {
    SCENES.with_borrow_mut(|scenes| match scenes.open.get_mut(&id) {
        Some(open) => call(open),
        None => Err(Refusal::argument("the scene was freed; open it again")),
    })
}

fn zeros(frames: usize) -> Result<Vec<f32>, Refusal> {
    let mut samples = Vec::new();
    samples
        // `vec!` would abort the module if there is not enough memory.
        .try_reserve_exact(frames)
        .map_err(|_| Refusal::argument(format!("{frames} samples do not fit into memory")))?;
    samples.resize(frames, 0.0);
    Ok(samples)
}

fn answer(samples: &[f32]) -> Result<Answer, Refusal> {
    let bytes = samples.iter();
    Answer::new(&(), bytes.flat_map(|x| x.to_le_bytes()).collect())
}

impl OpenScene {
    fn planned(&self, loaded: &Scene) -> Result<Plan, Refusal> {
        Ok(plan(loaded, &self.able, &Costs::embedded())?)
    }

    /// Makes a renderer that plays the scene at its own motion.
    fn renderer(&self, loaded: &Scene) -> Result<(Renderer, Plan), Refusal> {
        if loaded.file.motion == file::Motion::Live {
            let sentence = "the motion of the scene is live; give it to renderPath";
            return Err(Refusal::argument(sentence));
        }
        let plan = self.planned(loaded)?;
        Ok((Renderer::new(loaded, &plan)?, plan))
    }

    /// Loads the scene for a motion that is set while it plays.
    fn live(&self) -> Result<Scene, Refusal> {
        let around = Surroundings {
            models: &self.models,
            embedded: self.embedded,
            devices: Some(&self.devices),
            signers: self.signers.as_ref(),
        };
        let device = DeviceOverride { live: true, ..self.device.clone() };
        // Loads the scene again, because some device settings have another default for a live
        // motion.
        let mut loaded = Scene::from_files(&self.bytes, &self.files, &around, &device)?;
        loaded.file.motion = file::Motion::Live;
        loaded.file.duration_s = None;
        loaded.trace = None;
        Ok(loaded)
    }
}

impl Refusal {
    /// An error for a scene that cannot be loaded or played.
    fn scene(error: impl ToString) -> Self {
        Self::new(HTEX_STATUS_INVALID_SCENE, "invalid-scene", error)
    }

    fn motion(error: impl ToString) -> Self {
        Self::new(HTEX_STATUS_INVALID_MOTION, "invalid-motion", error)
    }
}

impl From<SceneError> for Refusal {
    fn from(error: SceneError) -> Self {
        match error.kind() {
            SceneErrorKind::Motion => Self::motion(error),
            SceneErrorKind::Model => Self::model(error),
            SceneErrorKind::NoModel => Self::new(HTEX_STATUS_NO_MODEL, "no-model", error),
            SceneErrorKind::Signature => Self::new(HTEX_STATUS_NOT_SIGNED, "not-signed", error),
            _ => Self::scene(error),
        }
    }
}
