//! Builds a checked library of textures from recordings, as described by a recipe.
//!
//! A recording may also be a file of another haptic format: a signal, which is fitted, or a file
//! that states its texture, which is used unchanged (`imports`).
//!
//! A recipe is data, and it determines the build. The key of a texture is the hash of everything
//! its bytes depend on: the contents of its recordings, its settings, the program and the plugins.
//! What has been made for a key is stored. So the same mechanism continues after a kill, builds
//! only what changed, and builds on many machines ([`Build::pending`], [`Job::run`],
//! [`Build::store`]).
//!
//! From recordings to a library:
//!
//! 1. `recipe`, `plan`: a recipe becomes textures, each with its recordings and settings. The
//!    settings are the same as in the command and in Python.
//! 2. `hashes`, `job`: a texture becomes a job, which is data with a key.
//! 3. `cache`: either the result for a key is stored, or the job is pending. Threads or a cluster
//!    (`htex.dask`) do the pending jobs.
//! 4. `assemble`: only from the stored results, applies the gates and writes textures, library,
//!    report and catalogue.
//!
//! ```no_run
//! use htex_build::{Build, BuildOptions};
//!
//! let options = BuildOptions { keep_going: true, ..BuildOptions::new("my-pipeline 1.0") };
//! let mut build = Build::open("library.toml".as_ref(), "dist".as_ref(), options)?;
//! println!("{} of {} textures to fit", build.pending().len(), build.plan().textures.len());
//! build.run(&|job| println!("{}", job.texture))?;
//! let report = build.finish()?;
//! println!("{} textures", report.library.textures);
//! # Ok::<(), htex_build::BuildError>(())
//! ```
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod assemble;
mod cache;
mod catalogue;
mod dist;
mod error;
mod failed;
mod findings;
mod gates;
mod globs;
mod hashes;
mod imports;
mod inputs;
mod job;
mod job_result;
mod keys;
mod library_build;
mod making;
mod plan;
mod publish;
mod reasons;
mod recipe;
mod remote;
mod removed;
mod report;
mod rules;
mod sound;
mod state;
mod template;
mod thumbnail;

pub use error::BuildError;
pub use failed::report_failure;
pub use findings::{FindingReport, FindingShare};
pub use hashes::{FileHash, Stamp};
pub use imports::FileKind;
pub use job::{Job, JobFile, JobRecording, Workbench};
pub use job_result::{JobResult, Outcome, Record};
pub use library_build::{Build, BuildOptions, check, hash_file, remember, unhashed};
pub use plan::{Plan, PlannedRecording, PlannedTexture};
pub use publish::Destination;
pub use reasons::Why;
pub use recipe::{
    At, Gates, LibraryPart, ModelGate, NumberOrTemplate, Override, Recipe, Settings, Textures,
};
pub use removed::named_briefly;
pub use report::{
    AssetReport, LibraryReport, MissedGate, REPORT, RecordingReport, Report, Status, TextureReport,
    recipe_schema, report_schema,
};
pub use rules::{RECIPE_INVALID, RULES};
pub use thumbnail::Thumbnail;
