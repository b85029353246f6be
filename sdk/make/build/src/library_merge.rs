//! Merges libraries.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use htex_format::library::{Library, LibraryError, LibraryMetadata, PackSummary, Writer};

use crate::BuildError;
use crate::error::at_place;
use crate::removed::named_briefly;

/// What happens if two libraries have different textures with the same name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OnConflict {
    /// The merge ends with an error.
    #[default]
    Error,
    /// The merged library gets the texture from the first library that contains a texture with this
    /// name.
    First,
    /// The merged library gets the texture from the last library that contains a texture with this
    /// name.
    Last,
}

/// Libraries to merge.
///
/// ```no_run
/// use htex_build::{LibraryMerge, OnConflict};
/// let merge = LibraryMerge {
///     libraries: vec![("wood.htexlib".into(), "wood/".to_owned()), ("cloth.htexlib".into(), "cloth/".to_owned())],
///     on_conflict: OnConflict::Error,
///     ..LibraryMerge::default()
/// };
/// merge.run("all.htexlib".as_ref(), "All")?;
/// # Ok::<(), htex_build::BuildError>(())
/// ```
#[derive(Debug, Default)]
pub struct LibraryMerge {
    /// The libraries, each with a prefix for the names of its textures.
    pub libraries: Vec<(PathBuf, String)>,
    pub on_conflict: OnConflict,
    /// Metadata of the merged library itself, such as its version.
    pub metadata: LibraryMetadata,
}

impl LibraryMerge {
    /// Writes the merged library.
    ///
    /// # Errors
    /// - A library cannot be read, or the merged library cannot be written.
    /// - Two libraries have different textures with the same name, and [`Self::on_conflict`] does
    ///   not choose one of them. Two names that differ only in case are always an error.
    ///
    /// After an error, the file at `output` is unchanged.
    pub fn run(&self, output: &Path, name: &str) -> Result<PackSummary, BuildError> {
        let of_output = |error: LibraryError| BuildError::at_place(output.display(), error);
        let mut writer = Writer::create(output, name).map_err(of_output)?;
        writer.describe_with(htex_author::describe);
        writer.set_metadata(self.metadata.clone());
        let mut hashes: BTreeMap<String, [u8; 32]> = BTreeMap::new();
        let mut conflicts = Vec::new();
        let mut libraries: Vec<_> = self.libraries.iter().collect();
        // Of several textures with the same name, the first one is taken.
        if self.on_conflict == OnConflict::Last {
            libraries.reverse();
        }
        for (path, prefix) in libraries {
            let library = Library::open(path).map_err(at_place(path.display()))?;
            let added = writer.add_library(library, |entry| {
                let name = format!("{prefix}{}", entry.name);
                match hashes.get(&name) {
                    None => {
                        hashes.insert(name.clone(), entry.blake3);
                        return Some(name);
                    }
                    Some(blake3) if *blake3 != entry.blake3 => conflicts.push(name),
                    // The same texture under the same name.
                    Some(_) => {}
                }
                None
            });
            added.map_err(at_place(path.display()))?;
        }
        if self.on_conflict == OnConflict::Error && !conflicts.is_empty() {
            let problem = format!(
                "{} names have different textures in these libraries ({}); give the libraries prefixes, or take the first or the last",
                conflicts.len(),
                named_briefly(&conflicts)
            );
            return Err(BuildError::at_place(output.display(), problem));
        }
        writer.finish().map_err(of_output)
    }
}
