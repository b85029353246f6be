//! The files to pack and their names in the library.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use htex_base::files::AtFile;

use crate::failure::Failure;
use crate::shown::shown;

const EXTENSION: &str = "htex";

/// Returns the `.htex` files of the inputs by their names in the library. A file is named after
/// itself, and a file in a folder after its path in the folder, both without `.htex`.
pub(super) fn sources(inputs: &[PathBuf]) -> Result<BTreeMap<String, PathBuf>, Failure> {
    let mut found = BTreeMap::new();
    for input in inputs {
        if !input.is_dir() {
            let name = input.file_name().map(Path::new).unwrap_or(input);
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
fn search(
    folder: &Path,
    inside: &Path,
    found: &mut BTreeMap<String, PathBuf>,
) -> Result<(), Failure> {
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

fn add(found: &mut BTreeMap<String, PathBuf>, inside: &Path, path: PathBuf) -> Result<(), Failure> {
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
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(EXTENSION))
}
