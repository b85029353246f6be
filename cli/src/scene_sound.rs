//! Renders a scene in the unit of its textures, for exports.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use htex_base::files::read_regular;
use htex_dsp::grid::Band;
use htex_exchange::{MOST_BYTES, SceneSound};
use htex_format::{Quantity, Rights};
use htex_scene::file::Motion;
use htex_scene::{DeviceOverride, Limits, Renderer, read_scene};

use crate::failure::{Failure, Result, for_file};
use crate::output::shown;
use crate::plugins::PlayerArgs;
use crate::scenes::{Loader, Ready, costs};

/// The device that takes a texture's samples unchanged, as numbers in their unit.
const ADAPTER: &str = "org.htex.file";
/// Duration of a scene without an end, seconds.
const SECONDS: f64 = 2.0;
/// Number of samples rendered at a time.
const BLOCK: usize = 4096;

/// A scene and what is known about it before it plays.
pub(crate) struct Scene {
    file: PathBuf,
    loader: Loader,
    /// The warnings that have been printed.
    told: RefCell<BTreeSet<String>>,
    /// The files that the scene reads.
    pub(crate) inputs: Vec<PathBuf>,
    rights: Rights,
    quantity: Quantity,
    band: Band,
    seconds: f64,
}

impl Scene {
    /// Reads a scene. It plays for `seconds` if given, else for its own duration, else for two
    /// seconds.
    pub(crate) fn open(file: &Path, player: &PlayerArgs, seconds: Option<f64>) -> Result<Self> {
        let loader = Loader::builtin(player)?;
        let told = RefCell::default();
        // The quantity is a setting of the device, so it is read before the scene is loaded.
        let ready = load(&loader, file, &numbers(quantity(file, player), None), &told)?;
        if ready.scene.file.motion == Motion::Live {
            let file = shown(file);
            return Err(Failure::Other(format!(
                "{file}: its motion is live, and an export needs one; give the scene a constant motion or a trace"
            )));
        }
        let bands = ready.scene.assets.iter().map(|asset| asset.band());
        let band = bands.reduce(|a, b| Band {
            low_hz: a.low_hz.min(b.low_hz),
            high_hz: a.high_hz.max(b.high_hz),
        });
        let plan = ready.plan(&costs())?;
        let own = plan.frames.map(|frames| frames as f64 / plan.rate_hz);
        let mut inputs = ready.scene.inputs();
        inputs.push(file.to_owned());
        Ok(Self {
            file: file.to_owned(),
            inputs,
            rights: ready.rights(),
            quantity: ready.scene.quantity(),
            band: band.unwrap_or(Band::TACTILE),
            seconds: seconds.or(own).unwrap_or(SECONDS),
            loader,
            told,
        })
    }

    /// Calls a function with the scene's sound.
    pub(crate) fn with<T>(&self, call: impl FnOnce(&SceneSound<'_>) -> T) -> T {
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        // `two.scene.json` has two extensions.
        let name = name.split('.').next().unwrap_or_default();
        call(&SceneSound {
            name,
            rights: &self.rights,
            quantity: self.quantity,
            band: self.band,
            seconds: self.seconds,
            samples: &|rate_hz| self.samples(rate_hz).map_err(|error| error.to_string()),
        })
    }

    fn samples(&self, rate_hz: f64) -> Result<Vec<f32>> {
        let device = numbers(Some(self.quantity), Some(rate_hz));
        let mut ready = load(&self.loader, &self.file, &device, &self.told)?;
        ready.scene.file.duration_s = Some(self.seconds);
        let plan = ready.plan(&costs())?;
        let mut renderer = Renderer::new(&ready.scene, &plan).map_err(for_file(&self.file))?;
        let mut samples = Vec::new();
        let mut block = [0.0; BLOCK];
        loop {
            let rendered = renderer.render(&mut block).map_err(for_file(&self.file))?;
            if rendered == 0 {
                return Ok(samples);
            }
            samples.extend_from_slice(&block[..rendered]);
        }
    }
}

/// Whether a file is a scene, judged by its name.
pub(crate) fn is_scene(file: &Path) -> bool {
    file.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"))
}

/// Returns the quantity of the first texture. Returns `None` if the scene or the texture cannot be
/// read; loading the scene then reports the error.
fn quantity(scene: &Path, player: &PlayerArgs) -> Option<Quantity> {
    let bytes = read_regular(scene, MOST_BYTES).ok()?;
    let read = read_scene(&bytes, &Limits::default(), &mut Default::default())?;
    let first = scene.parent()?.join(&read.surfaces.first()?.asset);
    Some(player.read(&first).ok()?.manifest.quantity)
}

/// Returns the choice of a device that takes plain numbers and is not opened.
fn numbers(quantity: Option<Quantity>, rate_hz: Option<f64>) -> DeviceOverride {
    let quantity = quantity.map(|quantity| ("quantity".to_owned(), quantity.name().to_owned()));
    DeviceOverride {
        adapter: Some(ADAPTER.to_owned()),
        settings: quantity.into_iter().collect(),
        rate_hz,
        rehearsal: true,
        ..DeviceOverride::default()
    }
}

fn load(
    loader: &Loader,
    file: &Path,
    device: &DeviceOverride,
    told: &RefCell<BTreeSet<String>>,
) -> Result<Ready> {
    loader.load(file, &mut told.borrow_mut(), |around| {
        htex_scene::Scene::open_with(file, around, device)
    })
}
