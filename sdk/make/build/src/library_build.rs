//! A build. It plans the textures, fits the textures without a stored result, and assembles the
//! library.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use htex_base::files::FileProblem;
use htex_base::storage::{Location, StorageProblem};
use htex_host::WasmLimits;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::BuildError;
use crate::assemble::assemble;
use crate::cache::Cache;
use crate::dist::Dist;
use crate::error::at_place;
use crate::failed::put_failure;
use crate::hashes::{FileHash, Hashes, hash};
use crate::inputs::Missing;
use crate::job::{Job, NamedPlugins, Workbench};
use crate::job_result::{JobResult, Outcome};
use crate::plan::{Plan, PlannedTexture};
use crate::reasons::{Reasons, Why};
use crate::recipe::Recipe;
use crate::remote::{RemoteFiles, folder_of, is_remote, joined, remote_location};
use crate::removed::textures_before;
use crate::report::Report;
use crate::state::StateFolder;

/// File of hashes, in the folder of stored data.
const HASHES: &str = "files.json";

/// Options of a build.
#[derive(Debug, Clone)]
pub struct BuildOptions {
    /// Number of textures that are fitted at the same time; 0 means one for each processor.
    pub jobs: usize,
    /// Whether the build continues if a texture cannot be made. The texture is then left out.
    pub keep_going: bool,
    pub limits: WasmLimits,
    /// Program and version, for the assets' provenance. Textures that another program or version
    /// has fitted are fitted again.
    pub program: String,
    /// Folder of the browser package with which the catalogue plays textures. If `None`, the
    /// catalogue plays short sounds that the build renders.
    pub browser_package: Option<PathBuf>,
    /// Plugins that the user names. A plugin is a WASM module or a native library. Native libraries
    /// run with all rights of this program. A recipe can name only WASM modules.
    pub plugins: Vec<PathBuf>,
    /// Whether the build fails if it would remove textures of the previous library.
    pub no_removals: bool,
    /// The URI to which the results are copied. If there is no previous library on this machine,
    /// the build looks for removed textures in the library at this URI.
    pub published: Option<Location>,
    /// Whether to remove a stored result as soon as no texture uses it. If false, unused results
    /// stay for 30 days.
    pub prune: bool,
}

impl BuildOptions {
    /// Creates options for a program, given by its name and version.
    pub fn new(program: impl Into<String>) -> Self {
        Self {
            jobs: 0,
            keep_going: false,
            limits: WasmLimits::default(),
            program: program.into(),
            browser_package: None,
            plugins: Vec::new(),
            no_removals: false,
            published: None,
            prune: false,
        }
    }

    /// Returns the largest number of textures that the library may lose.
    pub(crate) fn most_removed(&self, plan: &Plan) -> usize {
        if self.no_removals { 0 } else { plan.max_removed.unwrap_or(usize::MAX) }
    }

    fn missing(&self) -> Missing {
        if self.keep_going { Missing::LeftOut } else { Missing::Error }
    }
}

/// A planned build. All files are hashed, so the build knows which textures already have results.
#[derive(Debug)]
pub struct Build {
    options: BuildOptions,
    plan: Plan,
    /// The job of each texture with its key.
    jobs: Vec<(String, Job)>,
    cache: Cache,
    dist: Dist,
    kept: Arc<StateFolder>,
    /// Names of the textures in the library before this build.
    before: BTreeSet<String>,
    /// Indices of the jobs that no earlier build has done.
    pending: Vec<usize>,
    /// Keys of the textures with a file that cannot be read.
    unreadable: BTreeSet<String>,
    /// Textures that an earlier build could not make from the same recordings with the same
    /// settings, and the reason for each texture.
    failed_before: Vec<(String, String)>,
    /// Results that are not stored for the next build.
    unkept: BTreeMap<String, JobResult>,
    remote: Arc<RemoteFiles>,
    pool: ThreadPool,
    /// Held as long as the build exists.
    _lock: File,
}

