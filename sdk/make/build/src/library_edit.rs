//! Changes libraries without their recordings: removes, renames and adds textures, and edits their
//! metadata.

use std::cell::OnceCell;
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};

use htex_author::describe;
use htex_author::settings::Metadata;
use htex_base::files::{AtFile, read_regular};
use htex_format::library::{
    Description, Entry, Library, LibraryError, LibraryMetadata, NamePattern, PackSummary,
    PreparedTexture, Writer,
};
use htex_format::{Asset, Limits, Manifest};
use rayon::prelude::*;

use crate::BuildError;
use crate::error::at_place;
use crate::filter::Filter;
use crate::metadata_table::MetadataTable;

/// Changes of a library. Textures are removed first, then renamed, then added. After that, the
/// metadata change.
///
/// ```no_run
/// use htex_build::LibraryEdit;
/// let edit = LibraryEdit { remove: vec!["old/*".parse()?], ..LibraryEdit::default() };
/// let summary = edit.run("cloth.htexlib".as_ref(), "cloth.htexlib".as_ref(), &|_| {})?;
/// println!("{} textures removed", summary.removed);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct LibraryEdit {
    /// Names of the textures to remove.
    pub remove: Vec<NamePattern>,
    /// Old and new names of textures.
    pub rename: Vec<(String, String)>,
    /// Textures to add.
    pub add: Vec<Addition>,
    /// Metadata to set, in each texture.
    pub metadata: Metadata,
    /// Tags to add to each texture.
    pub add_tags: Vec<String>,
    /// Tags to remove from each texture.
    pub remove_tags: Vec<String>,
    /// A CSV file with metadata of single textures. The column `texture` contains the names of the
    /// textures. Each other column is named after the metadata that it contains.
    pub table: Option<PathBuf>,
    /// Only textures that match all of these filters are removed or get new metadata.
    pub filters: Vec<Filter>,
    /// New metadata of the library itself; `None` to leave this metadata unchanged.
    pub library_metadata: Option<LibraryMetadata>,
    /// Whether added and edited textures may lack a licence.
    pub allows_unlicensed: bool,
}

/// Textures to add to a library.
#[derive(Debug, Clone)]
pub enum Addition {
    /// The file of a texture, and its name in the library.
    Texture { name: String, file: PathBuf },
    /// All textures of another library, each under its own name.
    Library(PathBuf),
}

/// What an edit changed.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct EditSummary {
    /// Name of the library.
    pub name: String,
    /// Number of textures that were removed.
    pub removed: usize,
    /// Number of textures that were renamed.
    pub renamed: usize,
    /// Number of textures that were added.
    pub added: usize,
    /// Number of textures whose metadata were changed.
    pub edited: usize,
    /// The library that was written.
    pub packed: PackSummary,
}

/// Number of textures that are edited at once, on all processors.
const BATCH: usize = 1024;

impl LibraryEdit {
    /// Returns whether there is nothing to change.
    pub fn is_empty(&self) -> bool {
        let is_known = self.remove.is_empty() && self.rename.is_empty() && self.add.is_empty();
        is_known && !self.changes_all() && self.table.is_none() && self.library_metadata.is_none()
    }

