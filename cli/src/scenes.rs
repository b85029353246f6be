//! Arguments for the models and devices of scenes, shared by the commands that play scenes.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use clap::Args;
use htex_base::finding::Notice;
use htex_device::{AdapterEntry, Capabilities, DeviceError, Devices, SettingKind, Settings};
use htex_format::Rights;
use htex_format::signing::Signers;
use htex_host::{Registry, Search, WasmLimits};
use htex_scene::file::{Constant, Motion};
use htex_scene::{Costs, DeviceOverride, Plan, Scene, SceneError, Surroundings};
use serde_json::Value;

use crate::devices::{DeviceArgs, SettingArgs};
use crate::failure::{Failure, Result, for_file};
use crate::located;
use crate::output::{note, shown, warn};
use crate::outputs::check_outputs;
use crate::plugins::PlayerArgs;
use crate::schemas::SchemaFile;
use crate::wasm_limits::WasmLimit;

/// Options for finding the models and the devices of a scene.
#[derive(Args)]
pub(crate) struct SceneArgs {
    #[command(flatten)]
    player: PlayerArgs,

    #[command(flatten)]
    pub(crate) devices: DeviceArgs,
}

/// Options that select the device of a scene and its settings.
#[derive(Args)]
pub(crate) struct ChoiceArgs {
    /// Use this device, by short name or id, instead of the device in the scene. htex then also
    /// ignores the settings of the scene's device
    #[arg(long, value_name = "ID", help_heading = "Devices")]
    pub(crate) device: Option<String>,

    #[command(flatten)]
    pub(crate) settings: SettingArgs,

    /// Factor that converts values from the assets' unit to the device's unit, if the assets and
    /// the device have different quantities. For example, 0.1 plays an acceleration of 1 m/s2 as a
    /// force of 0.1 N
    #[arg(long, value_name = "GAIN", help_heading = "Devices")]
    quantity_gain: Option<f64>,
}

impl ChoiceArgs {
    /// Returns the given device and settings. `output` is the default file. A rehearsal opens no
    /// device.
    pub(crate) fn to_override(
        &self,
        output: Option<&Path>,
        rehearsal: bool,
    ) -> Result<DeviceOverride> {
        Ok(DeviceOverride {
            rehearsal,
            live: false,
            adapter: self.device.clone(),
            profile: self.settings.profile().map(str::to_owned),
            settings: self.settings.given()?,
            rate_hz: None,
            quantity_gain: self.quantity_gain,
            output: output.map(|path| path.display().to_string()),
        })
    }

    /// Refuses to replace an existing file that the user did not name. The default file has the
    /// scene's name with another extension.
    pub(crate) fn check_unnamed(&self, ready: &Ready) -> Result<()> {
        let given = self.settings.given()?;
        let settings = ready.device.descriptor().settings.iter();
        for setting in settings.filter(|s| s.kind == SettingKind::Path) {
            let path = ready.scene.settings.text(&setting.name);
            // `exists` would follow a link, and so overlook a link whose target does not exist.
            if !given.contains_key(&setting.name) && Path::new(path).symlink_metadata().is_ok() {
                return Err(Failure::Usage(format!(
                    "{path} exists; name the file to write, or to replace, by --set {}=FILE",
                    setting.name
                )));
            }
        }
        Ok(())
    }
}

/// A scene with its device.
pub(crate) struct Ready {
    pub(crate) file: PathBuf,
    pub(crate) scene: Scene,
    pub(crate) device: AdapterEntry,
    pub(crate) capabilities: Capabilities,
    pub(crate) devices: Devices,
}

impl SceneArgs {
    pub(crate) fn models(&self) -> Result<Registry> {
        self.player.registry()
    }

    /// Returns the motion of an asset's default condition.
    pub(crate) fn default_motion(&self, file: &Path) -> Result<Motion> {
        let asset = htex::Texture::new(self.player.read(file)?);
        let representation = asset.representation(None).map_err(for_file(file))?;
        let htex::Motion { speed_mm_s, force_n, .. } = representation.motion(None, None);
        Ok(Motion::Constant(Constant { speed_mm_s, force_n, from_mm: None, direction_deg: 0.0 }))
    }

    pub(crate) fn open(&self, file: &Path, device: &DeviceOverride) -> Result<Ready> {
        if located::is_copy(file) {
            return Err(Failure::Usage(format!(
                "{}: a scene names files beside it; download its folder and name the scene there",
                shown(file)
            )));
        }
        self.load(file, |around| Scene::open_with(file, around, device))
    }

    /// Creates a scene from an asset.
    pub(crate) fn of_asset(
        &self,
        file: &Path,
        motion: Motion,
        seconds: Option<f64>,
        device: &DeviceOverride,
    ) -> Result<Ready> {
        self.load(file, |around| Scene::of_asset(file, motion, seconds, around, device))
    }

