//! Finds the recordings that match a rule of a recipe. Each recording has fields, which templates
//! may use.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use htex_base::files::{AtFile, read_regular};
use htex_base::storage::Location;
use regex::Regex;

use crate::BuildError;
use crate::error::at_place;
use crate::globs;
use crate::recipe::Textures;
use crate::remote::{RemoteFiles, folder_of, is_remote, joined};
use crate::template::Fields;

/// Largest number of recordings in a recipe. A texture takes about 4.7 kB of memory until it is
/// assembled, or more with long names; this number of textures takes less than 512 MiB.
pub(crate) const MOST_RECORDINGS: usize = 50_000;
/// Largest size of a table, bytes.
const MOST_TABLE_BYTES: u64 = 64 << 20;

/// A recording found by a rule.
#[derive(Debug)]
pub(crate) struct Input {
    /// The file: a URI, or a path relative to the recipe's folder if the file lies inside it.
    pub(crate) file: PathBuf,
    /// The path from which fields and patterns are taken, with `/` between its parts. For a URI, it
    /// is the part inside the listed folder.
    path: String,
    /// Fields of templates.
    pub(crate) fields: Fields,
}

/// What to do with a table row whose file does not exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Missing {
    /// Report an error.
    Error,
    /// Plan the row like any other row. When the file cannot be read, the texture is left out.
    LeftOut,
}

/// Returns the recordings of a rule in the order of their paths, or in the order of the rows for a
/// table.
pub(crate) fn inputs(
    rule: &Textures,
    place: &str,
    (folder, output): (&Path, &Path),
    remote: &RemoteFiles,
    missing: Missing,
) -> Result<Vec<Input>, BuildError> {
    let pattern = rule.pattern.as_deref().map(Regex::new).transpose();
    let pattern = pattern.map_err(at_place(format!("{place}.pattern")))?;
    let found = match (&rule.recordings[..], &rule.table) {
        ([], Some(table)) => tabulated(&joined(folder, table), place, folder, remote, missing)?,
        ([], None) => {
            let problem = "it names no recordings; give `recordings` (a glob) or `table` (a CSV)";
            return Err(BuildError::at_place(place, problem));
        }
        (_, Some(_)) => {
            let problem =
                "`recordings` and `table` both say where recordings are; give one of them";
            return Err(BuildError::at_place(place, problem));
        }
        (_, None) => recordings(&rule.recordings, place, (folder, output), remote)?,
    };
    let inputs = found.into_iter();
    inputs.map(|input| named_groups(input, pattern.as_ref(), place)).collect()
}

/// Returns the local and remote files that match globs, sorted by path.
fn recordings(
    globs: &[String],
    place: &str,
    (folder, output): (&Path, &Path),
    remote: &RemoteFiles,
) -> Result<Vec<Input>, BuildError> {
    let place = format!("{place}.recordings");
    if globs.len() > MOST_RECORDINGS {
        return Err(too_many(&place));
    }
    // A file that several globs match counts once.
    let (mut here, mut away) = (BTreeSet::new(), BTreeMap::new());
    for glob in globs {
        if is_remote(&joined(folder, Path::new(glob))) {
            let inputs = globbed_remote(glob, &place, folder, remote)?;
            away.extend(inputs.into_iter().map(|input| (input.file.clone(), input)));
        } else {
            here.extend(globs::files(glob, &place, folder, output)?);
        }
        if here.len() + away.len() > MOST_RECORDINGS {
            return Err(too_many(&place));
        }
    }
    if here.is_empty() && away.is_empty() {
        let globs = globs.join(", ");
        let problem = format!("no file matches {globs} in {}", folder.display());
        return Err(BuildError::at_place(place, problem));
    }
    let mut found: Vec<Input> = here.into_iter().map(input).collect();
    found.extend(away.into_values());
    Ok(found)
}

pub(crate) fn too_many(place: &str) -> BuildError {
    let problem = format!(
        "it names more than {MOST_RECORDINGS} recordings, which is the most of a recipe; divide it into several"
    );
    BuildError::at_place(place, problem)
}

/// Returns the remote files that match a glob. The glob is a URI, or a path relative to the folder
/// of a remote recipe.
fn globbed_remote(
    glob: &str,
    place: &str,
    folder: &Path,
    remote: &RemoteFiles,
) -> Result<Vec<Input>, BuildError> {
    let (below, pattern) = globs::split(glob);
    let below = if is_remote(Path::new(glob)) {
        PathBuf::from(below)
    } else {
        joined(folder, Path::new(below))
    };
    if !globs::is_glob(glob) {
        let uri = joined(&below, Path::new(pattern));
        let inside = if is_remote(Path::new(glob)) { pattern } else { glob };
        return Ok(vec![remote_input(uri, Path::new(inside))]);
    }
    let listed = remote.list(&Location::parse(below.as_ref())?, "**/*")?;
    let found = globs::matching(listed, pattern, place)?;
    if found.is_empty() {
        let problem = format!("no file matches {pattern} in {}", below.display());
        return Err(BuildError::at_place(place, problem));
    }
    let inputs = found.into_iter().map(|(uri, inside)| remote_input(uri, &inside));
    Ok(inputs.collect())
}

