//! Arguments for finding sources, shared by several commands.

#[cfg(feature = "lab")]
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use htex_check::device::Subject;
#[cfg(feature = "lab")]
use htex_device::Source;
use htex_device::{KnownSource, SourceAdapter, Sources};
use serde_json::Value;

use crate::adapters;
use crate::devices::left_out;
use crate::failure::Failure;

/// Returns the sources of this program in display order: recordings first, then the built-in ones.
fn builtin() -> Vec<Arc<dyn SourceAdapter>> {
    let recordings: Vec<Arc<dyn SourceAdapter>> = vec![
        #[cfg(feature = "lab")]
        Arc::new(htex_lab::record::Replay),
    ];
    recordings.into_iter().chain(htex_device_builtin::sources()).collect()
}

/// Where to search for sources.
#[derive(Args, Default)]
#[command(next_help_heading = "Sources")]
pub(crate) struct SourceArgs {
    /// A source's native library (it runs with all your rights: load only what you trust); may be
    /// given several times
    #[arg(long, value_name = "FILE")]
    source_file: Vec<PathBuf>,

    /// A folder of such libraries, searched before HTEX_SOURCE_PATH and the user's own folder
    #[arg(long, value_name = "DIR")]
    source_dir: Vec<PathBuf>,
}

impl SourceArgs {
    /// Returns the sources that are found. Reports those that shadow others on standard error.
    pub(crate) fn sources(&self) -> Result<Sources, Failure> {
        Ok(adapters::reported(self.sources_quietly()?))
    }

    /// Returns the sources as [`Self::sources`] does, but without reports.
    pub(crate) fn sources_quietly(&self) -> Result<Sources, Failure> {
        let search = adapters::search(&self.source_file, &self.source_dir);
        Ok(Sources::search(builtin(), &search)?)
    }

    /// Opens the source that `NAME:TARGET` names.
    #[cfg(feature = "lab")]
    pub(crate) fn open(
        &self,
        text: &str,
        profile: Option<&str>,
        given: &BTreeMap<String, String>,
    ) -> Result<Box<dyn Source>, Failure> {
        let opened = self.sources()?.open(text, profile, given);
        let name = text.split(':').next().unwrap_or_default();
        opened.map_err(|error| sounding(name, error.into()))
    }

    /// Returns the source in the file of this name if the file exists, else the source with this
    /// short name or id.
    pub(crate) fn named(&self, name: &str) -> Result<KnownSource, Failure> {
        adapters::named(name, || self.sources()).map_err(|error| sounding(name, error))
    }

    /// Returns the source as [`Self::named`] does, but for a checker, which loads a library itself.
    pub(crate) fn subject(&self, name: &str) -> Result<Subject<dyn SourceAdapter>, Failure> {
        adapters::subject(name, || self.sources_quietly())
    }

    /// Returns these arguments for another run of this program.
    pub(crate) fn again(&self) -> Vec<OsString> {
        let files = self.source_file.iter().map(|path| ("--source-file", path));
        let dirs = self.source_dir.iter().map(|path| ("--source-dir", path));
        adapters::again(files.chain(dirs))
    }
}

/// Returns the error, or the reason why this build does not have a source of this name.
fn sounding(name: &str, error: Failure) -> Failure {
    match left_out(name, "`htex device list` shows the sources that it has") {
        Some(why) if error.is_unknown_name() => why.into(),
        _ => error,
    }
}

/// Describes a source with its target, for a list.
pub(crate) fn source_json(known: &KnownSource) -> Value {
    let mut listed = adapters::listed_json(known);
    if let Some(listed) = listed.as_object_mut() {
        listed.insert("target".to_owned(), known.adapter.target().into());
    }
    listed
}