    fn load(
        &self,
        file: &Path,
        load: impl FnOnce(&Surroundings<'_>) -> Result<Scene, htex_scene::SceneError>,
    ) -> Result<Ready> {
        self.loader()?.load(file, &mut BTreeSet::new(), load)
    }

    /// Finds the models and devices once, for several scenes.
    pub(crate) fn loader(&self) -> Result<Loader> {
        Ok(Loader {
            models: self.models()?,
            devices: self.devices.devices()?,
            embedded: self.player.embedded(),
            signers: self.player.signers()?,
        })
    }

    /// Validates a scene. Runs the models that its assets embed only if `embedded` gives limits for
    /// them.
    pub(crate) fn validate(
        file: &Path,
        embedded: Option<WasmLimits>,
    ) -> Result<htex_base::finding::Report> {
        let is_allowed = embedded.is_some();
        let limits = embedded.unwrap_or_else(|| WasmLimit::all(&[]));
        let registry = Registry::search(&Search::default().with_limits(limits))?;
        let around = Surroundings {
            models: &registry,
            embedded: is_allowed,
            devices: Some(&DeviceArgs::default().devices_quietly()?),
            signers: None,
        };
        htex_scene::validate(file, &around).map_err(for_file(file))
    }

    /// Returns the schema for the settings of a scene's device, if the device is known.
    pub(crate) fn settings_schema(scene: &Value) -> Result<Option<SchemaFile>> {
        let name = scene.pointer("/device/adapter").and_then(Value::as_str);
        let devices = DeviceArgs::default().devices_quietly()?;
        // A scene that names no device plays to a file.
        let device = devices.find_output(name.unwrap_or("file")).ok();
        let settings = |known: &AdapterEntry| crate::schemas::settings(known.descriptor());
        device.map(settings).transpose()
    }
}

/// The models and devices for loading scenes.
pub(crate) struct Loader {
    models: Registry,
    devices: Devices,
    embedded: bool,
    signers: Option<Signers>,
}

impl Loader {
    /// Creates a loader with only this program's own devices, for scenes that are rendered but not
    /// played.
    #[cfg(feature = "exchange")]
    pub(crate) fn builtin(player: &PlayerArgs) -> Result<Self> {
        Ok(Self {
            models: player.registry()?,
            devices: Devices::new(htex_device_builtin::devices()),
            embedded: player.embedded(),
            signers: player.signers()?,
        })
    }

    pub(crate) fn around(&self) -> Surroundings<'_> {
        Surroundings {
            models: &self.models,
            embedded: self.embedded,
            devices: Some(&self.devices),
            signers: self.signers.as_ref(),
        }
    }

    /// Loads a scene and prints its warnings that are not yet in `told`. Adds them to `told`.
    pub(crate) fn load(
        &self,
        file: &Path,
        told: &mut BTreeSet<String>,
        load: impl FnOnce(&Surroundings<'_>) -> Result<Scene, htex_scene::SceneError>,
    ) -> Result<Ready> {
        let scene = load(&self.around()).map_err(|error| match error {
            // A scene that was made from an asset has its name in the error.
            SceneError::Unsigned { ref asset, .. } if asset == file => error.into(),
            error => Failure::from(error).in_file(file),
        })?;
        let new = scene.notes.iter().filter(|note| told.insert(note.to_string()));
        let new: Vec<Notice> = new.map(|note| Notice::new(note.to_string(), note.hint)).collect();
        warn(&new);
        let device = self.devices.find_output(&scene.file.device.adapter)?.clone();
        let capabilities = capabilities(&device, &scene.settings, &self.devices)?;
        Ok(Ready {
            file: file.to_owned(),
            scene,
            device,
            capabilities,
            devices: self.devices.clone(),
        })
    }
}

impl Ready {
    /// Returns the rights of all textures in the scene.
    pub(crate) fn rights(&self) -> Rights {
        let assets = self.scene.assets.iter();
        Rights::of_all(assets.map(|asset| Rights::from_manifest(asset.manifest())))
    }

    pub(crate) fn plan(&self, costs: &Costs) -> Result<Plan> {
        htex_scene::plan(&self.scene, &self.capabilities, costs).map_err(for_file(&self.file))
    }

    /// Refuses an output that is one of the files from which the scene was read.
    pub(crate) fn check_output(&self, output: &Path) -> Result<()> {
        let mut inputs = self.scene.inputs();
        inputs.push(self.file.clone());
        check_outputs([output], inputs.iter().map(PathBuf::as_path))
    }
}

/// Returns the capabilities of a device. For a display that is not connected, derives them from its
/// settings, as far as a plan or a file needs them.
fn capabilities(
    device: &AdapterEntry,
    settings: &Settings,
    devices: &Devices,
) -> Result<Capabilities> {
    let missing = match device.adapter.capabilities(settings) {
        Err(error @ DeviceError::Missing(_)) if settings.number("limit_v") > 0.0 => error,
        other => return Ok(other?),
    };
    let file = devices.find_output("org.htex.file")?;
    let mut given: BTreeMap<String, String> = ["limit_v", "carrier_hz"]
        .iter()
        .map(|name| (name.to_string(), settings.text(name).to_owned()))
        .filter(|(_, value)| !value.is_empty())
        .collect();
    given.insert("quantity".to_owned(), "display_voltage".to_owned());
    // A path has to be given, but no file is opened, so nothing is written.
    given.insert("path".to_owned(), "display.wav".to_owned());
    let like = Settings::resolve(file.descriptor(), None, &given)?;
    let able = file.adapter.capabilities(&like).map_err(|_| missing)?;
    let sentence = "the device is not connected, so its limit and carrier come from its settings and its rates from a file device";
    note(&[sentence.to_owned()]);
    Ok(able)
}

/// Whether a file is an asset, judged by its name. Otherwise it is a scene.
pub(crate) fn is_asset(file: &Path) -> bool {
    file.extension().is_some_and(|e| e.eq_ignore_ascii_case("htex"))
}

/// Returns the file in which measured costs are stored.
pub(crate) fn costs_file() -> Option<PathBuf> {
    htex_host::folders::cache().map(|folder| folder.join("costs.json"))
}

/// Returns the costs measured on this machine, else the built-in ones.
pub(crate) fn costs() -> Costs {
    let kept = costs_file().and_then(|file| Costs::load(&file));
    kept.unwrap_or_else(Costs::embedded)
}
