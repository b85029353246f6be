use std::fmt::{Display, Formatter};
use std::path::PathBuf;

use clap::Args;
use htex_author::settings::Metadata;
use htex_build::{Addition, EditSummary, Filter, LibraryEdit, metadata_value};
use htex_format::library::{Library, LibraryMetadata, NamePattern};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

use super::described;
use super::pack::{PackReport, sources};
use crate::assets::check_metadata;
use crate::commands::validate::is_library;
use crate::failure::{Failure, Result, for_file};
use crate::located;
use crate::output::{show, shown};
use crate::outputs::check_outputs;
use crate::progress::bar;

/// Change a library: its textures, their metadata, and what it says about itself
///
/// The command needs no recordings. It removes textures first, then renames and adds textures, and
/// then changes metadata. All other textures stay the same, byte for byte. The result is the same
/// library that `htex lib pack` would write from the resulting textures.
///
/// GLOB is a name, or a pattern: `*` matches any text inside a part of a name, and `**` also
/// matches across parts.
#[derive(Args)]
pub(crate) struct Edit {
    /// The library
    #[arg(value_name = "LIBRARY", value_parser = located::RECORDING)]
    library: PathBuf,

    /// The library to write [default: replace the library]
    #[arg(short, long, value_name = "HTEXLIB", value_parser = located::OUTPUT)]
    output: Option<PathBuf>,

    /// Add a texture, all textures of a folder, or textures of a library (all, or with LIBRARY#GLOB
    /// only some). May be given several times
    #[arg(long, value_name = "FILE|DIR|LIBRARY", value_parser = located::FILES)]
    add: Vec<PathBuf>,

    /// Remove the textures with this name; may be given several times
    #[arg(long, value_name = "GLOB")]
    remove: Vec<NamePattern>,

    /// Rename a texture; may be given several times
    #[arg(long, value_name = "OLD=NEW", value_parser = renamed)]
    rename: Vec<(String, String)>,

    /// Set metadata of all textures, e.g. license=CC0-1.0. An empty value removes the entry. May be
    /// given several times
    #[arg(long, value_name = "FIELD=VALUE")]
    set: Vec<String>,

    /// Add a tag to all textures; may be given several times
    #[arg(long, value_name = "WORD")]
    add_tag: Vec<String>,

    /// Remove a tag from all textures; may be given several times
    #[arg(long, value_name = "WORD")]
    remove_tag: Vec<String>,

    /// Set metadata of single textures from a table. The column `texture` of this table contains
    /// the names of the textures, and each other column contains a field such as license. Empty
    /// cells change nothing. Tags are separated by semicolons
    #[arg(long, value_name = "CSV", value_parser = located::RECORDING)]
    table: Option<PathBuf>,

    /// Limit removing, setting metadata and tagging to textures with this property: name, tag,
    /// model, contact, license, author or quantity, e.g. tag=rough or license=CC*. May be given
    /// several times; then a texture must have all properties
    #[arg(long = "where", value_name = "FIELD=GLOB")]
    filters: Vec<Filter>,

    /// Set the library's own metadata: version, description, authors, homepage, source, changelog
    /// or date, e.g. version=1.2. An empty value removes the entry. May be given several times
    #[arg(long, value_name = "ENTRY=TEXT")]
    describe: Vec<String>,

    /// Also accept textures that state no licence
    #[arg(long)]
    unlicensed: bool,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Edit {
    pub(crate) fn run(self) -> Result {
        if self.output.is_none() && located::is_copy(&self.library) {
            let file = located::with_uris(&shown(&self.library));
            return Err(Failure::Usage(format!(
                "{file}: a library elsewhere is not replaced; name another file to write by -o FILE"
            )));
        }
        let library_metadata = self.library_metadata()?;
        let edit = LibraryEdit {
            remove: self.remove,
            rename: self.rename,
            add: additions(&self.add)?,
            metadata: metadata(&self.set)?,
            add_tags: self.add_tag,
            remove_tags: self.remove_tag,
            table: self.table,
            filters: self.filters,
            library_metadata,
            allows_unlicensed: self.unlicensed,
        };
        if edit.is_empty() {
            return Err(Failure::usage(
                "nothing to change: give at least one of --add, --remove, --rename, --set, --add-tag, --remove-tag, --table and --describe",
            ));
        }
        check_metadata(&edit.metadata)?;
        let output = self.output.as_ref().unwrap_or(&self.library);
        if let Some(output) = &self.output {
            check_outputs([output.as_path()], self.add.iter().map(PathBuf::as_path))?;
        }
        let bar = bar(0);
        let edited = edit.run(&self.library, output, &|count| bar.set_position(count as u64))?;
        bar.finish_and_clear();
        let packed = PackReport { file: output, name: edited.name.clone(), packed: edited.packed };
        show(&EditReport { edited, packed }, self.json)
    }
}

impl Edit {
    fn library_metadata(&self) -> Result<Option<LibraryMetadata>> {
        if self.describe.is_empty() {
            return Ok(None);
        }
        let library = Library::open(&self.library).map_err(for_file(&self.library))?;
        described(library.metadata(), &self.describe).map(Some)
    }
}

/// The report on an edited library.
struct EditReport<'a> {
    edited: EditSummary,
    packed: PackReport<'a>,
}

impl Serialize for EditReport<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct All<'a> {
            removed: usize,
            renamed: usize,
            added: usize,
            edited: usize,
            #[serde(flatten)]
            packed: &'a PackReport<'a>,
        }
        let EditSummary { removed, renamed, added, edited, .. } = self.edited;
        All { removed, renamed, added, edited, packed: &self.packed }.serialize(serializer)
    }
}

impl Display for EditReport<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let EditSummary { removed, renamed, added, edited, .. } = self.edited;
        writeln!(f, "{removed} removed, {renamed} renamed, {added} added, {edited} edited")?;
        self.packed.fmt(f)
    }
}

fn renamed(text: &str) -> Result<(String, String), String> {
    let names = text.split_once('=').ok_or("give OLD=NEW, two names")?;
    Ok((names.0.to_owned(), names.1.to_owned()))
}

/// Returns the textures and libraries to add.
fn additions(given: &[PathBuf]) -> Result<Vec<Addition>> {
    let (libraries, files): (Vec<_>, Vec<_>) =
        located::each(given).into_iter().partition(|path| is_library(path));
    let textures = sources(&files)?.into_iter();
    let textures = textures.map(|(name, file)| Addition::Texture { name, file });
    Ok(textures.chain(libraries.into_iter().map(Addition::Library)).collect())
}

/// Reads the metadata to set.
fn metadata(given: &[String]) -> Result<Metadata> {
    let mut values = Map::new();
    for text in given {
        let wrong = |problem: String| Failure::Usage(format!("--set {text}: {problem}"));
        let (name, value) =
            text.split_once('=').ok_or_else(|| wrong("give FIELD=VALUE".to_owned()))?;
        if !Metadata::NAMES.contains(&name) {
            let names = Metadata::NAMES.join(", ");
            return Err(wrong(format!("there is no field {name}; there are {names}")));
        }
        let value = metadata_value(name, value).map_err(wrong)?;
        values.insert(name.to_owned(), value);
    }
    serde_json::from_value(Value::Object(values))
        .map_err(|error| Failure::Usage(format!("--set: {error}")))
}
