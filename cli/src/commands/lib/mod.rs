//! The subcommand `htex lib` for libraries of textures.

mod cat;
#[cfg(feature = "build")]
mod catalogue;
mod diff;
#[cfg(feature = "build")]
mod edit;
#[cfg(feature = "build")]
mod export;
mod find;
mod info;
mod listing;
mod ls;
#[cfg(feature = "build")]
mod merge;
mod pack;
mod unpack;
mod verify;

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use htex_base::storage::{Location, Storage};
use htex_format::library::{Library, LibraryFile, LibraryMetadata};

pub(super) use verify::check;

use super::subcommands;
use crate::failure::{Failure, Result, for_file};
use crate::output::shown;
use crate::progress::Waiting;
#[cfg(feature = "build")]
use crate::signers::{SignerArgs, check_library};

/// Pack, change, list and verify libraries
///
/// A library is one file (.htexlib) that contains any number of textures. Data that several
/// textures have in common is stored once.
///
/// htex reads textures one at a time. If the library is on a network (https://, s3://, gs://,
/// az://), htex downloads only the parts of the file that are needed.
#[derive(Args)]
pub(crate) struct Lib {
    #[command(subcommand)]
    command: Command,
}

subcommands! {
    Command {
        Pack(pack::Pack),
        Edit(edit::Edit) if feature = "build",
        Merge(merge::Merge) if feature = "build",
        Export(export::ExportAll) if feature = "build",
        Catalogue(catalogue::Catalogue) if feature = "build",
        Unpack(unpack::Unpack),
        Info(info::Info),
        Ls(ls::Ls),
        Find(find::Find),
        Cat(cat::Cat),
        Diff(diff::Diff),
        Verify(verify::Verify),
    }
}

impl Lib {
    pub(crate) fn run(self) -> Result {
        self.command.run()
    }
}

/// Changes what a library says about itself, as `--describe` says.
fn described(before: &LibraryMetadata, given: &[String]) -> Result<LibraryMetadata> {
    let mut metadata = before.clone();
    for text in given {
        let wrong = |problem: String| Failure::Usage(format!("--describe {text}: {problem}"));
        let (name, value) =
            text.split_once('=').ok_or_else(|| wrong("give ENTRY=TEXT".to_owned()))?;
        metadata.set(name, value).map_err(wrong)?;
    }
    metadata.check().map_err(|problem| Failure::Usage(format!("--describe: {problem}")))?;
    Ok(metadata)
}

/// Refuses to write a file that exists, unless `force` is given and the file is a regular one.
fn check_free(path: &Path, force: bool) -> Result<()> {
    let problem = match path.symlink_metadata() {
        Err(_) => return Ok(()),
        // Here, a link does not count as a regular file, so nothing is written through a link.
        Ok(is) if force && is.is_file() => return Ok(()),
        Ok(_) if force => "it is there and no regular file; remove it, or give another folder",
        Ok(_) => "it is there already; give another folder, or write over it with --force",
    };
    Err(Failure::Other(format!("{}: {problem}", shown(path))))
}

/// An argument that names a library: a path or a URI. Of a file at a URI, htex reads only the
/// ranges that it needs.
#[derive(Clone, Debug)]
struct LibraryArg(Location);

impl LibraryArg {
    /// Returns the parser of the argument.
    fn parser() -> impl TypedValueParser<Value = Self> {
        OsStringValueParser::new().try_map(|text| Location::parse(&text).map(Self))
    }

    fn open(&self) -> Result<Library<LibraryFile>> {
        let storage = Storage::from_environment()?;
        Library::open_located(&storage, &self.0).map_err(for_file(&self.shown()))
    }

    /// Opens the library, if it is signed as required.
    #[cfg(feature = "build")]
    fn open_signed(&self, signers: &SignerArgs) -> Result<Library<LibraryFile>> {
        let library = self.open()?;
        if let Some(signers) = signers.signers()? {
            check_library(&Storage::from_environment()?, &self.0, &library, &signers)?;
        }
        Ok(library)
    }

    /// If the library is not on this machine, says after two seconds that the command waits for it,
    /// unless the returned value was dropped before.
    fn waiting(&self) -> Result<Option<Waiting>> {
        if self.local().is_some() {
            return Ok(None);
        }
        let longest = Storage::from_environment()?.settings().total;
        Ok(Waiting::for_file(self.0.to_string(), longest))
    }

    /// Returns the file if it is on this machine.
    fn local(&self) -> Option<&Path> {
        self.0.local()
    }

    /// Returns how many reads should run at the same time.
    fn reads_at_once(&self) -> usize {
        if self.local().is_some() { 1 } else { 8 }
    }

    /// Returns the path or URI for messages.
    fn shown(&self) -> PathBuf {
        PathBuf::from(self.0.to_string())
    }
}