impl Build {
    /// Reads a recipe, finds and hashes its recordings, and looks up the stored results in the
    /// folder `output`. The folder is created if it is missing.
    ///
    /// # Errors
    /// - Returns the errors of [`Recipe::open`].
    /// - A glob matches nothing, a template or a pattern fails, a name is not valid, or two
    ///   recordings of a texture have different settings.
    /// - The library would lose textures and the options forbid removals.
    /// - A file cannot be read, or the folder cannot be written or is in use by another build.
    pub fn open(recipe: &Path, output: &Path, options: BuildOptions) -> Result<Self, BuildError> {
        let RecipeInputs { named, plan, hashes, remote, kept, lock } =
            RecipeInputs::new(recipe, output, &options.plugins, options.missing())?;
        let dist = Dist::new(output);
        let before = textures_before(&dist, &plan.library, options.published.as_ref());
        // The build is refused before it hashes the files, because hashing may take long.
        BuildError::refuse_removals(plan.removed(&before), options.most_removed(&plan))?;
        let pool =
            ThreadPoolBuilder::new().num_threads(options.jobs).build().map_err(at_place("jobs"))?;
        let job =
            |texture: &PlannedTexture| match Job::new(texture, &named, &options.program, &hashes) {
                Err(error) if options.keep_going && is_of_input(&error) => {
                    let (key, job) = Job::absent(texture, &named, &options.program, &hashes)?;
                    let refused = JobResult::refused(Outcome::Refused(error.to_string()));
                    Ok((key, job, Some(refused)))
                }
                job => job.map(|job| (job.key(), job, None)),
            };
        let made: Result<Vec<_>, BuildError> =
            pool.install(|| plan.textures.par_iter().map(job).collect());
        let (mut jobs, mut unkept) = (Vec::new(), BTreeMap::new());
        for (key, job, refused) in made? {
            unkept.extend(refused.map(|refused| (key.clone(), refused)));
            jobs.push((key, job));
        }
        // Stored at once, so that a killed build need not hash the files again.
        kept.put(HASHES, &hashes.to_keep())?;
        let cache = Cache::open(kept.clone())?;
        let failed_before = Mutex::new(Vec::new());
        let is_pending = |i: &usize| {
            let (key, job) = &jobs[*i];
            if unkept.contains_key(key) {
                return false;
            }
            let Some(made) = cache.get(key) else { return true };
            if let Outcome::Refused(problem) = made.record.outcome {
                let mut failed = failed_before.lock().unwrap_or_else(PoisonError::into_inner);
                failed.push((job.texture.clone(), problem));
            }
            false
        };
        let mut pending: Vec<usize> =
            pool.install(|| (0..jobs.len()).into_par_iter().filter(is_pending).collect());
        let mut failed_before: Vec<_> =
            failed_before.into_inner().unwrap_or_else(PoisonError::into_inner);
        failed_before.sort();
        // Textures with the same recordings and settings need only one fit.
        let mut keys = BTreeSet::new();
        pending.retain(|i| keys.insert(&jobs[*i].0));
        Ok(Self {
            options,
            plan,
            jobs,
            cache,
            dist,
            kept,
            before,
            pending,
            unreadable: unkept.keys().cloned().collect(),
            failed_before,
            unkept,
            remote,
            pool,
            _lock: lock,
        })
    }

    /// Checks the settings before any fit. The plugins must load, the settings must belong to
    /// existing models, and the gates must name models that are fitted.
    ///
    /// # Errors
    /// Returns the first problem, with its place in the recipe.
    pub fn check(&self) -> Result<(), BuildError> {
        let mut workbench = self.workbench();
        let mut checked = BTreeSet::new();
        for ((_, job), texture) in self.jobs.iter().zip(&self.plan.textures) {
            if checked.insert(job.checked_by(&texture.gates)) {
                job.check(&texture.gates, &mut workbench)?;
            }
        }
        Ok(())
    }

    /// Returns the reason why each pending job has to run, with the name of its texture.
    pub fn reasons(&self) -> Vec<(&str, Why)> {
        let before = Reasons::open(&self.kept);
        let pending = self.pending.iter().map(|i| &self.jobs[*i]);
        let why = pending.map(|(key, job)| (&job.texture[..], before.why(job, key, &self.cache)));
        why.collect()
    }

    fn workbench(&self) -> Workbench {
        let mut workbench = Workbench::new(self.options.limits.clone());
        workbench.remote = self.remote.clone();
        workbench
    }

    /// Returns the names of textures that were in the library before this build but are no longer
    /// in the recipe.
    pub fn removed(&self) -> Vec<String> {
        self.plan.removed(&self.before)
    }

    /// Returns the planned textures.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns how many textures are left out because one of their recordings or trackers cannot be
    /// read.
    pub fn unreadable(&self) -> usize {
        let keys = self.jobs.iter().map(|(key, _)| key);
        keys.filter(|key| self.unreadable.contains(*key)).count()
    }

    /// Returns the pending jobs, by key.
    pub fn pending(&self) -> impl ExactSizeIterator<Item = (&str, &Job)> {
        let jobs = self.pending.iter().map(|i| &self.jobs[*i]);
        jobs.map(|(key, job)| (&key[..], job))
    }

