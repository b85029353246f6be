//! A build: plan, fit what is not there, put together.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use htex_files::{AtFile, FileError};
use htex_host::WasmLimits;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::BuildError;
use crate::assemble::{Built, assemble};
use crate::cache::Cache;
use crate::dist::Dist;
use crate::elsewhere::{Elsewhere, folder_of, joined};
use crate::error::AtPlace;
use crate::hashes::{Hashed, Hashes, hash};
use crate::job::{Job, Workbench};
use crate::made::{Made, Outcome};
use crate::plan::{Plan, PlannedTexture};
use crate::recipe::Recipe;

/// Folder of what a build keeps for the next one, in the folder of the results.
const KEPT: &str = ".htex-build";

/// The folder of copies of files elsewhere, in that folder.
const COPIES: &str = "elsewhere";

/// The file of hashes, in that folder.
const HASHES: &str = "files.json";

#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct BuildOptions {
    /// Textures that are fitted at the same time; 0 is one for each processor.
    pub jobs: usize,
    /// Whether to go on after a texture that cannot be made, and to leave it out.
    pub keep_going: bool,
    pub limits: WasmLimits,
    /// Program and version, for the assets' provenance. A texture that another one fitted is fitted again.
    pub program: String,
    /// Folder of the browser package, with which the catalogue plays textures; without it, the catalogue has short sounds.
    pub browser_package: Option<PathBuf>,
}

impl BuildOptions {
    /// The options of a program: its name and version.
    pub fn new(program: impl Into<String>) -> Self {
        Self {
            jobs: 0,
            keep_going: false,
            limits: WasmLimits::default(),
            program: program.into(),
            browser_package: None,
        }
    }

    /// Sets how many textures are fitted at the same time; 0 is one for each processor.
    #[must_use]
    pub fn with_jobs(mut self, jobs: usize) -> Self {
        self.jobs = jobs;
        self
    }

    /// Sets whether to go on after a texture that cannot be made.
    #[must_use]
    pub fn with_keep_going(mut self, keep_going: bool) -> Self {
        self.keep_going = keep_going;
        self
    }

    #[must_use]
    pub fn with_limits(mut self, limits: WasmLimits) -> Self {
        self.limits = limits;
        self
    }

    /// Sets the folder of the browser package.
    #[must_use]
    pub fn with_browser_package(mut self, folder: impl Into<Option<PathBuf>>) -> Self {
        self.browser_package = folder.into();
        self
    }
}

/// A build that is planned, with everything hashed: what is there is known.
#[derive(Debug)]
pub struct Build {
    options: BuildOptions,
    plan: Plan,
    /// A job for each texture, with its key.
    jobs: Vec<(String, Job)>,
    cache: Cache,
    dist: Dist,
    /// Indices of jobs that an earlier build has not done.
    pending: Vec<usize>,
    /// What was made and is not kept for the next build.
    unkept: BTreeMap<String, Made>,
    elsewhere: Arc<Elsewhere>,
    pool: ThreadPool,
    /// Held as long as the build.
    _lock: File,
}

impl Build {
    /// Reads a recipe, finds and hashes its recordings, and compares them with what is in the folder `output`, which is made if it
    /// is not there.
    ///
    /// # Errors
    /// See [`Recipe::open`]; when a glob matches nothing, a template or a pattern fails, a name cannot be one, two recordings of a texture have
    /// different settings; when a file cannot be read, the folder cannot be written, or another build uses it.
    pub fn open(recipe: &Path, output: &Path, options: BuildOptions) -> Result<Self, BuildError> {
        let Prepared {
            recipe,
            folder,
            plan,
            hashes,
            elsewhere,
            kept,
            lock,
        } = Prepared::new(recipe, output)?;
        let pool = ThreadPoolBuilder::new().num_threads(options.jobs).build();
        let pool = pool.at("jobs")?;
        let job = |texture: &PlannedTexture| {
            let plugins = &recipe.library.plugins;
            let job = Job::new(texture, &folder, plugins, &options.program, &hashes)?;
            Ok((job.key(), job))
        };
        let jobs: Result<Vec<_>, BuildError> =
            pool.install(|| plan.textures.par_iter().map(job).collect());
        let jobs = jobs?;
        let dist = Dist::new(output);
        dist.put(&kept.join(HASHES), &hashes.to_keep())?;
        let cache = Cache::open(&kept.join("made"))?;
        let is_pending = |i: &usize| cache.get(&jobs[*i].0).is_none();
        let pending = pool.install(|| (0..jobs.len()).into_par_iter().filter(is_pending).collect());
        Ok(Self {
            options,
            plan,
            jobs,
            cache,
            dist,
            pending,
            unkept: BTreeMap::new(),
            elsewhere,
            pool,
            _lock: lock,
        })
    }

