//! Loads a scene and the files that it names.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use htex_base::finding::{Finding, Findings, Hint, Notice, Report, Rule};
use htex_device::{Capabilities, Devices, Rates, Settings};
use htex_format::signing::{SignatureError, Signers, signature_path};
use htex_format::{Asset, Quantity, ReadError as ReadFailure};
use htex_play::{Registry, Texture, VoiceOptions};
use htex_recording::{ReadError, ReadProblem};

use crate::check::check;
use crate::device::{DeviceOverride, check_device, device_quantity, stem};
use crate::file::{DeviceChoice, Motion, SceneFile, Surface, VERSION};
use crate::limits::Limits;
use crate::plan::{Plan, plan};
use crate::response::{self, Inverse, Response};
use crate::rules as rule;
use crate::trace::Trace;
use crate::validate::read_scene;
use crate::{Costs, Renderer, SceneError};

/// What a program provides for opening a scene: the models that may play the scene's textures, and
/// the devices on which the scene may play.
#[derive(Clone, Copy)]
pub struct Surroundings<'a> {
    pub models: &'a Registry,
    /// Whether models that are embedded in assets may run (in a sandbox).
    pub embedded: bool,
    /// The devices on which the scene may play. `None` means that the program takes the samples
    /// itself instead of playing them on a device. The scene's device is then ignored.
    pub devices: Option<&'a Devices>,
    /// Who must have signed each texture. `None` also accepts textures without a signature.
    pub signers: Option<&'a Signers>,
}

/// Supplies the files of a scene, for programs that do not keep them in a folder.
pub trait FileSource {
    /// Reads a file by its path, exactly as the scene states it.
    ///
    /// # Errors
    /// Returns [`io::ErrorKind::NotFound`] if there is no such file. The program may return any
    /// other error.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;
}

/// Where the files of a scene are.
enum Place<'a> {
    Folder(PathBuf),
    Given(&'a dyn FileSource),
}

impl Place<'_> {
    /// Returns the folder where relative paths start. Empty if there is none.
    fn folder(&self) -> PathBuf {
        match self {
            Self::Folder(folder) => folder.clone(),
            Self::Given(_) => PathBuf::new(),
        }
    }
}

/// An opened scene, with all files that it names.
///
/// ```no_run
/// let scene = htex_scene::Scene::open("two.scene.json")?;
/// let mut block = [0.0; 64];
/// let frames = scene.renderer(20_000.0)?.render(&mut block)?; // in the textures' unit
/// # Ok::<(), htex_scene::SceneError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Scene {
    /// The contents of the scene file, with the program's device options applied.
    pub file: SceneFile,
    /// Folder where relative paths start.
    pub folder: PathBuf,
    /// The textures, one for each surface.
    pub assets: Vec<Texture>,
    /// The motion, if it is a trace.
    pub trace: Option<Trace>,
    /// The frequency response to compensate, if the scene names one.
    pub response: Option<Response>,
    /// The device's settings, for querying and opening it.
    pub settings: Settings,
    /// Findings that are not errors.
    pub notes: Vec<Finding>,
}

/// Default sample rate for a program that takes the samples itself, hertz. It is the paper's rate.
const USUAL_RATE_HZ: f64 = 20_000.0;
/// The sample rates at which a program may take the samples itself, hertz.
const RATES_HZ: Rates = Rates::Range { min_hz: 100.0, max_hz: 1e6 };

