//! A job: the fit of one texture, as data. Equal jobs give equal bytes, on any machine.
//!
//! Models that are installed on a machine are not used, and no path or time is part of a key.
//! Neither are a texture's name and its metadata but those that decide how it plays (`contact`,
//! `law`): they are laid over what was fitted when it is put together ([`Job::named`]).

use std::collections::BTreeSet;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use htex_author::AuthorError;
use htex_author::settings::{FitSettings, Metadata, ReadingSettings};
use htex_exchange::SignalSettings;
use htex_files::{AtFile, FileError};
use htex_format::Asset;
use htex_host::{Registry, Search, WasmLimits};
use htex_storage::Location;
use serde::{Deserialize, Serialize};

use crate::BuildError;
use crate::elsewhere::{Elsewhere, elsewhere, is_elsewhere, joined};
use crate::error::AtPlace;
use crate::gates::check_gates;
use crate::hashes::{Hashed, Hashes, Stamp, changed, hash_local};
use crate::imports::FileKind;
use crate::inputs::slashed;
use crate::made::{Made, Outcome};
use crate::plan::PlannedTexture;
use crate::recipe::Gates;

/// The meaning of jobs and of what is made of them. Another one makes everything again.
const JOB: &str = "htex-job/5";

/// The plugins that a person and a recipe name, and where the recipe is.
#[derive(Debug)]
pub(crate) struct Named {
    /// By a person: absolute paths.
    by_person: Vec<PathBuf>,
    /// By the recipe, and by no person.
    pub(crate) of_recipe: Vec<PathBuf>,
    /// The recipe's folder.
    pub(crate) folder: PathBuf,
    origin: Option<Location>,
}

impl Named {
    /// # Errors
    /// When a person names a URI, or a file that cannot be found.
    pub(crate) fn new(
        by_person: &[PathBuf],
        of_recipe: Vec<PathBuf>,
        folder: PathBuf,
        origin: Option<Location>,
    ) -> Result<Self, BuildError> {
        let found = by_person.iter().map(|file| {
            if is_elsewhere(file) {
                let problem =
                    "it is a URI; download it, see that it is what you want, and name the file";
                return Err(BuildError::at("--plugin", problem));
            }
            Ok(file.canonicalize().reading(file)?)
        });
        let by_person = found.collect::<Result<Vec<_>, _>>()?;
        let is_named = |file: &PathBuf| {
            let path = joined(&folder, file).canonicalize();
            path.is_ok_and(|path| by_person.contains(&path))
        };
        let of_recipe = of_recipe.into_iter().filter(|file| !is_named(file));
        Ok(Self { of_recipe: of_recipe.collect(), by_person, folder, origin })
    }
}

/// What makes one texture: a fit, or an import.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Kind and version of the job, and the program that fits.
    pub program: String,
    pub texture: String,
    pub recordings: Vec<JobRecording>,
    /// What these files are.
    #[serde(default)]
    pub kind: FileKind,
    /// What signals do not say.
    #[serde(default)]
    pub signal: SignalSettings,
    /// How they are read; files are in `files`.
    pub reading: ReadingSettings,
    pub fit: FitSettings,
    pub metadata: Metadata,
    /// The setup's response.
    pub response: Option<JobFile>,
    pub plugins: Vec<JobFile>,
    /// How many of them, the first ones, a person named. They may be native libraries; the others
    /// are WASM modules.
    #[serde(default)]
    pub named: usize,
    /// How many of them, the last ones, travel in the asset.
    pub embedded: usize,
    /// Where the recipe is, if it is elsewhere: the one server of this machine or network that it
    /// may name.
    #[serde(default)]
    pub origin: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JobRecording {
    /// Its name in reports and messages: that of the file, with the folders that tell it from
    /// another recording of the texture.
    pub name: String,
    pub file: JobFile,
    pub tracker: Option<JobFile>,
    /// Speed, mm/s, if it is given.
    pub speed_mm_s: Option<f64>,
    /// Normal force, newtons, if it is given.
    pub force_n: Option<f64>,
}

/// A file that a job reads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JobFile {
    /// Where it is: a path, or a URI.
    pub path: PathBuf,
    #[serde(flatten)]
    pub hashed: Hashed,
}

impl JobFile {
    /// Returns the file's name without its folder.
    pub fn name(&self) -> String {
        let own = || self.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match elsewhere(&self.path) {
            Ok(Some(location)) => location.file_name().unwrap_or_else(own),
            _ => own(),
        }
    }