    /// Returns the textures that the recipe asks for.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns the jobs that are to be done, by key.
    pub fn pending(&self) -> impl ExactSizeIterator<Item = (&str, &Job)> {
        let jobs = self.pending.iter().map(|i| &self.jobs[*i]);
        jobs.map(|(key, job)| (&key[..], job))
    }

    /// Keeps what a job made elsewhere ([`Made::to_bytes`]).
    ///
    /// # Errors
    /// When the bytes are not those of a job with this key, or cannot be written; when the texture cannot be made, unless the build
    /// keeps going.
    pub fn store(&mut self, key: &str, bytes: &[u8]) -> Result<(), BuildError> {
        let Some(at) = self.pending.iter().position(|i| self.jobs[*i].0 == key) else {
            // Somebody else did the job, too.
            return Ok(());
        };
        let made = Made::from_bytes(key, bytes)?;
        let refused = self.keep(key, &self.jobs[self.pending[at]].1, made)?;
        self.unkept
            .extend(refused.map(|made| (key.to_owned(), made)));
        self.pending.remove(at);
        Ok(())
    }

    /// Does the pending jobs, several at a time; calls `done` after each, from any thread.
    ///
    /// # Errors
    /// When a texture cannot be made, unless the build keeps going; when a file cannot be read or written. What was made by then
    /// is kept.
    pub fn run(&mut self, done: &(dyn Fn(&Job) + Sync)) -> Result<(), BuildError> {
        let next = AtomicUsize::new(0);
        let stopped = AtomicBool::new(false);
        let ended = Mutex::new((BTreeMap::new(), None));
        let work = |_: rayon::BroadcastContext<'_>| {
            let mut workbench = Workbench::new(self.options.limits.clone());
            workbench.elsewhere = self.elsewhere.clone();
            while !stopped.load(Ordering::Relaxed) {
                let Some(i) = self.pending.get(next.fetch_add(1, Ordering::Relaxed)) else {
                    return;
                };
                let (key, job) = &self.jobs[*i];
                let made = self.make(key, job, &mut workbench);
                let mut ended = ended.lock().unwrap_or_else(PoisonError::into_inner);
                match made {
                    Ok(Some(refused)) => drop(ended.0.insert(key.clone(), refused)),
                    Ok(None) => {}
                    Err(error) => {
                        ended.1.get_or_insert(error);
                        stopped.store(true, Ordering::Relaxed);
                    }
                }
                drop(ended);
                done(job);
            }
        };
        self.pool.broadcast(work);
        let (refused, error) = ended.into_inner().unwrap_or_else(PoisonError::into_inner);
        if let Some(error) = error {
            return Err(error);
        }
        self.unkept.extend(refused);
        self.pending.clear();
        Ok(())
    }

    /// Does a job and keeps what it makes; returns what is not kept.
    fn make(
        &self,
        key: &str,
        job: &Job,
        workbench: &mut Workbench,
    ) -> Result<Option<Made>, BuildError> {
        let made = match job.run(workbench) {
            Err(
                error @ BuildError::File(FileError {
                    is_output: false, ..
                }),
            ) if self.options.keep_going => Made::refused(Outcome::Refused(error.to_string())),
            made => made?,
        };
        self.keep(key, job, made)
    }

    /// Keeps what a job made; returns what is not kept.
    fn keep(&self, key: &str, job: &Job, made: Made) -> Result<Option<Made>, BuildError> {
        let Outcome::Refused(problem) = &made.record.outcome else {
            self.cache.put(key, &made)?;
            return Ok(None);
        };
        if self.options.keep_going {
            return Ok(Some(made));
        }
        Err(BuildError::at(&job.texture, problem))
    }

    /// Writes the library, the textures, the report and the catalogue.
    ///
    /// # Errors
    /// When jobs are still pending, or a file cannot be written.
    pub fn finish(self) -> Result<Built, BuildError> {
        if let Some(i) = self.pending.first() {
            let problem = "it is not fitted yet; run the build again";
            return Err(BuildError::at(&self.jobs[*i].1.texture, problem));
        }
        let made = |key: &str| match self.unkept.get(key) {
            Some(made) => Some(made.clone()),
            None => self.cache.get(key),
        };
        let assemble = || assemble(&self.plan, &self.jobs, &made, &self.dist, &self.options);
        let built = self.pool.install(assemble)?;
        let keys: BTreeSet<&str> = self.jobs.iter().map(|(key, _)| &key[..]).collect();
        self.cache.keep(&keys)?;
        self.elsewhere.forget()?;
        Ok(built)
    }
}

