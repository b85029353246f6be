//! Libraries: one file with thousands of textures.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use htex::format::Asset;
use htex::library::storage::{Location, Storage};
use htex::library::{
    Entry, Interval, LibraryDifference, LibraryError, LibraryFile, LibraryMetadata,
    LibrarySource as Bytes, Query, Writer,
};
use htex_author::settings::Metadata;
use htex_build::{Addition, BuildError, LibraryEdit, LibraryMerge, OnConflict};
use htex_format::{Quantity, UnknownName};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::errors::{IntoPyErr, LibraryError as Raised, SignatureError, of_file, option, raised};
use crate::python::{data, parsed};
use crate::signed::{Keys, Signed};
use crate::texture::{Source, Texture};

/// A library: a single file with thousands of textures. A texture is read only when it is
/// requested.
#[pyclass(frozen, module = "htex")]
pub(crate) struct Library {
    library: htex::library::Library<Origin>,
    plugins: Vec<PathBuf>,
    embedded: bool,
    installed: bool,
}

/// Where the bytes of a library come from: a local or remote file, or memory.
pub(crate) enum Origin {
    File(LibraryFile),
    Memory(Vec<u8>),
}

impl Bytes for Origin {
    fn len(&self) -> std::io::Result<u64> {
        match self {
            Self::File(file) => file.len(),
            Self::Memory(bytes) => Bytes::len(bytes),
        }
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> std::io::Result<usize> {
        match self {
            Self::File(file) => file.read_at(offset, buffer),
            Self::Memory(bytes) => bytes.read_at(offset, buffer),
        }
    }
}

/// Opens a library at a path or a URI, if it is signed as required.
pub(crate) fn open_file(path: &OsStr, signed: &Signed) -> PyResult<htex::library::Library<Origin>> {
    let opened = || {
        let (storage, location) = (Storage::from_environment()?, Location::parse(path)?);
        let file = Origin::File(LibraryFile::open(&storage, &location)?);
        let library = htex::library::Library::open_source(file)?;
        Ok::<_, LibraryError>((storage, location, library))
    };
    let (storage, location, library) = opened().map_err(raised)?;
    signed.check(&library, Some((&storage, &location)))?;
    Ok(library)
}

impl IntoPyErr for LibraryError {
    fn into_py_err(self) -> PyErr {
        match self {
            Self::Open { path, error } | Self::Write { path, error } => of_file(&path, &error),
            Self::Read { ref error, .. } if error.raw_os_error().is_some() => {
                std::io::Error::new(error.kind(), self.to_string()).into()
            }
            Self::Absent { name, .. } => PyKeyError::new_err(name),
            Self::Signature(_) => SignatureError::new_err(self.to_string()),
            Self::Asset { error, .. } => error.into_py_err(),
            other => Raised::new_err(other.to_string()),
        }
    }
}

impl IntoPyErr for BuildError {
    fn into_py_err(self) -> PyErr {
        Raised::new_err(self.to_string())
    }
}

#[pymethods]
impl Library {
    #[new]
    #[pyo3(signature = (source, *, plugins=Vec::new(), embedded=true, installed=false, only_signed_by=None, signature=None))]
    #[allow(clippy::too_many_arguments, reason = "the keywords of a Python function")]
    fn open(
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        plugins: Vec<PathBuf>,
        embedded: bool,
        installed: bool,
        only_signed_by: Option<Keys>,
        signature: Option<Vec<u8>>,
    ) -> PyResult<Self> {
        let signed = Signed::new(only_signed_by, signature)?;
        let source = Source::from_python(source)?;
        let library = py.detach(|| match source {
            Source::File(path) => open_file(path.as_os_str(), &signed),
            Source::Bytes(bytes) => {
                let opened = htex::library::Library::open_source(Origin::Memory(bytes));
                let library = opened.map_err(raised)?;
                signed.check(&library, None)?;
                Ok(library)
            }
        })?;
        Ok(Self { library, plugins, embedded, installed })
    }

    /// Name of the library; may be empty.
    #[getter]
    fn name(&self) -> &str {
        self.library.name()
    }

    /// Names of all textures, in ascending order.
    #[getter]
    fn names(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let entries = py.detach(|| self.matching(&Query::default()))?;
        Ok(entries.into_iter().map(|entry| entry.name).collect())
    }

    /// The entries of all textures, in ascending order of their names.
    #[getter]
    fn entries<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let entries = py.detach(|| self.matching(&Query::default()))?;
        entries.iter().map(|entry| entry_data(py, entry)).collect()
    }

