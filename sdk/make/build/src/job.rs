//! A job: the fit or import of one texture, described as data. Equal jobs give equal bytes on any
//! machine.
//!
//! For this reason, a job does not use models that are installed on the machine. The key of a job
//! does not depend on folders or times. The key depends only on those metadata that affect how the
//! texture plays (`contact`, `law`). The texture's name and its other metadata are applied to the
//! fitted asset when the library is assembled ([`Job::apply_metadata`]).

use std::collections::BTreeSet;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use htex_author::AuthorError;
use htex_author::settings::{FitSettings, Metadata, ReadingSettings};
use htex_base::files::{AtFile, FileError};
use htex_base::storage::Location;
use htex_exchange::SignalSettings;
use htex_format::Asset;
use htex_host::{Registry, Search, WasmLimits};
use serde::{Deserialize, Serialize};

use crate::BuildError;
use crate::error::at_place;
use crate::gates::check_gates;
use crate::hashes::{FileHash, Hashes, Stamp, changed, hash_local};
use crate::imports::FileKind;
use crate::inputs::slashed;
use crate::job_result::{JobResult, Outcome};
use crate::plan::PlannedTexture;
use crate::recipe::Gates;
use crate::remote::{RemoteFiles, is_remote, joined, remote_location};

/// Version of the meaning of jobs and their results. If it changes, all textures are made again.
const JOB: &str = "htex-job/5";

/// The plugins named by the user and by the recipe, and the location of the recipe.
#[derive(Debug)]
pub(crate) struct NamedPlugins {
    /// Named by the user: absolute paths.
    by_person: Vec<PathBuf>,
    /// Named by the recipe and not by the user.
    pub(crate) of_recipe: Vec<PathBuf>,
    /// The recipe's folder.
    pub(crate) folder: PathBuf,
    origin: Option<Location>,
}

