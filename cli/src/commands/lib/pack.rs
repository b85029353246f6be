use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use htex_format::library::{EXTENSION, LibraryError, PackSummary, Writer};
use serde_json::{Value, json};

use super::sources::sources;
use crate::bounded::read_asset;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::of_file::{OfFile, of_file};
use crate::output::{print, print_json};
use crate::outputs::check_outputs;
use crate::progress::bar;
use crate::shown::shown;

/// Pack textures into a library.
///
/// A texture is named after its file, without `.htex`. A texture in a folder is named after its
/// path in that folder, e.g. wood/oak. The same textures give the same file, in any order and on
/// any machine. Each texture must state a licence (`htex edit --license`), because a library is
/// passed on.
#[derive(Args)]
pub(crate) struct Pack {
    /// The library to write
    #[arg(value_name = "OUT.htexlib", value_parser = located::OUTPUT)]
    output: PathBuf,

    /// Textures, and folders with textures
    #[arg(required = true, value_name = "FILE|DIR", value_parser = located::ASSET)]
    inputs: Vec<PathBuf>,

    /// Name of the library [default: the file's]
    #[arg(long)]
    name: Option<String>,

    /// Also pack textures without a licence, which only their author may pass on
    #[arg(long)]
    unlicensed: bool,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Pack {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let is_library = self.output.extension().is_some_and(|e| e.eq_ignore_ascii_case(EXTENSION));
        // Without this, `htex lib pack oak.htex birch.htex` would replace the first texture by a
        // library.
        if !is_library && (self.output.extension().is_some() || self.output.is_dir()) {
            let output = shown(&self.output);
            return Err(Failure::Usage(format!(
                "{output}: the library to write comes first, such as cloth.{EXTENSION}"
            )));
        }
        let sources = sources(&self.inputs)?;
        check_outputs([self.output.as_path()], sources.values().map(PathBuf::as_path))?;
        let stem = self.output.file_stem().map(|stem| stem.to_string_lossy());
        let name = self.name.clone().unwrap_or(stem.unwrap_or_default().into_owned());
        let mut writer = Writer::create(&self.output, &name).map_err(of_file(&self.output))?;
        if self.unlicensed {
            writer.allow_unlicensed();
        }
        let bar = bar(sources.len() as u64);
        for (name, path) in &sources {
            let bytes = read_asset(path)?;
            writer.add(name, &bytes).map_err(of_file(path))?;
            bar.inc(1);
        }
        let packed = writer.finish().map_err(|error| self.failure(error, &sources))?;
        bar.finish_and_clear();
        if self.json {
            print_json(&summary(&self.output, &name, &packed))?;
        } else {
            print(&text(&self.output, &packed))?;
        }
        Ok(Exit::SUCCESS)
    }

    /// Converts an error of writing, and says what to do here.
    fn failure(&self, error: LibraryError, sources: &BTreeMap<String, PathBuf>) -> Failure {
        match &error {
            LibraryError::Unlicensed { name, .. } => {
                let file = sources.get(name).map_or_else(|| name.clone(), |path| shown(path));
                Failure::Other(format!("{error}: htex edit {file} --license SPDX, or --unlicensed"))
            }
            _ => error.of(&self.output),
        }
    }
}

/// Summarises the library that was written, as JSON.
fn summary(path: &Path, name: &str, packed: &PackSummary) -> Value {
    json!({
        "file": path.display().to_string(),
        "name": name,
        "textures": packed.entries,
        "bytes": packed.bytes,
        "index_bytes": packed.index_bytes,
        "shared_objects": packed.shared_objects,
        "saved_bytes": packed.saved_bytes,
        "blake3": packed.blake3.iter().map(|byte| format!("{byte:02x}")).collect::<String>(),
    })
}

fn text(path: &Path, packed: &PackSummary) -> String {
    let PackSummary { entries, bytes, index_bytes, saved_bytes, .. } = packed;
    let textures = if *entries == 1 { "texture" } else { "textures" };
    let mut text = format!(
        "{}: {entries} {textures} in {bytes} bytes, {index_bytes} of them the index\n",
        shown(path)
    );
    if packed.shared_objects > 0 {
        let objects = packed.shared_objects;
        text += &format!("  {objects} shared objects save {saved_bytes} bytes\n");
    }
    text
}