    /// What the library says about itself: a dict of the entries that it states.
    #[getter]
    fn metadata<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        // Texts always become JSON.
        let json = serde_json::to_string(self.library.metadata()).unwrap_or_default();
        py.import("json")?.call_method1("loads", (json,))
    }

    /// Returns what `htex lib info --json` prints: what the library says about itself, and the number
    /// of textures of each licence, quantity, model, contact and tag. Reads the index.
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let summary = py.detach(|| self.library.summary()).map_err(raised)?;
        // Texts and numbers always become JSON.
        let json = serde_json::to_string(&summary).unwrap_or_default();
        py.import("json")?.call_method1("loads", (json,))
    }

    /// BLAKE3 hash of the index, hexadecimal. It names the library.
    #[getter]
    fn blake3(&self) -> String {
        blake3::Hash::from_bytes(self.library.index().blake3()).to_hex().to_string()
    }

    /// Returns the entries of the textures that match all the given criteria.
    #[allow(clippy::too_many_arguments, reason = "the keywords of a Python function")]
    #[pyo3(signature = (*words, tags=Vec::new(), speed_mm_s=None, force_n=None, model=None, license=None, author=None, quantity=None, max_felt_db=None, max_held_out_db=None))]
    fn find<'py>(
        &self,
        py: Python<'py>,
        words: &Bound<'py, PyTuple>,
        tags: Vec<String>,
        speed_mm_s: Option<f64>,
        force_n: Option<f64>,
        model: Option<String>,
        license: Option<String>,
        author: Option<String>,
        quantity: Option<&str>,
        max_felt_db: Option<f64>,
        max_held_out_db: Option<f64>,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let quantity = quantity.map(str::parse).transpose();
        let query = Query {
            words: words.extract()?,
            tags,
            speed_mm_s,
            force_n,
            model,
            license,
            author,
            quantity: quantity.map_err(|error: UnknownName| option(error.to_string()))?,
            felt_error_rms_db: max_felt_db,
            held_out_error_db: max_held_out_db,
        };
        let entries = py.detach(|| self.matching(&query))?;
        entries.iter().map(|entry| entry_data(py, entry)).collect()
    }

    /// Returns the textures whose spectra are nearest to the spectrum of a texture of this library.
    /// The result contains pairs of a distance in decibels and an entry, the nearest texture first.
    #[pyo3(signature = (name, count=10))]
    fn similar<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        count: usize,
    ) -> PyResult<Vec<(f64, Bound<'py, PyAny>)>> {
        let found = py.detach(|| {
            let entry = self.library.needed(name)?;
            let spectrum = self.library.description(&entry)?.spectrum;
            match spectrum.zip(entry.quantity) {
                Some((spectrum, quantity)) => {
                    self.library.similar(&spectrum, quantity, &Query::default(), count)
                }
                None => Ok(Vec::new()),
            }
        });
        let found = found.map_err(raised)?;
        found.iter().map(|one| Ok((one.distance_db, entry_data(py, &one.entry)?))).collect()
    }

    /// Returns the textures whose spectra nearly equal the spectrum of an earlier texture. For
    /// each, returns its name, the name of the earlier texture, and the distance in decibels.
    #[pyo3(signature = (within_db=0.5))]
    fn duplicates(&self, py: Python<'_>, within_db: f64) -> PyResult<Vec<(String, String, f64)>> {
        let found = py.detach(|| self.library.duplicates(&Query::default(), within_db));
        let found = found.map_err(raised)?.into_iter();
        Ok(found.map(|one| (one.entry.name, one.of, one.distance_db)).collect())
    }

    /// Compares this library with a newer one by names and hashes. Returns the names of the
    /// removed, added and changed textures, and the old and new name of each renamed texture.
    fn diff<'py>(&self, py: Python<'py>, newer: &Self) -> PyResult<Bound<'py, PyAny>> {
        let same = |error: LibraryError| error;
        let found =
            py.detach(|| LibraryDifference::between(&self.library, &newer.library, same, same));
        let LibraryDifference { removed, added, renamed, changed, .. } =
            found.map_err(raised)?.find_renamed();
        let named = |entries: Vec<Entry>| {
            entries.into_iter().map(|entry| entry.name).collect::<Vec<String>>()
        };
        let fields = PyDict::new(py);
        fields.set_item("removed", named(removed))?;
        fields.set_item("added", named(added))?;
        let renamed = renamed.into_iter().map(|(from, to)| (from.name, to.name));
        fields.set_item("renamed", renamed.collect::<Vec<_>>())?;
        fields.set_item("changed", named(changed.into_iter().map(|(a, _)| a).collect()))?;
        data(py, "LibraryDifference", &fields)
    }

    /// Returns the entry of the texture with this name.
    fn entry<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let entry = py
            .detach(|| self.library.entry(name))
            .map_err(raised)?
            .ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        entry_data(py, &entry)
    }

    /// Returns the bytes of a texture's `.htex` file.
    fn to_bytes<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.library.get(name)).map_err(raised)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Changes a library file: removes, renames and adds textures, and then sets metadata and tags.
    /// Writes the result to `output`, or replaces the library.
    #[staticmethod]
    #[allow(clippy::too_many_arguments, reason = "the keywords of a Python function")]
    #[pyo3(signature = (path, output=None, *, remove=Vec::new(), rename=BTreeMap::new(), add=BTreeMap::new(), add_libraries=Vec::new(), metadata=None, add_tags=Vec::new(), remove_tags=Vec::new(), filters=BTreeMap::new(), table=None, describe=None, unlicensed=false))]
    fn edit<'py>(
        py: Python<'py>,
        path: PathBuf,
        output: Option<PathBuf>,
        remove: Vec<String>,
        rename: BTreeMap<String, String>,
        add: BTreeMap<String, PathBuf>,
        add_libraries: Vec<PathBuf>,
        metadata: Option<Bound<'py, PyDict>>,
        add_tags: Vec<String>,
        remove_tags: Vec<String>,
        filters: BTreeMap<String, String>,
        table: Option<PathBuf>,
        describe: Option<BTreeMap<String, String>>,
        unlicensed: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let metadata: Metadata = match metadata {
            Some(given) => {
                let json = py.import("json")?.call_method1("dumps", (given,))?;
                parsed(json.extract()?)?
            }
            None => Metadata::default(),
        };
        metadata.check().map_err(raised)?;
        let textures = add.into_iter().map(|(name, file)| Addition::Texture { name, file });
        let libraries = add_libraries.into_iter().map(Addition::Library);
        let filters = filters.iter().map(|(field, value)| format!("{field}={value}").parse());
        let edit = LibraryEdit {
            remove: remove
                .iter()
                .map(|name| name.parse())
                .collect::<Result<_, _>>()
                .map_err(option)?,
            rename: rename.into_iter().collect(),
            add: textures.chain(libraries).collect(),
            metadata,
            add_tags,
            remove_tags,
            table,
            filters: filters.collect::<Result<_, String>>().map_err(option)?,
            library_metadata: match describe {
                Some(given) => {
                    let opened = htex::library::Library::open(&path).map_err(raised)?;
                    Some(described(opened.metadata(), given)?)
                }
                None => None,
            },
            allows_unlicensed: unlicensed,
        };
        let to = output.as_deref().unwrap_or(&path);
        let edited = py.detach(|| edit.run(&path, to, &|_| {})).map_err(raised)?;
        let fields = PyDict::new(py);
        for (name, count) in [
            ("removed", edited.removed),
            ("renamed", edited.renamed),
            ("added", edited.added),
            ("edited", edited.edited),
        ] {
            fields.set_item(name, count)?;
        }
        fields.set_item("textures", edited.packed.entries)?;
        fields.set_item("bytes", edited.packed.bytes)?;
        data(py, "LibraryChange", &fields)
    }

    /// Merges library files into one. `prefixes` has a text for each library, which is put before
    /// the names of its textures. Returns the size of the file, bytes.
    #[staticmethod]
    #[pyo3(signature = (paths, output, *, prefixes=Vec::new(), on_conflict="error", name="", describe=BTreeMap::new()))]
    fn merge(
        py: Python<'_>,
        paths: Vec<PathBuf>,
        output: PathBuf,
        prefixes: Vec<String>,
        on_conflict: &str,
        name: &str,
        describe: BTreeMap<String, String>,
    ) -> PyResult<u64> {
        if !prefixes.is_empty() && prefixes.len() != paths.len() {
            let text = format!(
                "{} prefixes for {} libraries; give one for each",
                prefixes.len(),
                paths.len()
            );
            return Err(option(text));
        }
        let prefixes = prefixes.into_iter().chain(std::iter::repeat(String::new()));
        let merge = LibraryMerge {
            libraries: paths.into_iter().zip(prefixes).collect(),
            on_conflict: match on_conflict {
                "error" => OnConflict::Error,
                "first" => OnConflict::First,
                "last" => OnConflict::Last,
                other => {
                    return Err(option(format!(
                        "on_conflict: {other:?} is none of error, first and last"
                    )));
                }
            },
            metadata: described(&LibraryMetadata::default(), describe)?,
        };
        Ok(py.detach(|| merge.run(&output, name)).map_err(raised)?.bytes)
    }

    fn __getitem__(&self, py: Python<'_>, name: &str) -> PyResult<Texture> {
        py.detach(|| {
            let bytes = self.library.get(name).map_err(raised)?;
            let data = Asset::from_bytes(&bytes).map_err(raised)?;
            Texture::new(data, self.plugins.clone(), self.embedded, self.installed)
        })
    }

    fn __contains__(&self, py: Python<'_>, name: &str) -> PyResult<bool> {
        let entry = py.detach(|| self.library.entry(name)).map_err(raised)?;
        Ok(entry.is_some())
    }

    fn __len__(&self) -> usize {
        usize::try_from(self.library.len()).unwrap_or(usize::MAX)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.names(py)?.into_pyobject(py)?.call_method0("__iter__")
    }

    fn __repr__(&self) -> String {
        let (name, count) = (self.library.name(), self.library.len());
        format!("<htex.Library {name:?}: {count} texture(s)>")
    }
}