impl Scene {
    /// Opens a scene file and the files it names, for a program that takes the samples itself
    /// instead of playing them on a device. The built-in and the embedded models play the textures.
    /// The scene's device is ignored. A scene that exceeds the default [`Limits`] is an error.
    ///
    /// # Errors
    /// Returns [`SceneError::Io`] if the file cannot be read. Returns [`SceneError::Invalid`] with
    /// all findings if at least one finding is an error.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let models = &Registry::builtin();
        let around = Surroundings { models, embedded: true, devices: None, signers: None };
        Self::open_with(path.as_ref(), &around, &DeviceOverride::default())
    }

    /// Opens a scene file as [`Self::open`] does, if one of `signers` signed each texture. Only
    /// textures are signed: the scene itself, its motion and its response are not.
    ///
    /// # Errors
    /// Returns the errors of [`Self::open`], and [`SceneError::Unsigned`] if none of `signers` signed
    /// a texture.
    pub fn open_signed(path: impl AsRef<Path>, signers: &Signers) -> Result<Self, SceneError> {
        let models = &Registry::builtin();
        let signers = Some(signers);
        let around = Surroundings { models, embedded: true, devices: None, signers };
        Self::open_with(path.as_ref(), &around, &DeviceOverride::default())
    }

    /// Opens a scene file and the files it names, with the given models and devices.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::open`].
    pub fn open_with(
        path: &Path,
        around: &Surroundings<'_>,
        device: &DeviceOverride,
    ) -> Result<Self, SceneError> {
        Self::from_bytes(path, &read_file(path)?, around, device)
    }

    /// Opens a scene file whose contents are in memory, and the files that the scene names.
    /// Relative paths start at the folder of `path`, but the file at `path` itself is not opened.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::open`].
    pub fn from_bytes(
        path: &Path,
        bytes: &[u8],
        around: &Surroundings<'_>,
        device: &DeviceOverride,
    ) -> Result<Self, SceneError> {
        let device = (device, &stem(path)[..]);
        Self::read(bytes, &Place::Folder(folder(path)), around, device)
    }

    /// Opens a scene file whose contents are in memory. The program supplies the files that the
    /// scene names. The field `folder` of the result is empty.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::open`].
    pub fn from_files(
        bytes: &[u8],
        files: &dyn FileSource,
        around: &Surroundings<'_>,
        device: &DeviceOverride,
    ) -> Result<Self, SceneError> {
        Self::read(bytes, &Place::Given(files), around, (device, "scene"))
    }

    fn read(
        bytes: &[u8],
        place: &Place<'_>,
        around: &Surroundings<'_>,
        device: (&DeviceOverride, &str),
    ) -> Result<Self, SceneError> {
        let mut findings = Findings::default();
        let file = read_scene(bytes, &Limits::default(), &mut findings);
        let scene = match file {
            Some(file) => load(file, place, around, device, &mut findings)?,
            None => None,
        };
        finish(scene, findings).map_err(|error| error.pointing_into(bytes))
    }

    /// Makes a scene with one surface that covers everything, without a scene file.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::open`]. The findings point into the scene file that would
    /// describe the same scene.
    pub fn of_asset(
        asset: &Path,
        motion: Motion,
        duration_s: Option<f64>,
        around: &Surroundings<'_>,
        device: &DeviceOverride,
    ) -> Result<Self, SceneError> {
        let file = SceneFile {
            htex_scene: VERSION.to_owned(),
            surfaces: vec![Surface::everywhere(asset)],
            motion,
            device: DeviceChoice::default(),
            duration_s,
            seed: 0,
            budget: Default::default(),
            effects: Default::default(),
        };
        let mut findings = Findings::default();
        check(&file, &Limits::default(), &mut findings);
        let device = (device, &stem(asset)[..]);
        let place = Place::Folder(PathBuf::new());
        let scene = load(file, &place, around, device, &mut findings)?;
        finish(scene, findings)
    }

    /// Plans the scene for a program that takes the samples itself. The samples have the rate
    /// `rate_hz` (100 Hz to 1 MHz) and the textures' unit. The plan depends neither on the scene's
    /// device nor on computing times measured on this machine.
    ///
    /// # Errors
    /// See [`SceneError`].
    pub fn plan(&self, rate_hz: f64) -> Result<Plan, SceneError> {
        let mut scene = self.clone();
        scene.file.device = DeviceChoice { rate_hz: Some(rate_hz), ..DeviceChoice::default() };
        scene.response = None;
        let program = Capabilities {
            quantity: device_quantity(self.quantity()),
            rates: RATES_HZ,
            default_rate_hz: USUAL_RATE_HZ,
            limit: None,
            step: None,
            carrier_hz: None,
            paced: false,
            block_frames: 4096,
        };
        plan(&scene, &program, &Costs::embedded())
    }

    /// Makes a renderer for a program that takes the samples itself. The samples have the rate
    /// `rate_hz` and the textures' unit ([`Self::plan`]). For a device, use [`crate::plan()`] and
    /// [`Renderer::new`].
    ///
    /// # Errors
    /// See [`SceneError`].
    pub fn renderer(&self, rate_hz: f64) -> Result<Renderer, SceneError> {
        Renderer::new(self, &self.plan(rate_hz)?)
    }

    /// Returns the paths of all files that the scene names.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let assets = self.file.surfaces.iter().map(|surface| &surface.asset);
        let trace = match &self.file.motion {
            Motion::Trace(path) => Some(path),
            _ => None,
        };
        let all = assets.chain(trace).chain(&self.file.device.response);
        let file = |path: PathBuf| htex_format::Asset::file_of(&path).to_owned();
        all.map(|path| file(self.folder.join(path))).collect()
    }

    /// Returns the physical quantity of the textures. All textures of a scene have the same
    /// quantity.
    pub fn quantity(&self) -> Quantity {
        let first = self.assets.first();
        first.map_or(Quantity::default(), Texture::quantity)
    }
}

