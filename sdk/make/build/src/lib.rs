//! Builds a checked library of textures from recordings, as described by a recipe.
//!
//! In place of a recording, a recipe may name a file of another haptic format (`imports`). If the
//! file contains a signal, the build fits models to the signal. If the file contains the parameters
//! of a texture, the build converts the file to an asset without a fit.
//!
//! A recipe is data and contains no code. The recipe and the files that it names determine the
//! result of the build. Each texture has a key. The key is the hash of everything that the
//! texture's bytes depend on: the contents of its recordings, its settings, the program and the
//! plugins. Results are stored by key. Because of the stored results, a killed build can continue,
//! a repeated build makes only textures that changed, and many machines can share a build
//! ([`Build::pending`], [`Job::run`], [`Build::store`]).
//!
//! These modules lead from recordings to a library:
//!
//! 1. `recipe` and `plan` read a recipe and list the textures that it describes, each with its
//!    recordings and settings. The command and the Python package have the same settings as a
//!    recipe.
//! 2. `hashes` and `job` turn each texture into a job, which is data with a key.
//! 3. `cache` looks up the key of each job. If no result is stored for the key, the job is pending.
//!    Threads or a cluster (`htex.dask`) run the pending jobs.
//! 4. `assemble` reads only the stored results. It applies the gates, and writes the textures, the
//!    library, the report and the catalogue.
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
mod filter;
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
mod library_edit;
mod library_merge;
mod making;
mod merged_builds;
mod metadata_table;
mod plan;
mod publish;
mod reasons;
mod recipe;
pub mod registry;
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
pub use filter::Filter;
pub use findings::{FindingReport, FindingShare};
pub use hashes::{FileHash, Stamp};
pub use imports::FileKind;
pub use job::{Job, JobFile, JobRecording, Workbench};
pub use job_result::{JobResult, Outcome, Record};
pub use library_build::{Build, BuildOptions, check, hash_file, remember, unhashed};
pub use library_edit::{Addition, EditSummary, LibraryEdit};
pub use library_merge::{LibraryMerge, OnConflict};
pub use merged_builds::BuildsMerge;
pub use metadata_table::metadata_value;
pub use plan::{Plan, PlannedRecording, PlannedTexture};
pub use publish::Destination;
pub use reasons::Why;
pub use recipe::{
    At, Gates, LibraryPart, MissingTextures, ModelGate, NumberOrTemplate, Override, Recipe,
    Settings, Textures,
};
pub use removed::named_briefly;
pub use report::{
    AssetReport, LibraryReport, MissedGate, REPORT, RecordingReport, Report, Status, TextureReport,
    recipe_schema, report_schema,
};
pub use rules::{RECIPE_INVALID, RULES};
pub use thumbnail::Thumbnail;