/// Returns the rows of a table.
fn tabulated(
    table: &Path,
    place: &str,
    folder: &Path,
    remote: &RemoteFiles,
    missing: Missing,
) -> Result<Vec<Input>, BuildError> {
    let place = format!("{place}.table");
    let shown = table.display();
    let text = match crate::remote::remote_location(table)? {
        Some(location) => remote.text(&location)?.into_bytes(),
        None => read_regular(table, MOST_TABLE_BYTES).reading(table)?,
    };
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(&text[..]);
    let in_table = format!("{place}: {shown}");
    let headers = reader.headers().map_err(at_place(&in_table))?.clone();
    let column = headers.iter().position(|name| name == "recording");
    let column = column.ok_or_else(|| {
        let problem = format!("{shown}: it has no column `recording` with the files");
        BuildError::at_place(&place, problem)
    })?;
    let beside = folder_of(table);
    let mut inputs = Vec::new();
    for row in reader.records() {
        if inputs.len() == MOST_RECORDINGS {
            return Err(too_many(&place));
        }
        let row = row.map_err(at_place(&in_table))?;
        let cell = row.get(column).unwrap_or_default();
        let file = joined(&beside, Path::new(cell));
        let is_away = is_remote(&file);
        if !is_away && missing == Missing::Error && !file.is_file() {
            let line = row.position().map_or(0, csv::Position::line);
            let problem = format!("{shown}, line {line}: there is no file {}", file.display());
            return Err(BuildError::at_place(&place, problem));
        }
        let mut input = if is_away {
            remote_input(file, Path::new(cell))
        } else {
            input(file.strip_prefix(folder).unwrap_or(&file).to_owned())
        };
        let cells = headers.iter().zip(&row);
        let own = cells.map(|(name, cell)| (name.to_owned(), cell.to_owned()));
        input.fields.extend(own);
        inputs.push(input);
    }
    if inputs.is_empty() {
        return Err(BuildError::at_place(&place, format!("{shown}: it has no rows")));
    }
    Ok(inputs)
}

/// Returns a recording with the fields of its path.
fn input(file: PathBuf) -> Input {
    Input { fields: fields(&file), path: slashed(&file), file }
}

/// Returns a remote recording with the fields of its path in the listed folder.
fn remote_input(uri: PathBuf, inside: &Path) -> Input {
    let inside = match Location::parse(inside.as_os_str()) {
        Ok(location) if location.local().is_none() => location.file_name().map(PathBuf::from),
        _ => None,
    }
    .unwrap_or_else(|| inside.to_owned());
    Input { fields: fields(&inside), path: slashed(&inside), file: uri }
}

fn fields(file: &Path) -> Fields {
    let text = |part: Option<&std::ffi::OsStr>| {
        part.map(|p| p.to_string_lossy().into_owned()).unwrap_or_default()
    };
    let folder = file.parent().unwrap_or(Path::new(""));
    let fields = [
        ("stem", text(file.file_stem())),
        ("file", text(file.file_name())),
        ("folder", slashed(folder)),
    ];
    fields.map(|(name, value)| (name.to_owned(), value)).into()
}

/// Adds the named groups of a pattern as fields.
fn named_groups(
    mut input: Input,
    pattern: Option<&Regex>,
    place: &str,
) -> Result<Input, BuildError> {
    let Some(pattern) = pattern else {
        return Ok(input);
    };
    let path = &input.path;
    let groups = pattern.captures(path).ok_or_else(|| {
        let problem = format!("`{path}` does not match `{pattern}`; change it, or the globs");
        BuildError::at_place(format!("{place}.pattern"), problem)
    })?;
    for name in pattern.capture_names().flatten() {
        let value = groups.name(name).map_or("", |group| group.as_str());
        input.fields.insert(name.to_owned(), value.to_owned());
    }
    Ok(input)
}

/// Returns a path with `/` between its parts.
pub(crate) fn slashed(path: &Path) -> String {
    let parts = path.components().filter_map(|part| match part {
        Component::Normal(part) => Some(part.to_string_lossy().into_owned()),
        Component::ParentDir => Some("..".to_owned()),
        _ => None,
    });
    let joined = parts.collect::<Vec<_>>().join("/");
    if path.has_root() { format!("/{joined}") } else { joined }
}
