use std::fmt::{Display, Formatter};
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use htex_build::{BuildsMerge, LibraryMerge, LibraryReport, OnConflict};
use htex_format::library::LibraryMetadata;
use serde::Serialize;

use super::described;
use super::pack::PackReport;
use crate::failure::{Failure, Result};
use crate::located;
use crate::output::show;
use crate::outputs::check_outputs;

/// Merge libraries into one, or the results of several builds
///
/// All textures stay the same, byte for byte. The result is the same library that `htex lib pack`
/// would write from all these textures. It is not a conflict if two libraries have the same texture
/// under the same name.
///
/// If you give folders that `htex build` wrote, the command merges the libraries, textures, sounds,
/// reports and pages of all these folders into one folder. In this way, several machines can each
/// build a part of a library.
#[derive(Args)]
pub(crate) struct Merge {
    /// The libraries, or the folders of the builds
    #[arg(required = true, num_args = 1.., value_name = "LIBRARY|DIR", value_parser = located::RECORDING)]
    libraries: Vec<PathBuf>,

    /// The library to write, or the folder
    #[arg(short, long, value_name = "HTEXLIB|DIR", value_parser = located::OUTPUT)]
    output: PathBuf,

    /// Texts to put before the names, one for each library, e.g. wood/,cloth/
    #[arg(long, value_name = "TEXT,…", value_delimiter = ',')]
    prefix: Vec<String>,

    /// Which texture to take if several libraries have different textures of one name
    #[arg(long, value_enum, default_value = "error")]
    on_conflict: Conflict,

    /// Name of the merged library [default: the file's name, or `library` in a folder]
    #[arg(long)]
    name: Option<String>,

    /// Set the library's own metadata: version, description, authors, homepage, source, changelog
    /// or date, e.g. version=1.2. An empty value removes the entry. May be given several times
    #[arg(long, value_name = "ENTRY=TEXT")]
    describe: Vec<String>,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Conflict {
    /// None: end with an error
    Error,
    /// The texture of the library that is named first
    First,
    /// The texture of the library that is named last
    Last,
}

/// The merged folder.
#[derive(Serialize)]
struct MergedBuilds {
    folder: String,
    library: String,
    bytes: u64,
    textures: usize,
    left_out: usize,
}

impl Display for MergedBuilds {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { folder, library, bytes, textures, left_out } = self;
        writeln!(
            f,
            "{folder}: {textures} textures in {library}, {bytes} bytes; {left_out} left out"
        )
    }
}

impl Merge {
    pub(crate) fn run(self) -> Result {
        let Self { libraries, output, prefix, .. } = self;
        check_outputs([output.as_path()], libraries.iter().map(PathBuf::as_path))?;
        if !prefix.is_empty() && prefix.len() != libraries.len() {
            return Err(Failure::Usage(format!(
                "--prefix: there are {} libraries; give one text for each, which may be empty",
                libraries.len()
            )));
        }
        let prefixes = prefix.into_iter().chain(std::iter::repeat(String::new()));
        let folders = libraries.iter().filter(|path| path.is_dir()).count();
        if folders > 0 && folders < libraries.len() {
            return Err(Failure::usage("some are folders and some are libraries; give one kind"));
        }
        let on_conflict = match self.on_conflict {
            Conflict::Error => OnConflict::Error,
            Conflict::First => OnConflict::First,
            Conflict::Last => OnConflict::Last,
        };
        let metadata = described(&LibraryMetadata::default(), &self.describe)?;
        let parts = libraries.into_iter().zip(prefixes).collect();
        if folders > 0 {
            let name = self.name.unwrap_or_else(|| "library".to_owned());
            let merge = BuildsMerge { folders: parts, on_conflict, metadata };
            let LibraryReport { file, bytes, textures, left_out, .. } =
                merge.run(&output, &name)?.library;
            let folder = output.display().to_string();
            return show(
                &MergedBuilds { folder, library: file, bytes, textures, left_out },
                self.json,
            );
        }
        let merge = LibraryMerge { libraries: parts, on_conflict, metadata };
        let stem = output.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let name = self.name.unwrap_or(stem);
        let packed = merge.run(&output, &name)?;
        show(&PackReport { file: &output, name, packed }, self.json)
    }
}