impl Library {
    fn matching(&self, query: &Query) -> PyResult<Vec<Entry>> {
        let entries = self.library.entries();
        // Keeps an entry that cannot be read, so that `collect` returns its error.
        let matching = entries.filter(|entry| !matches!(entry, Ok(e) if !query.matches(e)));
        matching.collect::<Result<_, _>>().map_err(raised)
    }
}

/// Changes what a library says about itself.
fn described(
    before: &LibraryMetadata,
    given: BTreeMap<String, String>,
) -> PyResult<LibraryMetadata> {
    let mut metadata = before.clone();
    for (name, text) in given {
        metadata.set(&name, &text).map_err(option)?;
    }
    metadata.check().map_err(option)?;
    Ok(metadata)
}

/// Makes a `LibraryEntry`.
fn entry_data<'py>(py: Python<'py>, entry: &Entry) -> PyResult<Bound<'py, PyAny>> {
    let range = |interval: Option<Interval>| interval.map(|i| (i.min, i.max));
    let fields = PyDict::new(py);
    fields.set_item("name", &entry.name)?;
    fields.set_item("tags", PyTuple::new(py, &entry.tags)?)?;
    fields.set_item("models", PyTuple::new(py, &entry.models)?)?;
    fields.set_item("speed_mm_s", range(entry.conditions.speed_mm_s))?;
    fields.set_item("force_n", range(entry.conditions.force_n))?;
    fields.set_item("contact", entry.contact.name())?;
    let law = PyDict::new(py);
    for (name, one) in [
        ("frequency_speed", entry.law.frequency_speed),
        ("level_speed", entry.law.level_speed),
        ("level_force", entry.law.level_force),
    ] {
        let exponent = PyDict::new(py);
        exponent.set_item("exponent", one.exponent)?;
        exponent.set_item("source", one.source.name())?;
        law.set_item(name, data(py, "Exponent", &exponent)?)?;
    }
    fields.set_item("law", law)?;
    fields.set_item("license", entry.license.as_deref())?;
    fields.set_item("author", entry.author.as_deref())?;
    fields.set_item("quantity", entry.quantity.map(Quantity::name))?;
    fields.set_item("felt_error_rms_db", entry.felt_error_rms_db)?;
    fields.set_item("held_out_error_db", entry.held_out_error_db)?;
    fields.set_item("bytes", entry.bytes)?;
    fields.set_item("blake3", entry.blake3_hex())?;
    data(py, "LibraryEntry", &fields)
}