/// A hint to allow embedded models to run ([`Surroundings::embedded`]), for findings that would
/// then disappear.
pub const ALLOW_EMBEDDED: Hint = Hint::new(&["embedded_plugins"]);

/// Validates a scene file and the files it names.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn validate(path: &Path, around: &Surroundings<'_>) -> Result<Report, SceneError> {
    let rehearsal = DeviceOverride { rehearsal: true, ..DeviceOverride::default() };
    let findings = match Scene::open_with(path, around, &rehearsal) {
        Ok(scene) => return Ok(Report { valid: true, findings: scene.notes }),
        Err(SceneError::Invalid { findings }) => findings,
        Err(error) => return Err(error),
    };
    Ok(Report { valid: false, findings })
}

fn finish(scene: Option<Scene>, findings: Findings) -> Result<Scene, SceneError> {
    let has_errors = findings.has_errors();
    let findings = findings.into_list();
    match scene {
        Some(scene) if !has_errors => Ok(Scene { notes: findings, ..scene }),
        _ => Err(SceneError::Invalid { findings }),
    }
}

/// Reads a file up to one byte above the size limit.
fn read_file(path: &Path) -> Result<Vec<u8>, SceneError> {
    // One byte more than allowed shows that the file is too long.
    let most = Limits::default().file_bytes + 1;
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes));
    match read {
        Ok(_) => Ok(bytes),
        Err(error) => Err(SceneError::Io { path: path.to_owned(), error }),
    }
}

fn folder(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_owned()
}

/// Opens the files of a scene. Adds a finding for each missing file, and then returns `None`. A
/// texture that is not signed as the program requires is an error.
fn load(
    mut file: SceneFile,
    place: &Place<'_>,
    around: &Surroundings<'_>,
    device: (&DeviceOverride, &str),
    findings: &mut Findings,
) -> Result<Option<Scene>, SceneError> {
    let assets = open_assets(&file, place, around, findings)?;
    let trace = open_trace(&file, place, findings);
    // The override is applied before the response is opened, because choosing another adapter drops
    // the scene's response.
    match around.devices {
        Some(_) => device.0.apply(&mut file.device),
        None => file.device = DeviceChoice::default(),
    }
    let response = open_response(&file, place, findings);
    let held = assets.as_ref().and_then(|all| all.first()).map(Texture::quantity);
    let settings = match around.devices {
        Some(devices) => check_device(&file.device, device, devices, held, findings),
        None => Some(Settings::default()),
    };
    // Missing assets end the function only here, so that they do not hide the findings of the
    // device.
    let Some(assets) = assets else {
        return Ok(None);
    };
    check_quantities(&assets, findings);
    // An invalid motion already has a finding.
    if !findings.has_errors() {
        crate::beyond::check(&file, &assets, trace.as_ref(), findings);
    }
    if let Some(response) = &response {
        check_response(response, &assets, &file.device, findings);
    }
    let folder = place.folder();
    let scene =
        |settings| Scene { assets, trace, response, settings, file, folder, notes: Vec::new() };
    Ok(settings.map(scene))
}

/// Opens the assets of all surfaces. Each file is opened only once.
fn open_assets(
    scene: &SceneFile,
    place: &Place<'_>,
    around: &Surroundings<'_>,
    findings: &mut Findings,
) -> Result<Option<Vec<Texture>>, SceneError> {
    // Nothing depends on the order of this map.
    let mut opened: HashMap<&Path, Result<Texture, Unusable>> = HashMap::new();
    let mut assets = Vec::new();
    for (i, surface) in scene.surfaces.iter().enumerate() {
        let open = || open_asset(&surface.asset, place, around);
        match opened.entry(&surface.asset).or_insert_with(open) {
            Ok(asset) => {
                check_representation(asset, surface, i, findings);
                assets.push(asset.clone());
            }
            Err(Unusable::Found(rule, message)) => {
                findings.add(rule, format!("/surfaces/{i}/asset"), message.clone());
            }
            Err(Unusable::Unsigned(error)) => {
                let (asset, error) = (surface.asset.clone(), error.clone());
                return Err(SceneError::Unsigned { asset, error });
            }
        }
    }
    Ok((assets.len() == scene.surfaces.len()).then_some(assets))
}

