//! A job: the fit of one texture, as data. Equal jobs give equal bytes, on any machine.
//!
//! Models that are installed on a machine are not used, and no path or time is part of a key.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use htex_author::recording::{ReadError, ReadProblem, read_recording};
use htex_author::settings::{FitSettings, Metadata, ReadingSettings};
use htex_author::{
    AuthorError, Exploration, FeltError, FittedAsset, Take, embed_plugins, fit_asset,
};
use htex_files::{AtFile, FileError};
use htex_host::{Registry, Search, WasmLimits};
use serde::{Deserialize, Serialize};

use crate::BuildError;
use crate::elsewhere::{Elsewhere, elsewhere, is_elsewhere, joined};
use crate::findings::by_code;
use crate::hashes::{Hashed, Hashes, Stamp, changed, hash_local};
use crate::made::{Made, Outcome, Record};
use crate::plan::PlannedTexture;
use crate::sound::sound;
use crate::thumbnail::thumbnail;

/// The meaning of jobs and of what is made of them. Another one makes everything again.
const JOB: &str = "htex-job/3";

/// What is felt of the difference from the recordings, of each model at its worst recorded condition.
fn felt(fitted: &FittedAsset) -> BTreeMap<String, FeltError> {
    let models = fitted.asset.manifest.representations.iter();
    let worst = models
        .zip(&fitted.felt)
        .filter_map(|(representation, felt)| {
            let worst = felt.iter().copied().flatten().reduce(FeltError::worse)?;
            Some((representation.model.clone(), worst))
        });
    worst.collect()
}