/// Returns the files of a recipe whose contents a build would have to read to know their hashes, so that others can read them:
/// [`hash_file`] and [`remember`].
///
/// # Errors
/// As [`Build::open`].
pub fn unhashed(recipe: &Path, output: &Path) -> Result<Vec<PathBuf>, BuildError> {
    let prepared = Prepared::new(recipe, output)?;
    let textures = prepared
        .plan
        .textures
        .iter()
        .flat_map(PlannedTexture::files);
    let files = textures.chain(&prepared.recipe.library.plugins);
    let files: BTreeSet<PathBuf> = files.map(|file| joined(&prepared.folder, file)).collect();
    let unknown = files
        .into_iter()
        .filter(|file| !prepared.hashes.is_known(file));
    Ok(unknown.collect())
}

/// Hashes a file, of this machine or by URI.
///
/// # Errors
/// When it cannot be read, or changes meanwhile.
pub fn hash_file(file: &Path) -> Result<Hashed, BuildError> {
    hash(file, &Elsewhere::temporary())
}

/// Keeps hashes of files for the next build. A file whose size or times are others there is read again.
///
/// # Errors
/// When another build uses the folder, or it cannot be written.
pub fn remember(
    output: &Path,
    hashed: impl IntoIterator<Item = (PathBuf, Hashed)>,
) -> Result<(), BuildError> {
    let (kept, _lock) = claim(output)?;
    let hashes = Hashes::open(&kept.join(HASHES), Arc::new(Elsewhere::temporary()));
    hashes.add(hashed);
    Dist::new(output).put(&kept.join(HASHES), &hashes.to_keep())
}

/// A recipe with its plan and the hashes that are known.
struct Prepared {
    recipe: Recipe,
    folder: PathBuf,
    plan: Plan,
    hashes: Hashes,
    elsewhere: Arc<Elsewhere>,
    /// Folder of what is kept, and its lock.
    kept: PathBuf,
    lock: File,
}

impl Prepared {
    fn new(recipe: &Path, output: &Path) -> Result<Self, BuildError> {
        let parsed = Recipe::open(recipe)?;
        let (kept, lock) = claim(output)?;
        let folder = folder_of(recipe);
        let elsewhere = Arc::new(Elsewhere::with_copies(kept.join(COPIES)));
        Ok(Self {
            plan: Plan::new(&parsed, &folder, output, &elsewhere)?,
            recipe: parsed,
            hashes: Hashes::open(&kept.join(HASHES), elsewhere.clone()),
            elsewhere,
            folder,
            kept,
            lock,
        })
    }
}

/// Makes the folder of the results, and returns its folder of what is kept, locked for this build.
fn claim(output: &Path) -> Result<(PathBuf, File), BuildError> {
    let kept = output.join(KEPT);
    std::fs::create_dir_all(&kept).writing(&kept)?;
    let file = kept.join("lock");
    let lock = File::create(&file).writing(&file)?;
    match lock.try_lock() {
        Ok(()) => Ok((kept, lock)),
        Err(std::fs::TryLockError::WouldBlock) => Err(BuildError::Locked {
            folder: output.to_owned(),
        }),
        Err(std::fs::TryLockError::Error(error)) => Err(FileError::writing(&file, error).into()),
    }
}
