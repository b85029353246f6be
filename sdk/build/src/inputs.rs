//! The recordings of a rule, each with the fields that templates may name.

use std::path::{Component, Path, PathBuf};

use globset::{GlobBuilder, GlobSet, GlobSetBuilder};
use regex::Regex;
use walkdir::WalkDir;

use crate::BuildError;
use crate::recipe::{OneOrMore, Textures};
use crate::template::Fields;

/// A recording, as a rule finds it.
#[derive(Debug)]
pub(crate) struct Input {
    /// The file, relative to the recipe's folder where it lies inside it.
    pub(crate) file: PathBuf,
    /// Fields of templates.
    pub(crate) fields: Fields,
}

/// Returns the recordings of a rule, in the order of their paths; those of a table in the order of its rows.
pub(crate) fn inputs(
    rule: &Textures,
    place: &str,
    folder: &Path,
    output: &Path,
) -> Result<Vec<Input>, BuildError> {
    let pattern = rule.pattern.as_deref().map(Regex::new).transpose();
    let pattern =
        pattern.map_err(|e| BuildError::plan(format!("{place}.pattern"), e.to_string()))?;
    let found = match (rule.recordings.as_slice(), &rule.table) {
        ([], Some(table)) => tabulated(&folder.join(table), place, folder)?,
        ([], None) => {
            let problem = "it names no recordings; give `recordings` (a glob) or `table` (a CSV)";
            return Err(BuildError::plan(place, problem));
        }
        (_, Some(_)) => {
            let problem =
                "`recordings` and `table` both say where recordings are; give one of them";
            return Err(BuildError::plan(place, problem));
        }
        (_, None) => globbed(&rule.recordings, place, folder, output)?,
    };
    let inputs = found.into_iter();
    inputs
        .map(|input| named_groups(input, pattern.as_ref(), place))
        .collect()
}

/// Returns the files that match globs.
fn globbed(
    globs: &OneOrMore,
    place: &str,
    folder: &Path,
    output: &Path,
) -> Result<Vec<Input>, BuildError> {
    let place = format!("{place}.recordings");
    let set = glob_set(globs, &place)?;
    let mut files = Vec::new();
    let output = output.canonicalize().ok();
    let outside = |entry: &walkdir::DirEntry| {
        let is_output = || output.is_some() && entry.path().canonicalize().ok() == output;
        !(entry.file_type().is_dir() && is_output())
    };
    for entry in WalkDir::new(folder)
        .follow_links(true)
        .into_iter()
        .filter_entry(outside)
    {
        let entry = entry.map_err(|error| {
            let file = error.path().unwrap_or(folder).to_owned();
            BuildError::read(&file, error.into())
        })?;
        let file = entry.path().strip_prefix(folder).unwrap_or(entry.path());
        if entry.file_type().is_file() && set.is_match(file) {
            files.push(file.to_owned());
        }
    }
    if files.is_empty() {
        let globs = globs.as_slice().join(", ");
        let problem = format!("no file matches {globs} in {}", folder.display());
        return Err(BuildError::plan(place, problem));
    }
    files.sort();
    Ok(files.into_iter().map(input).collect())
}

/// Compiles globs; `*` does not cross folders, `**` does.
pub(crate) fn glob_set(globs: &OneOrMore, place: &str) -> Result<GlobSet, BuildError> {
    let mut set = GlobSetBuilder::new();
    for glob in globs.as_slice() {
        let compiled = GlobBuilder::new(glob).literal_separator(true).build();
        set.add(compiled.map_err(|error| BuildError::plan(place, error.to_string()))?);
    }
    set.build()
        .map_err(|error| BuildError::plan(place, error.to_string()))
}

/// Returns the rows of a table.
fn tabulated(table: &Path, place: &str, folder: &Path) -> Result<Vec<Input>, BuildError> {
    let place = format!("{place}.table");
    let shown = table.display();
    let file = std::fs::File::open(table).map_err(|error| BuildError::read(table, error))?;
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(file);
    let broken = |error: csv::Error| BuildError::plan(&place, format!("{shown}: {error}"));
    let headers = reader.headers().map_err(broken)?.clone();
    let column = headers.iter().position(|name| name == "recording");
    let column = column.ok_or_else(|| {
        let problem = format!("{shown}: it has no column `recording` with the files");
        BuildError::plan(&place, problem)
    })?;
    let beside = table.parent().unwrap_or(Path::new(""));
    let mut inputs = Vec::new();
    for row in reader.records() {
        let row = row.map_err(broken)?;
        let file = beside.join(row.get(column).unwrap_or_default());
        if !file.is_file() {
            let line = row.position().map_or(0, csv::Position::line);
            let problem = format!("{shown}, line {line}: there is no file {}", file.display());
            return Err(BuildError::plan(&place, problem));
        }
        let mut input = input(file.strip_prefix(folder).unwrap_or(&file).to_owned());
        let cells = headers.iter().zip(&row);
        let own = cells.map(|(name, cell)| (name.to_owned(), cell.to_owned()));
        input.fields.extend(own);
        inputs.push(input);
    }
    if inputs.is_empty() {
        return Err(BuildError::plan(&place, format!("{shown}: it has no rows")));
    }
    Ok(inputs)
}

/// A recording with the fields of its path.
fn input(file: PathBuf) -> Input {
    let text = |part: Option<&std::ffi::OsStr>| {
        part.map(|p| p.to_string_lossy().into_owned())
            .unwrap_or_default()
    };
    let folder = file.parent().unwrap_or(Path::new(""));
    let fields = [
        ("stem", text(file.file_stem())),
        ("file", text(file.file_name())),
        ("folder", slashed(folder)),
    ];
    let fields = fields.map(|(name, value)| (name.to_owned(), value));
    Input {
        fields: fields.into(),
        file,
    }
}

/// Adds the named groups of a pattern.
fn named_groups(
    mut input: Input,
    pattern: Option<&Regex>,
    place: &str,
) -> Result<Input, BuildError> {
    let Some(pattern) = pattern else {
        return Ok(input);
    };
    let path = slashed(&input.file);
    let groups = pattern.captures(&path).ok_or_else(|| {
        let problem = format!("`{path}` does not match `{pattern}`; change it, or the globs");
        BuildError::plan(format!("{place}.pattern"), problem)
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
    parts.collect::<Vec<_>>().join("/")
}
