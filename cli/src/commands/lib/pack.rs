use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};
use std::path::{Path, PathBuf};

use clap::Args;
use htex_author::describe;
use htex_base::files::AtFile;
use htex_format::library::{
    EXTENSION, Library, LibraryError, LibraryMetadata, PackSummary, PreparedTexture, Writer,
};
use serde::{Serialize, Serializer};
use serde_json::json;

use super::described;
use crate::assets::read_asset;
use crate::commands::validate::is_library;
use crate::failure::{Failure, Result, for_file};
use crate::located;
use crate::output::{show, shown};
use crate::outputs::check_outputs;
use crate::progress::bar;

/// Pack textures into a library.
///
/// In the library, a texture has the name of its file, without `.htex`. A texture in a folder is
/// named after its path in that folder, e.g. wood/oak. Textures that come from another library keep
/// their names. The same textures give the same library, in any order and on any machine. Each
/// texture must state a licence (`htex edit --license`), because libraries are meant to be passed
/// on, and a texture without a licence may be passed on only by its author.
#[derive(Args)]
pub(crate) struct Pack {
    /// The library to write
    #[arg(value_name = "OUT.htexlib", value_parser = located::OUTPUT)]
    output: PathBuf,

    /// Textures to pack, or folders and libraries that contain textures to pack. LIBRARY#GLOB is
    /// part of a library
    #[arg(required = true, value_name = "FILE|DIR|LIBRARY", value_parser = located::FILES)]
    inputs: Vec<PathBuf>,

    /// Name of the library [default: the file's name]
    #[arg(long)]
    name: Option<String>,

    /// Set the library's own metadata: version, description, authors, homepage, source, changelog
    /// or date, e.g. version=1.2. An empty value removes the entry. May be given several times
    #[arg(long, value_name = "ENTRY=TEXT")]
    describe: Vec<String>,

    /// Also pack textures that state no licence. Only the author of such a texture may then pass on
    /// the library
    #[arg(long)]
    unlicensed: bool,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Pack {
    pub(crate) fn run(self) -> Result {
        let is_named = self.output.extension().is_some_and(|e| e.eq_ignore_ascii_case(EXTENSION));
        // Without this, `htex lib pack oak.htex birch.htex` would replace the first texture by a
        // library.
        if !is_named && (self.output.extension().is_some() || self.output.is_dir()) {
            let output = shown(&self.output);
            return Err(Failure::Usage(format!(
                "{output}: the library to write comes first, such as cloth.{EXTENSION}"
            )));
        }
        let (libraries, files): (Vec<_>, Vec<_>) =
            located::each(&self.inputs).into_iter().partition(|path| is_library(path));
        let sources = sources(&files)?;
        let inputs = libraries.iter().chain(sources.values());
        check_outputs([self.output.as_path()], inputs.map(PathBuf::as_path))?;
        let stem = self.output.file_stem().map(|stem| stem.to_string_lossy());
        let name = self.name.clone().unwrap_or(stem.unwrap_or_default().into_owned());
        let mut writer = Writer::create(&self.output, &name).map_err(for_file(&self.output))?;
        if self.unlicensed {
            writer.allow_unlicensed();
        }
        writer.describe_with(describe);
        writer.set_metadata(described(&LibraryMetadata::default(), &self.describe)?);
        let bar = bar(sources.len() as u64);
        let all: Vec<(&String, &PathBuf)> = sources.iter().collect();
        for batch in all.chunks(BATCH) {
            for ((name, path), prepared) in batch.iter().zip(prepared(batch)) {
                writer.add_prepared(name, prepared?).map_err(for_file(path))?;
                bar.inc(1);
            }
        }
        for path in &libraries {
            let opened = Library::open(path).map_err(for_file(path))?;
            let added = writer.add_library(opened, |entry| Some(entry.name.clone()));
            added.map_err(for_file(path))?;
        }
        let packed = writer.finish().map_err(|error| self.failure(error, &sources))?;
        bar.finish_and_clear();
        show(&PackReport { file: &self.output, name, packed }, self.json)
    }

    /// Converts an error of the writer. If a licence is missing, says which flags help.
    fn failure(&self, error: LibraryError, sources: &BTreeMap<String, PathBuf>) -> Failure {
        match &error {
            LibraryError::Unlicensed { name, .. } => {
                let file = sources.get(name).map_or_else(|| name.clone(), |path| shown(path));
                Failure::Other(format!("{error}: htex edit {file} --license SPDX, or --unlicensed"))
            }
            _ => Failure::from(error).in_file(&self.output),
        }
    }
}

/// Number of textures that are read at once, on all processors.
const BATCH: usize = 256;

/// Reads textures and prepares them for a library, on all processors.
fn prepared(batch: &[(&String, &PathBuf)]) -> Vec<Result<PreparedTexture>> {
    let prepare = |path: &PathBuf| {
        PreparedTexture::new(read_asset(path)?, Some(describe)).map_err(for_file(path))
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let parts = batch.chunks(batch.len().div_ceil(threads).max(1));
    std::thread::scope(|scope| {
        let part = |part: &[(&String, &PathBuf)]| {
            part.iter().map(|(_, path)| prepare(path)).collect::<Vec<_>>()
        };
        let threads: Vec<_> = parts.map(|paths| scope.spawn(move || part(paths))).collect();
        let parts = threads
            .into_iter()
            .map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        parts.flatten().collect()
    })
}

/// The report on a library that was written.
pub(super) struct PackReport<'a> {
    pub(super) file: &'a Path,
    /// Name of the library.
    pub(super) name: String,
    pub(super) packed: PackSummary,
}

impl Serialize for PackReport<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { file, name, packed } = self;
        json!({
            "file": file.display().to_string(),
            "name": name,
            "textures": packed.entries,
            "bytes": packed.bytes,
            "index_bytes": packed.index_bytes,
            "shared_objects": packed.shared_objects,
            "saved_bytes": packed.saved_bytes,
            "blake3": packed.blake3.iter().map(|byte| format!("{byte:02x}")).collect::<String>(),
        })
        .serialize(serializer)
    }
}