/// The reason why an asset of a scene is not used.
enum Unusable {
    /// The scene breaks a rule.
    Found(&'static Rule, String),
    /// The program requires a signature.
    Unsigned(SignatureError),
}

fn open_asset(
    asset: &Path,
    place: &Place<'_>,
    around: &Surroundings<'_>,
) -> Result<Texture, Unusable> {
    let data = match place {
        Place::Folder(folder) => {
            let path = folder.join(asset);
            if !may_be_read(htex_format::Asset::file_of(&path)) {
                return Err(Unusable::Found(rule::ASSET_INVALID, no_file(asset)));
            }
            match around.signers {
                None => Asset::open(&path),
                Some(signers) => Asset::open_signed(&path, signers),
            }
        }
        Place::Given(files) => read_given(*files, asset, around.signers),
    };
    let data = data.map_err(|error| match error {
        ReadFailure::Signature(error) => Unusable::Unsigned(error),
        ReadFailure::Io { error, .. } if is_missing(&error) => {
            Unusable::Found(rule::ASSET_MISSING, missing(asset))
        }
        error => Unusable::Found(rule::ASSET_INVALID, format!("{}: {error}", asset.display())),
    })?;
    let texture = Texture::with_registry(data, around.models.clone());
    Ok(if around.embedded { texture.with_embedded() } else { texture })
}

/// Reads an asset that the program supplies. The signature of the file `NAME` is the file `NAME.sig`.
fn read_given(
    files: &dyn FileSource,
    asset: &Path,
    signers: Option<&Signers>,
) -> Result<Asset, ReadFailure> {
    let read = |path: &Path| {
        let failed = |error| ReadFailure::Io { path: path.to_owned(), error };
        files.read(path).map_err(failed)
    };
    let bytes = read(asset)?;
    let Some(signers) = signers else {
        return Asset::from_bytes(&bytes);
    };
    let signature = match read(&signature_path(asset)) {
        Ok(signature) => Some(signature),
        Err(ReadFailure::Io { error, .. }) if is_missing(&error) => None,
        Err(error) => return Err(error),
    };
    Asset::from_signed_bytes(&bytes, signature.as_deref(), signers)
}

/// Reports assets whose quantity differs from the first asset's.
fn check_quantities(assets: &[Texture], findings: &mut Findings) {
    let Some(first) = assets.first().map(Texture::quantity) else {
        return;
    };
    for (i, asset) in assets.iter().enumerate() {
        let held = asset.quantity();
        findings.require(
            held == first,
            rule::QUANTITIES_DIFFER,
            format!("/surfaces/{i}/asset"),
            || {
                format!(
                    "the asset holds {held} in {}, and the first surface's asset {first} in {}",
                    held.unit(),
                    first.unit()
                )
            },
        );
    }
}

/// Returns whether the path is a regular file or missing. Scenes may come from untrusted sources,
/// and reading a device or a pipe may never end.
fn may_be_read(path: &Path) -> bool {
    // A missing file passes here, because opening it gives the better message.
    std::fs::metadata(path).map_or(true, |what| what.is_file())
}

fn no_file(path: &Path) -> String {
    format!("{} is not a regular file; name one", path.display())
}

fn is_missing(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::NotFound
}

fn missing(path: &Path) -> String {
    format!("there is no file {}; correct the path, or put it there", path.display())
}

fn check_representation(asset: &Texture, surface: &Surface, i: usize, findings: &mut Findings) {
    let source = |model: &str| {
        let representation = asset.representation(model)?;
        representation.source(&VoiceOptions::default()).map(|_| ())
    };
    let playable = match surface.representation.as_str() {
        "auto" => {
            let all = asset.manifest().representations.iter();
            let mut tried = all.map(|r| source(&r.model));
            let first = tried.next().unwrap_or(Ok(()));
            first.or_else(|error| tried.find(Result::is_ok).unwrap_or(Err(error)))
        }
        // An empty name already has a finding.
        name if name.trim().is_empty() => Ok(()),
        name => source(name),
    };
    if let Err(error) = playable {
        let rule = match error {
            htex_play::Error::NoRepresentation { .. } => rule::REPRESENTATION_MISSING,
            _ => rule::REPRESENTATION_UNPLAYABLE,
        };
        let hint = match error {
            htex_play::Error::EmbeddedOff { .. }
            | htex_play::Error::ModelOlder { embedded: true, .. } => ALLOW_EMBEDDED,
            _ => Hint::NONE,
        };
        let message = format!("{}: {error}", surface.asset.display());
        let notice = Notice::new(message, hint);
        findings.add(rule, format!("/surfaces/{i}/representation"), notice);
    }
}

fn open_trace(scene: &SceneFile, place: &Place<'_>, findings: &mut Findings) -> Option<Trace> {
    let Motion::Trace(path) = &scene.motion else {
        return None;
    };
    let rules = [rule::TRACE_MISSING, rule::TRACE_INVALID];
    let open: (OpenFile<Trace>, FromBytes<Trace>) = (Trace::open, Trace::from_bytes);
    let trace = opened(open, place, path, rules, "/motion/trace", findings)?;
    for warning in &trace.warnings {
        findings.add(rule::TRACE_ASSUMED, "/motion/trace", warning.clone());
    }
    let (wanted, there) = (scene.duration_s.unwrap_or(0.0), trace.duration_s());
    findings.require(wanted <= there, rule::DURATION_BEYOND_TRACE, "/duration_s", || {
        format!("the duration is {wanted} s and the trace ends after {there} s; the rest is silent")
    });
    Some(trace)
}

fn open_response(
    scene: &SceneFile,
    place: &Place<'_>,
    findings: &mut Findings,
) -> Option<Response> {
    let path = scene.device.response.as_ref()?;
    let rules = [rule::RESPONSE_MISSING, rule::RESPONSE_INVALID];
    let open: (OpenFile<Response>, FromBytes<Response>) = (response::open, response::from_bytes);
    opened(open, place, path, rules, "/device/response", findings)
}

/// Reports a response that is zero in the textures' band, and warns about the frequencies that its
/// compensation amplifies.
fn check_response(
    response: &Response,
    assets: &[Texture],
    choice: &DeviceChoice,
    findings: &mut Findings,
) {
    let pitch = choice.pitch.unwrap_or(1.0);
    let inverse = Inverse::new(response, assets, pitch, choice.response_depth_db);
    let band = inverse.band();
    findings.require(
        inverse.reaches_band(),
        rule::RESPONSE_INVALID,
        "/device/response",
        || {
            format!(
                "every magnitude from {} to {} Hz, the band of the textures, is 0; measure the response there",
                band.low_hz, band.high_hz
            )
        },
    );
    if let Some(raised) = inverse.raised() {
        findings.add(
            rule::RESPONSE_RAISED,
            "/device/response",
            format!("the compensation raises {raised}, relative to the frequency of the largest response"),
        );
    }
}

type OpenFile<T> = fn(&Path) -> Result<T, ReadError>;
type FromBytes<T> = fn(&str, &[u8]) -> Result<T, ReadError>;

/// Opens a file. If it is missing or invalid, adds a finding instead.
fn opened<T>(
    (open, from_bytes): (OpenFile<T>, FromBytes<T>),
    place: &Place<'_>,
    path: &Path,
    [gone, invalid]: [&Rule; 2],
    pointer: &str,
    findings: &mut Findings,
) -> Option<T> {
    let name = path.display().to_string();
    let read = match place {
        Place::Folder(folder) => {
            let file = folder.join(path);
            if !may_be_read(&file) {
                findings.add(invalid, pointer, no_file(path));
                return None;
            }
            open(&file)
        }
        Place::Given(files) => files
            .read(path)
            .map_err(|error| ReadProblem::Io(error).in_file(&name))
            .and_then(|bytes| from_bytes(&name, &bytes)),
    };
    match read {
        Ok(value) => return Some(value),
        Err(ReadError { problem: ReadProblem::Io(error), .. }) if is_missing(&error) => {
            findings.add(gone, pointer, missing(path));
        }
        Err(error) => findings.add(invalid, pointer, error.to_string()),
    }
    None
}