    /// Stores the result of a job that ran elsewhere ([`JobResult::to_bytes`]).
    ///
    /// # Errors
    /// - The bytes are not the result of the job with this key.
    /// - The result cannot be written.
    /// - The texture cannot be made, and [`BuildOptions::keep_going`] is false.
    pub fn store(&mut self, key: &str, bytes: &[u8]) -> Result<(), BuildError> {
        let Some(at) = self.pending.iter().position(|i| self.jobs[*i].0 == key) else {
            // Somebody else has already done the job.
            return Ok(());
        };
        let made = JobResult::from_bytes(key, bytes)?;
        let refused = self.keep(key, &self.jobs[self.pending[at]].1, made)?;
        self.unkept.extend(refused.map(|made| (key.to_owned(), made)));
        self.pending.remove(at);
        Ok(())
    }

    /// Runs the pending jobs, several at a time. Calls `done` after each job, from any thread.
    ///
    /// # Errors
    /// Returns an error if a file cannot be read or written. Also returns an error if a texture
    /// cannot be made and [`BuildOptions::keep_going`] is false. Results that were finished before
    /// the error are stored.
    pub fn run(&mut self, done: &(dyn Fn(&Job) + Sync)) -> Result<(), BuildError> {
        if let (Some((texture, problem)), false) =
            (self.failed_before.first(), self.options.keep_going)
        {
            return Err(BuildError::at_place(texture, problem));
        }
        let next = AtomicUsize::new(0);
        let stopped = AtomicBool::new(false);
        let ended = Mutex::new((BTreeMap::new(), None));
        let work = |_: rayon::BroadcastContext<'_>| {
            // Each thread has its own workbench, which loads the models once.
            let mut workbench = self.workbench();
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
                // The caller's function `done` may take long, so the lock is released before the
                // call.
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

    /// Runs a job and stores its result. If the result cannot be reused by the next build, returns
    /// it instead.
    fn make(
        &self,
        key: &str,
        job: &Job,
        workbench: &mut Workbench,
    ) -> Result<Option<JobResult>, BuildError> {
        match job.run(workbench) {
            // The file may be there the next time.
            Err(error) if self.options.keep_going && is_of_input(&error) => {
                Ok(Some(JobResult::refused(Outcome::Refused(error.to_string()))))
            }
            made => self.keep(key, job, made?),
        }
    }

    /// Stores the result of a job. If the result cannot be reused by the next build, returns it
    /// instead. If a texture cannot be made from its recordings, the next build cannot make it
    /// either. The exception is a texture with a plugin, because the plugin may have had too little
    /// time or memory.
    fn keep(&self, key: &str, job: &Job, made: JobResult) -> Result<Option<JobResult>, BuildError> {
        let Outcome::Refused(problem) = &made.record.outcome else {
            self.cache.put(key, &made)?;
            return Ok(None);
        };
        let is_final = job.plugins.is_empty();
        if is_final {
            self.cache.put(key, &made)?;
        }
        if self.options.keep_going {
            return Ok(Some(made).filter(|_| !is_final));
        }
        Err(BuildError::at_place(&job.texture, problem))
    }

    /// Writes an error, line by line, into the report in this build's folder. The other contents of
    /// the report stay as an earlier build wrote them.
    ///
    /// # Errors
    /// Returns an error if the report cannot be written.
    pub fn report_failure(&self, error: &[String]) -> Result<(), BuildError> {
        put_failure(&self.dist, &self.options.program, error)
    }

    /// Writes the library, the textures, the report and the catalogue. Returns the report.
    ///
    /// # Errors
    /// Returns an error if jobs are still pending, or if a file cannot be written. Also returns an
    /// error if a texture of the previous library is left out although the options forbid removals.
    /// In this case, no file is written.
    pub fn finish(self) -> Result<Report, BuildError> {
        if let Some(i) = self.pending.first() {
            let problem = "it is not fitted yet; run the build again";
            return Err(BuildError::at_place(&self.jobs[*i].1.texture, problem));
        }
        let made = |key: &str| match self.unkept.get(key) {
            Some(made) => Some(made.clone()),
            None => self.cache.get(key),
        };
        let put = (&self.dist, &*self.kept);
        let assemble = || assemble(&self.plan, &self.jobs, &made, put, &self.options, &self.before);
        let built = self.pool.install(assemble)?;
        let keys: BTreeSet<&str> = self.jobs.iter().map(|(key, _)| &key[..]).collect();
        // The cache is cleaned only after everything is written, so that a failed build loses no
        // result.
        self.cache.keep(&keys, self.options.prune)?;
        Reasons::new(self.jobs.iter().map(|(_, job)| job)).keep(&self.kept)?;
        self.remote.forget()?;
        Ok(built)
    }
}

/// Returns whether an input file caused the error because it is missing or cannot be read.
fn is_of_input(error: &BuildError) -> bool {
    match error {
        BuildError::File(error) => !matches!(error.problem, FileProblem::Write(_)),
        BuildError::Storage(error) => matches!(error.problem, StorageProblem::Missing),
        _ => false,
    }
}

/// Returns those files of a recipe for which no hash is stored. A build would have to read these
/// files. Other processes can hash the files in advance with [`hash_file`] and store the hashes
/// with [`remember`].
///
/// # Errors
/// Returns the errors of [`Build::open`].
pub fn unhashed(recipe: &Path, output: &Path) -> Result<Vec<PathBuf>, BuildError> {
    // Missing files are not an error here, because the following build reports them.
    let prepared = RecipeInputs::new(recipe, output, &[], Missing::LeftOut)?;
    let textures = prepared.plan.textures.iter();
    let files = textures.flat_map(PlannedTexture::files).chain(&prepared.named.of_recipe);
    let folder = &prepared.named.folder;
    let files: BTreeSet<PathBuf> = files.map(|file| joined(folder, file)).collect();
    let unknown = files
        .into_iter()
        .filter(|file| !prepared.hashes.is_known(file))
        .filter(|file| is_remote(file) || file.exists());
    Ok(unknown.collect())
}

/// Checks a recipe without a build, and returns the planned textures. Checks the recipe's keys,
/// options and gates, whether its recordings exist, and whether its plugins can be loaded. Writes
/// nothing.
///
/// # Errors
/// What is wrong, and where.
pub fn check(recipe: &Path, options: &BuildOptions) -> Result<Plan, BuildError> {
    let parsed = Recipe::open(recipe)?;
    let folder = folder_of(recipe);
    let origin = remote_location(recipe)?;
    let remote = Arc::new(RemoteFiles::temporary(origin.clone()));
    // There is no folder of results.
    let plan = Plan::new(&parsed, &folder, Path::new(""), &remote, Missing::Error)?;
    let named = NamedPlugins::new(&options.plugins, parsed.library.plugins, folder, origin)?;
    let hashes = Hashes::new(remote.clone());
    let mut workbench = Workbench::new(options.limits.clone());
    workbench.remote = remote;
    let mut checked = BTreeSet::new();
    for texture in &plan.textures {
        for file in texture.recordings.iter().map(|recording| &recording.file) {
            hashes.check(&joined(&named.folder, file))?;
        }
        // Its recordings are not read.
        let without = PlannedTexture { recordings: Vec::new(), ..texture.clone() };
        let job = Job::new(&without, &named, &options.program, &hashes)?;
        if checked.insert(job.checked_by(&texture.gates)) {
            job.check(&texture.gates, &mut workbench)?;
        }
    }
    Ok(plan)
}

/// Hashes a local or remote file of a recipe.
///
/// # Errors
/// Returns an error if the file cannot be read, if it changes while it is read, or if the recipe is
/// not allowed to name the file's address.
pub fn hash_file(recipe: &Path, file: &Path) -> Result<FileHash, BuildError> {
    hash(file, &RemoteFiles::temporary(remote_location(recipe)?))
}

/// Stores hashes of files for the next build. If the size or times of a file have changed by then,
/// the next build reads the file again.
///
/// # Errors
/// Returns an error if the folder cannot be written, or is in use by another build.
pub fn remember(
    output: &Path,
    hashed: impl IntoIterator<Item = (PathBuf, FileHash)>,
) -> Result<(), BuildError> {
    let kept = StateFolder::new(output)?;
    let _lock = kept.claim()?;
    let hashes = Hashes::open(&kept, HASHES, Arc::new(RemoteFiles::temporary(None)));
    hashes.add(hashed);
    kept.put(HASHES, &hashes.to_keep())
}

/// A recipe with its plan and the known hashes.
struct RecipeInputs {
    named: NamedPlugins,
    plan: Plan,
    hashes: Hashes,
    remote: Arc<RemoteFiles>,
    kept: Arc<StateFolder>,
    lock: File,
}

impl RecipeInputs {
    fn new(
        recipe: &Path,
        output: &Path,
        plugins: &[PathBuf],
        missing: Missing,
    ) -> Result<Self, BuildError> {
        let parsed = Recipe::open(recipe)?;
        let kept = Arc::new(StateFolder::new(output)?);
        let lock = kept.claim()?;
        let folder = folder_of(recipe);
        let origin = remote_location(recipe)?;
        let remote = Arc::new(RemoteFiles::with_copies(kept.own().clone(), origin.clone()));
        let plan = Plan::new(&parsed, &folder, output, &remote, missing)?;
        Ok(Self {
            named: NamedPlugins::new(plugins, parsed.library.plugins, folder, origin)?,
            plan,
            hashes: Hashes::open(&kept, HASHES, remote.clone()),
            remote,
            kept,
            lock,
        })
    }
}