/// The fit of one texture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Kind and version of the job, and the program that fits.
    pub program: String,
    pub texture: String,
    pub recordings: Vec<JobRecording>,
    /// How they are read; files are in `files`.
    pub reading: ReadingSettings,
    pub fit: FitSettings,
    pub metadata: Metadata,
    /// The setup's response.
    pub response: Option<JobFile>,
    pub plugins: Vec<JobFile>,
    /// How many of them, the last ones, travel in the asset.
    pub embedded: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JobRecording {
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
        let own = || {
            self.path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned()
        };
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
    /// Returns the job of a texture whose recipe lies in `folder`; hashes its files.
    pub(crate) fn new(
        texture: &PlannedTexture,
        folder: &Path,
        plugins: &[PathBuf],
        program: &str,
        hashes: &Hashes,
    ) -> Result<Self, BuildError> {
        let file = |path: PathBuf| {
            let hashed = hashes.of(&path)?;
            Ok::<_, BuildError>(JobFile { path, hashed })
        };
        let recordings = texture.recordings.iter().map(|recording| {
            Ok::<_, BuildError>(JobRecording {
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
        let embedded = texture
            .settings
            .embed_plugins
            .as_deref()
            .unwrap_or_default();
        let all = plugins.iter().chain(embedded);
        Ok(Self {
            program: program.to_owned(),
            texture: texture.name.clone(),
            recordings: recordings.collect::<Result<_, _>>()?,
            response: reading.response.clone().map(file).transpose()?,
            reading,
            fit: texture.settings.fit(),
            metadata: texture.metadata.clone(),
            plugins: all
                .map(|path| file(joined(folder, path)))
                .collect::<Result<_, _>>()?,
            embedded: embedded.len(),
        })
    }

    /// Returns the key of what this job makes: a hash of everything that its bytes depend on. Folders and times of files are no
    /// part of it, their names and contents are.
    pub fn key(&self) -> String {
        let named = |file: &JobFile| (file.name(), file.hashed.blake3.clone());
        let recordings = self.recordings.iter().map(|r| {
            (
                named(&r.file),
                r.tracker.as_ref().map(named),
                r.speed_mm_s,
                r.force_n,
            )
        });
        let reading = ReadingSettings {
            response: None,
            ..self.reading.clone()
        };
        let parts = serde_json::json!([
            JOB,
            self.program,
            self.texture,
            recordings.collect::<Vec<_>>(),
            reading,
            self.fit,
            self.metadata,
            self.response.as_ref().map(named),
            self.plugins.iter().map(named).collect::<Vec<_>>(),
            self.embedded,
        ]);
        blake3::hash(parts.to_string().as_bytes())
            .to_hex()
            .to_string()
    }

    /// Returns the size of the recordings, bytes.
    pub fn recording_bytes(&self) -> u64 {
        self.recordings
            .iter()
            .map(|r| r.file.hashed.stamp.bytes)
            .sum()
    }

    /// Reads the recordings, fits the models, and returns the asset. A recording that cannot be used, or a model that fails, is a
    /// result too: [`Outcome::Refused`].
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
        copied
            .files_mut()
            .try_for_each(|file| file.copy_here(elsewhere))?;
        copied.reading.response = copied.response.as_ref().map(|file| file.path.clone());
        Ok(Some(copied))
    }

    fn run_here(&self, workbench: &mut Workbench) -> Result<Made, BuildError> {
        self.check_files()?;
        let registry = workbench.registry(self);
        let fitted = registry.and_then(|registry| self.fitted(registry));
        // What was read is what was hashed, or the key is wrong.
        self.check_files()?;
        Ok(match fitted {
            Err(error) => Made::refused(outcome(error)?),
            Ok((fitted, asset, sound)) => Made {
                record: Record {
                    outcome: Outcome::Fitted,
                    segments: fitted.spectra.iter().map(|s| s.segments).collect(),
                    felt: felt(&fitted),
                    findings: by_code(&fitted.findings),
                    thumbnail: fitted.spectra.first().map(thumbnail).unwrap_or_default(),
                },
                asset,
                sound,
            },
        })
    }

    fn fitted(&self, registry: &Registry) -> Result<Fitted, Box<dyn Error>> {
        let reading = ReadingSettings {
            tracker: Some(self.trackers().map(|file| file.path.clone()).collect()),
            ..self.reading.clone()
        };
        let request = self
            .fit
            .request(registry, &reading, &self.texture, &self.program)?;
        let takes = self.recordings.iter().map(|recording| self.take(recording));
        let takes = takes.collect::<Result<Vec<Take>, _>>()?;
        let mut fitted = fit_asset(&takes, &request)?;
        self.metadata.apply(&mut fitted.asset.manifest);
        let travelling = self.plugins.len() - self.embedded.min(self.plugins.len());
        let files: Vec<PathBuf> = self.plugins[travelling..]
            .iter()
            .map(|f| f.path.clone())
            .collect();
        embed_plugins(&mut fitted.asset, registry, &files, None)?;
        let bytes = fitted.asset.to_bytes()?;
        let sound = sound(&bytes, registry)?;
        Ok((fitted, bytes, sound))
    }

    /// Reads a recording.
    fn take(&self, recording: &JobRecording) -> Result<Take, Box<dyn Error>> {
        let reading = ReadingSettings {
            tracker: recording
                .tracker
                .as_ref()
                .map(|file| vec![file.path.clone()]),
            ..self.reading.clone()
        };
        let options = reading.read_options(1)?.pop().unwrap_or_default();
        let given = Exploration {
            speed_mm_s: recording.speed_mm_s,
            force_n: recording.force_n,
        };
        let file = &recording.file.path;
        match read_recording(file, &options) {
            Ok(recording) => Ok(Take { recording, given }),
            Err(ReadError {
                problem: ReadProblem::Io(error),
                ..
            }) => Err(Box::new(BuildError::from(FileError::reading(file, error)))),
            Err(error) => Err(error.into()),
        }
    }

    fn trackers(&self) -> impl Iterator<Item = &JobFile> {
        self.recordings
            .iter()
            .filter_map(|recording| recording.tracker.as_ref())
    }

    fn files(&self) -> impl Iterator<Item = &JobFile> {
        let recordings = self.recordings.iter();
        let recordings = recordings.flat_map(|r| std::iter::once(&r.file).chain(&r.tracker));
        recordings.chain(&self.response).chain(&self.plugins)
    }

    fn files_mut(&mut self) -> impl Iterator<Item = &mut JobFile> {
        let recordings = self.recordings.iter_mut();
        let recordings =
            recordings.flat_map(|r| std::iter::once(&mut r.file).chain(&mut r.tracker));
        recordings
            .chain(&mut self.response)
            .chain(&mut self.plugins)
    }

    /// Refuses a file that is not the one that was hashed: by size and time, or where these differ, by its contents.
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

/// The fit, its asset as bytes, and its sound.
type Fitted = (FittedAsset, Vec<u8>, Vec<u8>);

/// Returns the result that the error of a fit is. A [`BuildError`] is none: a file that cannot be read now may be read later.
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
    loaded: Option<(Vec<PathBuf>, Registry)>,
}

impl Workbench {
    /// Returns a workbench that loads WASM models under `limits`.
    pub fn new(limits: WasmLimits) -> Self {
        Self {
            limits,
            elsewhere: Arc::new(Elsewhere::temporary()),
            loaded: None,
        }
    }

    /// Returns the built-in models and the plugins of a job. Those that are installed on a machine are not used: a build is the
    /// same on all.
    fn registry(&mut self, job: &Job) -> Result<&Registry, Box<dyn Error>> {
        let files: Vec<PathBuf> = job.plugins.iter().map(|file| file.path.clone()).collect();
        if self
            .loaded
            .as_ref()
            .is_none_or(|(loaded, _)| *loaded != files)
        {
            let search = Search::builtin()
                .with_limits(self.limits.clone())
                .with_files(files.clone());
            self.loaded = Some((files, Registry::search(&search)?));
        }
        match &self.loaded {
            Some((_, registry)) => Ok(registry),
            None => Err("no models are loaded".into()),
        }
    }
}