    /// Changes a library, and writes it to `output`, which may be the same file. Calls `told` with
    /// the number of textures edited so far.
    ///
    /// # Errors
    /// - Returns an error if a file cannot be read or written.
    /// - Returns an error if the edit removes or renames a texture that the library lacks, or if
    ///   such a texture is in the table of metadata.
    /// - Returns an error if a new name is already the name of another texture in the library.
    /// - Returns an error if a changed texture would not be valid, or states no licence.
    ///
    /// After an error, the file at `output` is unchanged.
    pub fn run(
        &self,
        library: &Path,
        output: &Path,
        told: &dyn Fn(usize),
    ) -> Result<EditSummary, BuildError> {
        let of_library = |error: LibraryError| BuildError::at_place(library.display(), error);
        let of_output = |error: LibraryError| BuildError::at_place(output.display(), error);
        let opened = Library::open(library).map_err(of_library)?;
        let table = self.table.as_deref().map(MetadataTable::read).transpose()?;
        let table = table.unwrap_or_default();
        let renames: BTreeMap<&str, &str> =
            self.rename.iter().map(|(old, new)| (old.as_str(), new.as_str())).collect();
        let mut olds: Vec<&String> = self.rename.iter().map(|(old, _)| old).collect();
        olds.sort_unstable();
        if let Some([old, _]) = olds.windows(2).find(|pair| pair[0] == pair[1]) {
            let problem = format!("{old} would get two names; give one");
            return Err(BuildError::at_place(library.display(), problem));
        }
        let name = opened.name().to_owned();
        let mut writer = Writer::create(output, &name).map_err(of_output)?;
        if self.allows_unlicensed {
            writer.allow_unlicensed();
        }
        writer.describe_with(describe);
        let metadata = self.library_metadata.as_ref().unwrap_or(opened.metadata());
        writer.set_metadata(metadata.clone());
        let mut run = Run { edit: self, table, writer, edited: 0, told };
        let (mut removed, mut renamed) = (0, 0);
        let mut used = vec![false; self.remove.len()];
        let mut unused: BTreeMap<&str, &str> = renames.clone();
        run.take(library, opened, |entry, is_chosen| {
            let is_removed =
                self.remove.iter().zip(&mut used).fold(false, |is, (pattern, used)| {
                    let matches = pattern.matches(&entry.name);
                    *used |= matches;
                    is || matches
                });
            if is_removed && is_chosen {
                removed += 1;
                return None;
            }
            unused.remove(entry.name.as_str());
            Some(match renames.get(entry.name.as_str()) {
                Some(new) => {
                    renamed += 1;
                    (*new).to_owned()
                }
                None => entry.name.clone(),
            })
        })?;
        let again = || Library::open(library).map_err(of_library);
        let absent = |name: &str| again()?.needed(name).map(|_| ()).map_err(of_library);
        if let Some(pattern) = self.remove.iter().zip(used).find(|(_, used)| !used).map(|(p, _)| p)
        {
            if !pattern.is_pattern() {
                absent(pattern.as_str())?;
            }
            let problem =
                format!("no texture is called {pattern}; list the names with `htex lib ls`");
            return Err(BuildError::at_place(library.display(), problem));
        }
        if let Some((old, _)) = unused.pop_first() {
            absent(old)?;
        }
        let added = run.add()?;
        if let Some(name) = run.table.unused() {
            absent(name)?;
        }
        let edited = run.edited;
        let packed = run.writer.finish().map_err(of_output)?;
        Ok(EditSummary { name, removed, renamed, added, edited, packed })
    }
}

/// An edit that is being carried out.
struct Run<'a> {
    edit: &'a LibraryEdit,
    table: MetadataTable,
    writer: Writer,
    edited: usize,
    told: &'a dyn Fn(usize),
}

impl Run<'_> {
    /// Takes over the textures of a library. For each texture, `name` is told whether the texture
    /// matches the filters, and returns the texture's new name.
    fn take(
        &mut self,
        path: &Path,
        library: Library,
        mut name: impl FnMut(&Entry, bool) -> Option<String>,
    ) -> Result<(), BuildError> {
        let of_library = |error: LibraryError| BuildError::at_place(path.display(), error);
        let mut kept = Vec::with_capacity(usize::try_from(library.len()).unwrap_or_default());
        let mut batch = Vec::new();
        for entry in library.entries() {
            let entry = entry.map_err(of_library)?;
            let manifest = OnceCell::new();
            let read = || self.manifest(&manifest, &library, &entry).map_err(of_library);
            let is_chosen = Filter::all(&self.edit.filters, &entry, &read)?;
            let Some(name) = name(&entry, is_chosen) else {
                kept.push(Kept::No);
                continue;
            };
            let row = self.table.take(&entry.name);
            if (is_chosen && self.edit.changes_all()) || row.is_some() {
                batch.push(Pending { index: kept.len(), entry, name, is_chosen, row });
                // Unless nothing changes.
                kept.push(Kept::No);
                if batch.len() == BATCH {
                    self.edit_batch(path, &library, &mut batch, &mut kept)?;
                }
            } else {
                kept.push(Kept::new(&entry, name));
            }
        }
        self.edit_batch(path, &library, &mut batch, &mut kept)?;
        if kept.iter().all(|kept| matches!(kept, Kept::No)) {
            return Ok(());
        }
        // The entries come again in the same order.
        let mut kept = kept.into_iter();
        let added = self.writer.add_library(library, |entry| match kept.next() {
            Some(Kept::Same) => Some(entry.name.clone()),
            Some(Kept::As(name)) => Some(name),
            Some(Kept::No) | None => None,
        });
        added.map_err(of_library)
    }

    fn manifest<'m>(
        &self,
        cell: &'m OnceCell<Manifest>,
        library: &Library,
        entry: &Entry,
    ) -> Result<&'m Manifest, LibraryError> {
        if let Some(manifest) = cell.get() {
            return Ok(manifest);
        }
        let bytes = library.read(entry)?;
        let asset = Asset::from_bytes(&bytes).map_err(|error| LibraryError::Asset {
            name: entry.name.clone(),
            error: Box::new(error),
        })?;
        Ok(cell.get_or_init(|| asset.manifest))
    }

    /// Edits the textures of a batch. Those in which nothing changes are kept as they are.
    fn edit_batch(
        &mut self,
        path: &Path,
        library: &Library,
        batch: &mut Vec<Pending>,
        kept: &mut [Kept],
    ) -> Result<(), BuildError> {
        let edit = self.edit;
        // Metadata change no spectrum. An index of version 1.0 contains no descriptions.
        let is_described = library.index().minor_version() > 0;
        let descriptions = batch.iter().map(|texture| {
            let known = is_described.then(|| library.description(&texture.entry)).transpose();
            known.map_err(at_place(path.display()))
        });
        let descriptions = descriptions.collect::<Result<Vec<_>, BuildError>>()?;
        let edited: Vec<_> = batch
            .par_iter()
            .zip(descriptions)
            .map(|(texture, known)| {
                let bytes = library.read(&texture.entry).map_err(at_place(path.display()))?;
                let place = format!("{}, texture {}", path.display(), texture.entry.name);
                edit.edited(&bytes, texture.is_chosen, texture.row.as_ref(), known, &place)
            })
            .collect();
        for (texture, edited) in batch.drain(..).zip(edited) {
            match edited? {
                None => kept[texture.index] = Kept::new(&texture.entry, texture.name),
                Some(edited) => {
                    let added = self.writer.add_prepared(&texture.name, edited);
                    added.map_err(at_place(path.display()))?;
                    self.edited += 1;
                }
            }
        }
        (self.told)(self.edited);
        Ok(())
    }

    /// Adds the requested textures and libraries, and returns how many textures were added.
    fn add(&mut self) -> Result<usize, BuildError> {
        let mut count = 0;
        for addition in &self.edit.add {
            match addition {
                Addition::Library(path) => {
                    let opened = Library::open(path).map_err(at_place(path.display()))?;
                    let mut names = HashSet::new();
                    self.take(path, opened, |entry, _| {
                        names.insert(entry.name.clone());
                        Some(entry.name.clone())
                    })?;
                    count += names.len();
                }
                Addition::Texture { name, file } => {
                    let most = Limits::default().file_bytes;
                    let bytes = read_regular(file, most).reading(file)?;
                    let place = file.display().to_string();
                    let row = self.table.take(name);
                    let is_chosen = self.edit.is_chosen(name, &bytes, &place)?;
                    match self.edit.edited(&bytes, is_chosen, row.as_ref(), None, &place)? {
                        Some(edited) => self.writer.add_prepared(name, edited),
                        None => self.writer.add(name, &bytes),
                    }
                    .map_err(at_place(&place))?;
                    count += 1;
                }
            }
        }
        Ok(count)
    }
}

