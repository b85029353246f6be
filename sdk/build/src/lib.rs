//! Recipes: recordings in, a checked library of textures out.
//!
//! A recording may also be a file of another haptic format: a signal, which is fitted, or a file
//! that states its texture, which is taken as it is (`imports`).
//!
//! A recipe is data, a build is a function of it. The key of a texture is the hash of everything
//! its bytes depend on: the contents of its recordings, its settings, the program and the plugins.
//! What has been made for a key is kept, so that going on after a kill, building only what changed
//! and building on many machines ([`Build::pending`], [`Job::run`], [`Build::store`]) are one
//! mechanism.
//!
//! From recordings to a library:
//!
//! 1. `recipe`, `plan`: a recipe becomes textures, each with its recordings and settings, which are
//!    those of the command and of Python.
//! 2. `hashes`, `job`: a texture becomes a job, data with a key.
//! 3. `cache`: what was made for a key is there, or the job is pending. Threads, or a cluster
//!    (`htex.dask`), do the pending jobs.
//! 4. `assemble`: gates, textures, the library, report and catalogue, from what was made alone.
//!
//! ```no_run
//! use htex_build::{Build, BuildOptions};
//!
//! let options = BuildOptions::new("my-pipeline 1.0").with_keep_going(true);
//! let mut build = Build::open("library.toml".as_ref(), "dist".as_ref(), options)?;
//! println!("{} of {} textures to fit", build.pending().len(), build.plan().textures.len());
//! build.run(&|job| println!("{}", job.texture))?;
//! let built = build.finish()?;
//! println!("{} textures", built.report.library.textures);
//! # Ok::<(), htex_build::BuildError>(())
//! ```
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod assemble;
mod cache;
mod catalogue;
mod dist;
mod elsewhere;
mod error;
mod failed;
mod findings;
mod gates;
mod globs;
mod hashes;
mod imports;
mod inputs;
mod job;
mod kept;
mod keys;
mod library_build;
mod made;
mod making;
mod plan;
mod publish;
mod reasons;
mod recipe;
mod removed;
mod report;
mod rules;
mod sound;
mod template;
mod thumbnail;

pub use assemble::Built;
pub use error::BuildError;
pub use failed::report_failure;
pub use findings::{FindingReport, FindingShare};
pub use hashes::{Hashed, Stamp};
pub use imports::FileKind;
pub use job::{Job, JobFile, JobRecording, Workbench};
pub use library_build::{Build, BuildOptions, check, hash_file, remember, unhashed};
pub use made::{Made, Outcome, Record};
pub use plan::{Plan, PlannedRecording, PlannedTexture};
pub use publish::Destination;
pub use reasons::Why;
pub use recipe::{
    At, Gates, LibraryPart, ModelGate, NumberOrTemplate, Override, Recipe, Settings, Textures,
};
pub use removed::named_briefly;
pub use report::{
    AssetReport, LibraryReport, Missed, REPORT, RecordingReport, Report, Status, TextureReport,
    recipe_schema, report_schema,
};
pub use rules::{RECIPE_INVALID, RULES};
pub use thumbnail::Thumbnail;