impl Display for PackReport<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let PackSummary { entries, bytes, index_bytes, shared_objects, saved_bytes, .. } =
            &self.packed;
        let textures = if *entries == 1 { "texture" } else { "textures" };
        writeln!(
            f,
            "{}: {entries} {textures} in {bytes} bytes, {index_bytes} of them the index",
            shown(self.file)
        )?;
        if *shared_objects > 0 {
            writeln!(f, "  {shared_objects} shared objects save {saved_bytes} bytes")?;
        }
        Ok(())
    }
}

/// Returns the `.htex` files of the inputs, each with its name in the library. An input file keeps
/// its file name. A file in an input folder gets its path in this folder. Names do not include
/// `.htex`.
pub(super) fn sources(inputs: &[PathBuf]) -> Result<BTreeMap<String, PathBuf>> {
    let mut found = BTreeMap::new();
    for input in inputs {
        if !input.is_dir() {
            let own = located::texture_name(input);
            let name = own.as_deref().or(input.file_name().map(Path::new)).unwrap_or(input);
            add(&mut found, name, input.clone())?;
            continue;
        }
        let before = found.len();
        search(input, Path::new(""), &mut found)?;
        if found.len() == before {
            let folder = shown(input);
            return Err(Failure::Other(format!(
                "{folder}: no .htex file is in this folder or below"
            )));
        }
    }
    Ok(found)
}

/// Adds the files of a folder and its subfolders. Links to folders are not followed, because they
/// may form a loop.
fn search(folder: &Path, inside: &Path, found: &mut BTreeMap<String, PathBuf>) -> Result<()> {
    for entry in std::fs::read_dir(folder).reading(folder)? {
        let entry = entry.reading(folder)?;
        let (path, inside) = (entry.path(), inside.join(entry.file_name()));
        // `file_type` does not follow a link, but `is_file` below does: links to files are packed.
        if entry.file_type().reading(folder)?.is_dir() {
            search(&path, &inside, found)?;
        } else if is_called_texture(&path) && path.is_file() {
            add(found, &inside, path)?;
        }
    }
    Ok(())
}

fn add(found: &mut BTreeMap<String, PathBuf>, inside: &Path, path: PathBuf) -> Result<()> {
    let inside =
        if is_called_texture(inside) { inside.with_extension("") } else { inside.to_owned() };
    let parts: Option<Vec<&str>> = inside.iter().map(|part| part.to_str()).collect();
    let Some(parts) = parts else {
        let path = shown(&path);
        return Err(Failure::Other(format!("{path}: its name is not UTF-8; rename it")));
    };
    let name = parts.join("/");
    if let Some(other) = found.get(&name) {
        return Err(Failure::Usage(format!(
            "{} and {} would both be called {name:?}; rename one, or pack the folder that has both",
            shown(other),
            shown(&path)
        )));
    }
    found.insert(name, path);
    Ok(())
}

fn is_called_texture(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("htex"))
}