    /// Returns the path or URI as texts name it.
    fn shown(&self) -> String {
        match elsewhere(&self.path) {
            Ok(Some(location)) => location.to_string(),
            _ => self.path.display().to_string(),
        }
    }

    /// Puts a copy in place of a file elsewhere.
    fn copy_here(&mut self, copies: &Elsewhere) -> Result<(), BuildError> {
        let Some(location) = elsewhere(&self.path)? else {
            return Ok(());
        };
        self.path = copies.copy(&location, &self.hashed.blake3)?;
        let stamp = Stamp::of(&self.path).reading(&self.path)?;
        self.hashed.stamp = stamp;
        Ok(())
    }
}

impl Job {
    /// Returns the job of a texture; hashes its files.
    pub(crate) fn new(
        texture: &PlannedTexture,
        named: &Named,
        program: &str,
        hashes: &Hashes,
    ) -> Result<Self, BuildError> {
        let folder = &named.folder;
        let file = |path: PathBuf| {
            let hashed = hashes.of(&path)?;
            Ok::<_, BuildError>(JobFile { path, hashed })
        };
        let names = told_apart(texture);
        let recordings = texture.recordings.iter().zip(names).map(|(recording, name)| {
            Ok::<_, BuildError>(JobRecording {
                name,
                file: file(joined(folder, &recording.file))?,
                tracker: recording
                    .tracker
                    .as_ref()
                    .map(|path| file(joined(folder, path)))
                    .transpose()?,
                speed_mm_s: recording.speed_mm_s,
                force_n: recording.force_n,
            })
        });
        let reading = texture.settings.reading(folder);
        let embedded = texture.settings.embed_plugins.as_deref().unwrap_or_default();
        let of_recipe = named.of_recipe.iter().chain(embedded).map(|path| joined(folder, path));
        let all = named.by_person.iter().cloned().chain(of_recipe);
        Ok(Self {
            program: program.to_owned(),
            texture: texture.name.clone(),
            recordings: recordings.collect::<Result<_, _>>()?,
            kind: texture.kind,
            signal: texture.settings.signal.clone(),
            response: reading.response.clone().map(file).transpose()?,
            reading,
            fit: texture.settings.fit(),
            metadata: texture.metadata.clone(),
            plugins: all.map(file).collect::<Result<_, _>>()?,
            named: named.by_person.len(),
            embedded: embedded.len(),
            origin: named.origin.as_ref().map(ToString::to_string),
        })
    }

    /// Returns the job, and its key, of a texture of which a recording or a tracker cannot be read.
    /// It makes nothing, and no job that can be done has its key.
    ///
    /// # Errors
    /// When another of its files cannot be read: a response or a plugin, which other textures need
    /// as well.
    pub(crate) fn absent(
        texture: &PlannedTexture,
        named: &Named,
        program: &str,
        hashes: &Hashes,
    ) -> Result<(String, Self), BuildError> {
        let without = PlannedTexture { recordings: Vec::new(), ..texture.clone() };
        let job = Self::new(&without, named, program, hashes)?;
        let key = hash_of(&serde_json::json!(["absent", texture.name, job.key()]));
        Ok((key, job))
    }

    /// Returns the key of what this job makes: a hash of everything that its bytes depend on.
    /// Folders and times of files are no part of it, their names and contents are.
    pub fn key(&self) -> String {
        let parts = serde_json::json!([JOB, self.parts()]);
        hash_of(&parts)
    }