impl NamedPlugins {
    /// # Errors
    /// If the user names a URI, or a file that cannot be found.
    pub(crate) fn new(
        by_person: &[PathBuf],
        of_recipe: Vec<PathBuf>,
        folder: PathBuf,
        origin: Option<Location>,
    ) -> Result<Self, BuildError> {
        let found = by_person.iter().map(|file| {
            if is_remote(file) {
                let problem =
                    "it is a URI; download it, see that it is what you want, and name the file";
                return Err(BuildError::at_place("--plugin", problem));
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

/// A job: a description of everything that is needed to make one texture, by a fit or an import.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Version of the job format, and the program that fits the texture.
    pub program: String,
    pub texture: String,
    pub recordings: Vec<JobRecording>,
    /// What kind of files the recordings are.
    #[serde(default)]
    pub kind: FileKind,
    /// Settings for values that a haptic file with a signal does not contain, such as the full
    /// scale.
    #[serde(default)]
    pub signal: SignalSettings,
    /// How the recordings are read. The setting `tracker` is not set, because each recording of the
    /// job has its own tracker.
    pub reading: ReadingSettings,
    pub fit: FitSettings,
    pub metadata: Metadata,
    /// The file with the frequency response of the recording setup.
    pub response: Option<JobFile>,
    pub plugins: Vec<JobFile>,
    /// Number of plugins that the user named; they are the first in `plugins`. These plugins may be
    /// native libraries. All other plugins are WASM modules.
    #[serde(default)]
    pub named: usize,
    /// Number of plugins that are embedded in the asset; they are the last in `plugins`.
    pub embedded: usize,
    /// Location of the recipe, if it is remote. The recipe may name files on the server from which
    /// the recipe comes. The recipe is not allowed to name files on any other server that runs on
    /// this machine or in its network.
    #[serde(default)]
    pub origin: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JobRecording {
    /// The recording's name in reports and messages. It consists of the file's name, and of as many
    /// folders before it as are needed to distinguish the texture's recordings.
    pub name: String,
    pub file: JobFile,
    pub tracker: Option<JobFile>,
    /// Speed, mm/s, if given.
    pub speed_mm_s: Option<f64>,
    /// Normal force, newtons, if given.
    pub force_n: Option<f64>,
}

/// A file that a job reads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JobFile {
    /// Where the file is: a path or a URI.
    pub path: PathBuf,
    #[serde(flatten)]
    pub hash: FileHash,
}

impl JobFile {
    /// Returns the file's name without its folder.
    pub fn name(&self) -> String {
        let own = || self.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match remote_location(&self.path) {
            Ok(Some(location)) => location.file_name().unwrap_or_else(own),
            _ => own(),
        }
    }

    /// Returns the path or URI for use in texts.
    fn shown(&self) -> String {
        match remote_location(&self.path) {
            Ok(Some(location)) => location.to_string(),
            _ => self.path.display().to_string(),
        }
    }

    /// Replaces a remote file by a local copy.
    fn copy_here(&mut self, copies: &RemoteFiles) -> Result<(), BuildError> {
        let Some(location) = remote_location(&self.path)? else {
            return Ok(());
        };
        self.path = copies.copy(&location, &self.hash.blake3)?;
        let stamp = Stamp::read(&self.path).reading(&self.path)?;
        self.hash.stamp = stamp;
        Ok(())
    }
}

impl Job {
    /// Hashes the files of a texture and returns its job.
    pub(crate) fn new(
        texture: &PlannedTexture,
        named: &NamedPlugins,
        program: &str,
        hashes: &Hashes,
    ) -> Result<Self, BuildError> {
        let folder = &named.folder;
        let file = |path: PathBuf| {
            let hash = hashes.hash(&path)?;
            Ok::<_, BuildError>(JobFile { path, hash })
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

    /// Returns the job and the key of a texture with a recording or a tracker that cannot be read.
    /// The job makes nothing, and no job that can run has its key.
    ///
    /// # Errors
    /// If another file of the texture cannot be read: a response or a plugin, which other textures
    /// also need.
    pub(crate) fn absent(
        texture: &PlannedTexture,
        named: &NamedPlugins,
        program: &str,
        hashes: &Hashes,
    ) -> Result<(String, Self), BuildError> {
        let without = PlannedTexture { recordings: Vec::new(), ..texture.clone() };
        let job = Self::new(&without, named, program, hashes)?;
        // The name is part of the key, because the jobs of two unreadable textures may be equal
        // without their recordings.
        let key = hash_of(&serde_json::json!(["absent", texture.name, job.key()]));
        Ok((key, job))
    }

    /// Returns the key of this job's result: a hash of everything that the result's bytes depend
    /// on. The key depends on the names and contents of files, but not on their folders and times.
    pub fn key(&self) -> String {
        let parts = serde_json::json!([JOB, self.parts()]);
        hash_of(&parts)
    }

    /// Returns hashes of everything the fit depends on, by name.
    pub(crate) fn parts(&self) -> [(&'static str, String); 5] {
        let named = |file: &JobFile| (file.name(), file.hash.blake3.clone());
        let recordings = self.recordings.iter().map(|r| {
            ((&r.name, &r.file.hash.blake3), r.tracker.as_ref().map(named), r.speed_mm_s, r.force_n)
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

    /// Returns everything that [`Self::check`] depends on, as a text.
    pub(crate) fn checked_by(&self, gates: &Gates) -> String {
        serde_json::json!([self.kind, self.reading, self.fit, self.plugins, gates]).to_string()
    }

    /// Checks plugins, settings and gates as far as this is possible without a fit.
    pub(crate) fn check(&self, gates: &Gates, workbench: &mut Workbench) -> Result<(), BuildError> {
        // Recordings may be large or remote, and these checks need none of them.
        let without = Self { recordings: Vec::new(), response: None, ..self.clone() };
        let here = without.copied(&workbench.remote)?;
        let job = here.as_ref().unwrap_or(&without);
        let registry = workbench.registry(job).map_err(at_place("plugins"))?;
        if self.kind == FileKind::Asset {
            // It is not fitted, and the plan has already refused settings and gates of fits.
            return Ok(());
        }
        let reading = ReadingSettings { response: None, ..self.reading.clone() };
        let request = self
            .fit
            .request(registry, &reading, &self.texture, &self.program)
            .map_err(at_place(&self.texture))?;
        let models: Vec<&str> = request.models.iter().map(|m| m.model.id()).collect();
        check_gates(gates, &models).map_err(at_place(&self.texture))
    }

    /// Applies the texture's own name and metadata to an asset that this job made.
    ///
    /// # Errors
    /// If the bytes are not an asset.
    pub(crate) fn apply_metadata(&self, bytes: &[u8]) -> Result<Vec<u8>, BuildError> {
        let damaged = |problem: String| BuildError::Damaged(format!("{}: {problem}", self.texture));
        let mut asset = Asset::from_bytes(bytes).map_err(|error| damaged(error.to_string()))?;
        asset.manifest.name.clone_from(&self.texture);
        // The asset may have been made for a texture with another name. The fit is the same; only
        // the metadata differs.
        let metadata = Metadata { contact: None, law: None, ..self.metadata.clone() };
        metadata.apply(&mut asset.manifest);
        asset.to_bytes().map_err(|error| damaged(error.to_string()))
    }

    /// Returns the total size of the recordings, bytes.
    pub fn recording_bytes(&self) -> u64 {
        self.recordings.iter().map(|r| r.file.hash.stamp.bytes).sum()
    }

    /// Reads the recordings, fits the models, and returns the result with the asset. A recording
    /// that cannot be used, or a model that fails, is not an error: the result then has the outcome
    /// [`Outcome::Refused`].
    ///
    /// # Errors
    /// Returns an error if a file cannot be read, or has changed since it was hashed.
    pub fn run(&self, workbench: &mut Workbench) -> Result<JobResult, BuildError> {
        let Some(copied) = self.copied(&workbench.remote)? else {
            return self.run_here(workbench);
        };
        let mut made = copied.run_here(workbench)?;
        // The copies are temporary, so messages must name the original files.
        let names = || copied.files().zip(self.files());
        if let Outcome::Refused(text) | Outcome::NotStrict(text) = &mut made.record.outcome {
            for (copy, file) in names().filter(|(copy, file)| copy.path != file.path) {
                *text = text.replace(&copy.path.display().to_string(), &file.shown());
            }
        }
        Ok(made)
    }

    /// Returns this job with copies in place of remote files; `None` if it has no remote files.
    fn copied(&self, remote: &RemoteFiles) -> Result<Option<Self>, BuildError> {
        if !self.files().any(|file| is_remote(&file.path)) {
            return Ok(None);
        }
        let mut copied = self.clone();
        copied.files_mut().try_for_each(|file| file.copy_here(remote))?;
        copied.reading.response = copied.response.as_ref().map(|file| file.path.clone());
        Ok(Some(copied))
    }

    fn run_here(&self, workbench: &mut Workbench) -> Result<JobResult, BuildError> {
        self.check_files()?;
        let registry = workbench.registry(self);
        let made = registry.and_then(|registry| self.make(registry));
        // The files that were read must be the ones that were hashed, because otherwise the key is
        // wrong.
        self.check_files()?;
        match made {
            Err(error) => Ok(JobResult::refused(outcome(error)?)),
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

    /// Refuses a file that has changed since it was hashed. Compares size and times first and, if
    /// these differ, the contents.
    fn check_files(&self) -> Result<(), BuildError> {
        for file in self.files() {
            if Stamp::read(&file.path).reading(&file.path)? == file.hash.stamp {
                continue;
            }
            if hash_local(&file.path).reading(&file.path)?.blake3 != file.hash.blake3 {
                return Err(FileError::reading(&file.path, changed()).into());
            }
        }
        Ok(())
    }
}

/// Converts the error of a fit to a result. A [`BuildError`] is not a result, because a file that
/// cannot be read now may be readable later.
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

/// The loaded models of a thread that runs jobs. Models are loaded once for each set of plugins.
#[derive(Debug)]
pub struct Workbench {
    limits: WasmLimits,
    /// Remote files and their copies.
    pub(crate) remote: Arc<RemoteFiles>,
    /// The plugins, the number of them that the user named, and the models.
    loaded: Option<(Vec<PathBuf>, usize, Registry)>,
}

impl Workbench {
    /// Returns a workbench that loads WASM models under `limits`.
    pub fn new(limits: WasmLimits) -> Self {
        Self { limits, remote: Arc::new(RemoteFiles::temporary(None)), loaded: None }
    }

    /// Returns a workbench for a job that another process planned. Remote files of the job may be
    /// on the server from which the recipe comes ([`Job::origin`]).
    ///
    /// # Errors
    /// Returns an error if the job's origin is not a location.
    pub fn of_job(limits: WasmLimits, job: &Job) -> Result<Self, BuildError> {
        let origin = job.origin.as_ref().map(|origin| Location::parse(origin.as_ref()));
        Ok(Self {
            remote: Arc::new(RemoteFiles::temporary(origin.transpose()?)),
            ..Self::new(limits)
        })
    }

    /// Returns the built-in models and the plugins of a job. Models that are installed on a machine
    /// are not used, so that a build gives the same results everywhere.
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

/// Returns the names of a texture's recordings. Each is the file name, with as many folders before
/// it as are needed to make all names different.
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

/// Returns the path of a recording, or its URI without the query.
pub(crate) fn shown_path(file: &Path) -> PathBuf {
    match remote_location(file) {
        Ok(Some(location)) => {
            let text = location.to_string();
            // A location shows its query as `?…`.
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