/// Packs textures into a library file. `textures` maps each name to a path, bytes, an object with
/// the method `read`, or a `Texture`. Each texture must state a licence, because libraries are
/// passed on to others. With `unlicensed=True`, textures without a licence are also packed.
/// `describe` says what the library is: version, description, authors, homepage, source, changelog
/// and date.
#[pyfunction]
#[pyo3(signature = (path, textures, *, name="", describe=BTreeMap::new(), unlicensed=false))]
pub(crate) fn pack(
    py: Python<'_>,
    path: PathBuf,
    textures: &Bound<'_, PyAny>,
    name: &str,
    describe: BTreeMap<String, String>,
    unlicensed: bool,
) -> PyResult<u64> {
    let mut writer = Writer::create(&path, name).map_err(raised)?;
    writer.describe_with(htex_author::describe);
    writer.set_metadata(described(&LibraryMetadata::default(), describe)?);
    if unlicensed {
        writer.allow_unlicensed();
    }
    for pair in textures.call_method0("items")?.try_iter()? {
        let (name, texture): (String, Bound<'_, PyAny>) = pair?.extract()?;
        let bytes = texture_bytes(py, &texture)?;
        py.detach(|| writer.add(&name, &bytes)).map_err(raised)?;
    }
    let packed = py.detach(|| writer.finish()).map_err(raised)?;
    Ok(packed.bytes)
}

fn texture_bytes(py: Python<'_>, texture: &Bound<'_, PyAny>) -> PyResult<Vec<u8>> {
    if let Ok(texture) = texture.cast::<Texture>() {
        return Ok(texture.get().to_bytes(py)?.as_bytes().to_vec());
    }
    match Source::from_python(texture)? {
        Source::Bytes(bytes) => Ok(bytes),
        Source::File(path) => read(&path),
    }
}

fn read(path: &Path) -> PyResult<Vec<u8>> {
    std::fs::read(path).map_err(|error| of_file(path, &error))
}