    /// Returns hashes of what the fit depends on, by name.
    pub(crate) fn parts(&self) -> [(&'static str, String); 5] {
        let named = |file: &JobFile| (file.name(), file.hashed.blake3.clone());
        let recordings = self.recordings.iter().map(|r| {
            (
                (&r.name, &r.file.hashed.blake3),
                r.tracker.as_ref().map(named),
                r.speed_mm_s,
                r.force_n,
            )
        });
        let reading = ReadingSettings { response: None, ..self.reading.clone() };
        let plays = (&self.metadata.contact, &self.metadata.law);
        let response = self.response.as_ref().map(named);
        let plugins = self.plugins.iter().map(named).collect::<Vec<_>>();
        [
            ("recordings", serde_json::json!(recordings.collect::<Vec<_>>())),
            ("reading", serde_json::json!([reading, response, self.kind, self.signal])),
            ("options", serde_json::json!([self.fit, plays])),
            ("plugins", serde_json::json!([plugins, self.embedded])),
            ("program", serde_json::json!(self.program)),
        ]
        .map(|(name, part)| (name, hash_of(&part)))
    }

    /// What [`Self::check`] depends on.
    pub(crate) fn checked_by(&self, gates: &Gates) -> String {
        serde_json::json!([self.kind, self.reading, self.fit, self.plugins, gates]).to_string()
    }

    /// Checks plugins, settings and gates as far as that is possible without a fit.
    pub(crate) fn check(&self, gates: &Gates, workbench: &mut Workbench) -> Result<(), BuildError> {
        let without = Self { recordings: Vec::new(), response: None, ..self.clone() };
        let here = without.copied(&workbench.elsewhere)?;
        let job = here.as_ref().unwrap_or(&without);
        let registry = workbench.registry(job).at("plugins")?;
        if self.kind == FileKind::Asset {
            // It is not fitted, and the plan has refused settings and gates of fits.
            return Ok(());
        }
        let reading = ReadingSettings { response: None, ..self.reading.clone() };
        let request =
            self.fit.request(registry, &reading, &self.texture, &self.program).at(&self.texture)?;
        let models: Vec<&str> = request.models.iter().map(|m| m.model.id()).collect();
        check_gates(gates, &models).at(&self.texture)
    }

    /// Returns an asset that this job made under the texture's own name and with its metadata.
    ///
    /// # Errors
    /// When the bytes are not those of an asset.
    pub(crate) fn named(&self, bytes: &[u8]) -> Result<Vec<u8>, BuildError> {
        let damaged = |problem: String| BuildError::Damaged(format!("{}: {problem}", self.texture));
        let mut asset = Asset::from_bytes(bytes).map_err(|error| damaged(error.to_string()))?;
        asset.manifest.name.clone_from(&self.texture);
        // Another name may have made it, with the same bytes but for what is laid over now.
        let metadata = Metadata { contact: None, law: None, ..self.metadata.clone() };
        metadata.apply(&mut asset.manifest);
        asset.to_bytes().map_err(|error| damaged(error.to_string()))
    }

    /// Returns the size of the recordings, bytes.
    pub fn recording_bytes(&self) -> u64 {
        self.recordings.iter().map(|r| r.file.hashed.stamp.bytes).sum()
    }

    /// Reads the recordings, fits the models, and returns the asset. A recording that cannot be
    /// used, or a model that fails, is a result too: [`Outcome::Refused`].
    ///
    /// # Errors
    /// When a file cannot be read, or is not the one that was hashed.
    pub fn run(&self, workbench: &mut Workbench) -> Result<Made, BuildError> {
        let Some(copied) = self.copied(&workbench.elsewhere)? else {
            return self.run_here(workbench);
        };
        let mut made = copied.run_here(workbench)?;
        let names = || copied.files().zip(self.files());
        if let Outcome::Refused(text) | Outcome::NotStrict(text) = &mut made.record.outcome {
            for (copy, file) in names().filter(|(copy, file)| copy.path != file.path) {
                *text = text.replace(&copy.path.display().to_string(), &file.shown());
            }
        }
        Ok(made)
    }

    /// Returns this job with copies in place of files elsewhere; `None` if it has none of them.
    fn copied(&self, elsewhere: &Elsewhere) -> Result<Option<Self>, BuildError> {
        if !self.files().any(|file| is_elsewhere(&file.path)) {
            return Ok(None);
        }
        let mut copied = self.clone();
        copied.files_mut().try_for_each(|file| file.copy_here(elsewhere))?;
        copied.reading.response = copied.response.as_ref().map(|file| file.path.clone());
        Ok(Some(copied))
    }

    fn run_here(&self, workbench: &mut Workbench) -> Result<Made, BuildError> {
        self.check_files()?;
        let registry = workbench.registry(self);
        let made = registry.and_then(|registry| self.made(registry));
        // What was read is what was hashed, or the key is wrong.
        self.check_files()?;
        match made {
            Err(error) => Ok(Made::refused(outcome(error)?)),
            Ok(made) => Ok(made),
        }
    }

    fn files(&self) -> impl Iterator<Item = &JobFile> {
        let recordings =
            self.recordings.iter().flat_map(|r| std::iter::once(&r.file).chain(&r.tracker));
        recordings.chain(&self.response).chain(&self.plugins)
    }

    fn files_mut(&mut self) -> impl Iterator<Item = &mut JobFile> {
        let recordings = self.recordings.iter_mut();
        let recordings =
            recordings.flat_map(|r| std::iter::once(&mut r.file).chain(&mut r.tracker));
        recordings.chain(&mut self.response).chain(&mut self.plugins)
    }

    /// Refuses a file that is not the one that was hashed: by size and time, or where these differ,
    /// by its contents.
    fn check_files(&self) -> Result<(), BuildError> {
        for file in self.files() {
            if Stamp::of(&file.path).reading(&file.path)? == file.hashed.stamp {
                continue;
            }
            if hash_local(&file.path).reading(&file.path)?.blake3 != file.hashed.blake3 {
                return Err(FileError::reading(&file.path, changed()).into());
            }
        }
        Ok(())
    }
}

/// Returns the result that the error of a fit is. A [`BuildError`] is none: a file that cannot be
/// read now may be read later.
fn outcome(error: Box<dyn Error>) -> Result<Outcome, BuildError> {
    let error = match error.downcast::<BuildError>() {
        Ok(error) => return Err(*error),
        Err(other) => other,
    };
    Ok(match error.downcast_ref() {
        Some(AuthorError::Strict { .. }) => Outcome::NotStrict(error.to_string()),
        _ => Outcome::Refused(error.to_string()),
    })
}

/// The models that a thread fits with, loaded once for each set of plugins.
#[derive(Debug)]
pub struct Workbench {
    limits: WasmLimits,
    /// Files by URI, and their copies.
    pub(crate) elsewhere: Arc<Elsewhere>,
    /// The plugins, how many of them a person named, and the models.
    loaded: Option<(Vec<PathBuf>, usize, Registry)>,
}

impl Workbench {
    /// Returns a workbench that loads WASM models under `limits`.
    pub fn new(limits: WasmLimits) -> Self {
        Self { limits, elsewhere: Arc::new(Elsewhere::temporary(None)), loaded: None }
    }