/// Whether a texture is taken over as it is, and under which name.
enum Kept {
    No,
    Same,
    As(String),
}

impl Kept {
    fn new(entry: &Entry, name: String) -> Self {
        if entry.name == name { Self::Same } else { Self::As(name) }
    }
}

/// A texture of a library that may get other metadata.
struct Pending {
    /// Its number in the library.
    index: usize,
    entry: Entry,
    /// Its new name.
    name: String,
    is_chosen: bool,
    row: Option<Metadata>,
}

impl LibraryEdit {
    /// Returns whether each texture may get other metadata.
    fn changes_all(&self) -> bool {
        !(self.metadata.is_empty() && self.add_tags.is_empty() && self.remove_tags.is_empty())
    }

    fn is_chosen(&self, name: &str, bytes: &[u8], place: &str) -> Result<bool, BuildError> {
        if self.filters.is_empty() {
            return Ok(true);
        }
        let manifest = Asset::from_bytes(bytes).map_err(at_place(place))?.manifest;
        Ok(self.filters.iter().all(|filter| filter.matches_manifest(name, &manifest)))
    }

    /// Returns a texture with new metadata; `None` if the texture already has this metadata.
    /// `known` is the texture's description, if the library contains it.
    fn edited(
        &self,
        bytes: &[u8],
        is_chosen: bool,
        row: Option<&Metadata>,
        known: Option<Description>,
        place: &str,
    ) -> Result<Option<PreparedTexture>, BuildError> {
        let changes = is_chosen && self.changes_all();
        if !changes && row.is_none() {
            return Ok(None);
        }
        let mut asset = htex_author::edit(bytes, &Metadata::default()).map_err(at_place(place))?;
        let before = asset.manifest.clone();
        if changes {
            self.metadata.apply(&mut asset.manifest);
            let tags = &mut asset.manifest.tags;
            tags.retain(|tag| !self.remove_tags.contains(tag));
            for tag in &self.add_tags {
                if !tags.contains(tag) {
                    tags.push(tag.clone());
                }
            }
        }
        // The table's metadata for one texture replace the metadata that are given for all
        // textures.
        if let Some(row) = row {
            row.apply(&mut asset.manifest);
        }
        if asset.manifest == before {
            return Ok(None);
        }
        let bytes = asset.to_bytes().map_err(at_place(place))?;
        let description = known.unwrap_or_else(|| describe(&asset));
        Ok(Some(PreparedTexture::of_asset(&asset, bytes, description)))
    }
}
