use std::path::{Path, PathBuf};

use clap::Args;
use htex_base::files::{AtFile, Batch, OwnFolder};
use htex_format::library::{Entry, LibraryError, Names};

use super::{LibraryArg, check_free};
use crate::failure::{Exit, Failure, Result, for_file};
use crate::output::{print, shown};
use crate::progress::bar;

/// Write the textures of a library to a folder, each as a file NAME.htex.
///
/// Without --force, the command fails if one of the files exists already, and leaves that file
/// unchanged.
#[derive(Args)]
pub(crate) struct Unpack {
    /// Path or URI of the library
    #[arg(value_parser = LibraryArg::parser())]
    library: LibraryArg,

    /// Names of the textures to write [default: all]
    names: Vec<String>,

    /// Folder to write to; created if it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,

    /// Overwrite existing files
    #[arg(long)]
    force: bool,
}

/// Number of textures that are requested together. This number bounds the memory for their entries.
const BATCH: usize = 4096;

/// Why the textures are not read to the end.
enum Stop {
    Read(LibraryError),
    Write(Failure),
}

impl From<LibraryError> for Stop {
    fn from(error: LibraryError) -> Self {
        Self::Read(error)
    }
}

impl Unpack {
    pub(crate) fn run(self) -> Result {
        let file = self.library.shown();
        let _waiting = self.library.waiting()?;
        let library = self.library.open()?;
        let count = if self.names.is_empty() { library.len() } else { self.names.len() as u64 };
        let bar = bar(count);
        // The index states all sizes and names, so the limits are checked before anything is
        // written.
        let (mut ratio, mut names) = (library.ratio(), Names::default());
        if self.names.is_empty() {
            for entry in library.entries() {
                let entry = entry.map_err(for_file(&file))?;
                ratio.add(&entry).map_err(for_file(&file))?;
                check_alike(&mut names, &entry.name)?;
            }
        }
        for name in &self.names {
            check_alike(&mut names, name)?;
        }
        let mut batch = Batch::default();
        let at_once = self.library.reads_at_once();
        let mut write = |entries: &[Entry]| {
            let written = library.read_many(entries, at_once, |entry, bytes| {
                bar.inc(1);
                self.write(&mut batch, &entry.name, &bytes).map_err(Stop::Write)
            });
            written.map_err(|stop| match stop {
                Stop::Read(error) => for_file(&file)(error),
                Stop::Write(failure) => failure,
            })
        };
        if self.names.is_empty() {
            let mut entries = library.entries().peekable();
            while entries.peek().is_some() {
                let some: Result<Vec<Entry>, LibraryError> = entries.by_ref().take(BATCH).collect();
                write(&some.map_err(for_file(&file))?)?;
            }
        } else {
            write(&library.entries_of(&self.names, at_once).map_err(for_file(&file))?)?;
        }
        // If an error occurred before this line, the files that are not in their final places yet
        // are removed.
        batch.finish().writing(&self.output)?;
        bar.finish_and_clear();
        print(&format!("{}: {count} files\n", shown(&self.output)))?;
        Ok(Exit::SUCCESS)
    }

    /// Writes a texture. The reader of the library has checked the texture's name, so the file is
    /// inside the folder. Links in the folder are not followed.
    fn write(&self, batch: &mut Batch, name: &str, bytes: &[u8]) -> Result<()> {
        let (own, inside) = (OwnFolder::new(&self.output), PathBuf::from(format!("{name}.htex")));
        let path = self.output.join(&inside);
        check_free(&path, self.force)?;
        Ok(own.write_with(batch, &inside, bytes).writing(&path)?)
    }
}

/// Refuses a name that would be the same file as an earlier name on some system (e.g. because only
/// the case differs), so that neither texture is lost.
fn check_alike(names: &mut Names, name: &str) -> Result<()> {
    if names.insert(name) {
        Ok(())
    } else {
        Err(Failure::Other(format!(
            "{}: some systems take its file for the file of another texture of this library; unpack one of them by its name, or rename it",
            shown(Path::new(name))
        )))
    }
}