    /// Returns a workbench for a job of another process, whose recipe may name its own server.
    ///
    /// # Errors
    /// When the job's origin is no location.
    pub fn of_job(limits: WasmLimits, job: &Job) -> Result<Self, BuildError> {
        let origin = job.origin.as_ref().map(|origin| Location::parse(origin.as_ref()));
        Ok(Self {
            elsewhere: Arc::new(Elsewhere::temporary(origin.transpose()?)),
            ..Self::new(limits)
        })
    }

    /// Returns the built-in models and the plugins of a job. Those that are installed on a machine
    /// are not used: a build is the same on all.
    fn registry(&mut self, job: &Job) -> Result<&Registry, Box<dyn Error>> {
        let files: Vec<PathBuf> = job.plugins.iter().map(|file| file.path.clone()).collect();
        let is_loaded = |(loaded, named, _): &(Vec<PathBuf>, usize, Registry)| {
            *loaded == files && *named == job.named
        };
        if !self.loaded.as_ref().is_some_and(is_loaded) {
            let (by_person, of_recipe) = files.split_at(job.named.min(files.len()));
            let search = Search::builtin()
                .with_limits(self.limits.clone())
                .with_files(by_person.to_vec())
                .with_modules(of_recipe.to_vec());
            self.loaded = Some((files, job.named, Registry::search(&search)?));
        }
        match &self.loaded {
            Some((.., registry)) => Ok(registry),
            None => Err("no models are loaded".into()),
        }
    }
}

fn hash_of(value: &serde_json::Value) -> String {
    blake3::hash(value.to_string().as_bytes()).to_hex().to_string()
}

/// Returns the names of a texture's recordings: those of the files, with as many folders before
/// each as tell all apart.
fn told_apart(texture: &PlannedTexture) -> Vec<String> {
    let paths = texture.recordings.iter().map(|r| slashed(&shown_path(&r.file)));
    let paths: Vec<String> = paths.collect();
    let deepest = paths.iter().map(|path| path.split('/').count()).max();
    for parts in 1..deepest.unwrap_or(1) {
        let names: Vec<&str> = paths.iter().map(|path| last_parts(path, parts)).collect();
        let different: BTreeSet<&&str> = names.iter().collect();
        if different.len() == names.len() {
            return names.into_iter().map(str::to_owned).collect();
        }
    }
    paths
}

/// The path of a recording, or of a URI without its query.
pub(crate) fn shown_path(file: &Path) -> PathBuf {
    match elsewhere(file) {
        Ok(Some(location)) => {
            let text = location.to_string();
            let path = text.trim_end_matches("?…");
            match (path.rsplit_once('/'), location.file_name()) {
                (Some((folder, _)), Some(name)) => Path::new(folder).join(name),
                _ => path.into(),
            }
        }
        _ => file.to_owned(),
    }
}

fn last_parts(path: &str, parts: usize) -> &str {
    let slash = path.rmatch_indices('/').nth(parts - 1);
    slash.map_or(path, |(at, _)| &path[at + 1..])
}
