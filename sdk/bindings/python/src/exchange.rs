//! Imports files of other formats as textures, and exports textures to files of other formats.

use std::path::{Path, PathBuf};

use htex::format::{Quantity, UnknownName};
use htex_author::settings::{FitSettings, Metadata};
use htex_base::files::read_regular;
use htex_exchange::{
    Coding, ExchangeError, Export, FORMATS, Format, Import, MOST_BYTES, PROFILES, Physical,
    Profile, Stroke, Writes,
};
use htex_format::{license_file, read_license_file};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;
use pyo3::types::PyBytes;
use serde_json::json;

use crate::author::TOOL;
use crate::errors::{ExchangeError as Refused, IntoPyErr, of_file, option, raised};
use crate::models::registry;
use crate::python::{from_json, parsed};
use crate::reading::unknown;
use crate::texture::Texture;

/// Arguments of an import: what the imported file does not state, and how models are fitted to it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Importing {
    full_scale: Option<f64>,
    pitch_mm: Option<f64>,
    quantity: String,
    speed_mm_s: Option<f64>,
    force_n: Option<f64>,
    profile: Option<String>,
    /// JSON.
    settings: PyBackedStr,
    /// JSON.
    metadata: PyBackedStr,
    plugins: Vec<PathBuf>,
    installed: bool,
}

/// Arguments of an export.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Exporting {
    to: String,
    model: Option<String>,
    speed_mm_s: Option<f64>,
    force_n: Option<f64>,
    seconds: f64,
    stroke: Option<PathBuf>,
    profile: Option<String>,
    rate_hz: Option<f64>,
    coding: Option<String>,
    extension: Option<String>,
    seed: u64,
}

/// Returns the formats and the actuator profiles, as `htex formats --json` prints them.
#[pyfunction]
pub(crate) fn formats(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    from_json(py, &json!({ "formats": FORMATS, "profiles": &*PROFILES }))
}

/// Imports a file. Returns the texture, the warnings and the notes.
#[pyfunction]
pub(crate) fn import_file(
    py: Python<'_>,
    file: PathBuf,
    request: Importing,
) -> PyResult<(Texture, Vec<String>, Vec<String>)> {
    py.detach(|| request.import(&file))
}

/// Exports a texture. Returns the bytes of the file, and a description of what is lost.
#[pyfunction]
pub(crate) fn export<'py>(
    py: Python<'py>,
    texture: PyRef<'py, Texture>,
    request: Exporting,
) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyAny>)> {
    let texture = &*texture;
    let exported = py.detach(|| request.export(texture))?;
    let bytes = PyBytes::new(py, &exported.bytes);
    Ok((bytes, from_json(py, &exported)?))
}

impl Importing {
    fn import(self, file: &Path) -> PyResult<(Texture, Vec<String>, Vec<String>)> {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        // Only checks the name, so that an unknown format is reported before an invalid setting.
        Format::of_file(&name).map_err(raised)?;
        let metadata: Metadata = parsed(&self.metadata)?;
        metadata.check().map_err(|error| option(error.to_string()))?;
        let fit: FitSettings = parsed(&self.settings)?;
        let quantity: Quantity = self.quantity.parse().map_err(|error: UnknownName| {
            unknown(error.what, &error.name, &error.known.join(", "))
        })?;
        let profile = self.profile.as_deref();
        let beside =
            read_license_file(file).map_err(|error| of_file(&license_file(file), &error))?;
        let how = Import {
            name: &stem,
            physical: Physical {
                full_scale: self.full_scale,
                quantity,
                speed_mm_s: self.speed_mm_s,
                force_n: self.force_n,
                pitch_mm: self.pitch_mm,
            },
            profile: profile.map(Profile::find).transpose().map_err(raised)?,
            fit,
            metadata,
            license_file: beside.as_deref(),
            tool: TOOL,
        };
        let bytes = read_regular(file, MOST_BYTES).map_err(|error| of_file(file, &error))?;
        let registry = registry(&self.plugins, self.installed)?;
        let imported = htex_exchange::import(&name, &bytes, &how, &registry).map_err(raised)?;
        let written = imported.to_bytes().map_err(raised)?;
        let texture = Texture::of_bytes(&written, self.plugins, self.installed)?;
        let texts =
            |all: &[htex_base::finding::Notice]| all.iter().map(ToString::to_string).collect();
        Ok((texture, texts(&imported.warnings), texts(&imported.notes)))
    }
}

impl Exporting {
    fn export(&self, texture: &Texture) -> PyResult<htex_exchange::ExportedFile> {
        let format = Format::find_for_export(&self.to).map_err(raised)?;
        let mut export = Export::new(format);
        export.path = self.path(texture)?;
        export.model = self.model.as_deref();
        let profile = self.profile.as_deref();
        export.profile = profile.map(Profile::find).transpose().map_err(raised)?;
        export.seconds = self.seconds;
        export.rate_hz = self.rate_hz;
        export.seed = self.seed;
        export.extension = self.extension.as_deref();
        export.coding = self.coding.as_deref().map(Coding::find).transpose().map_err(raised)?;
        let file = match format.writes {
            Some(Writes::Asset(_)) => Some(texture.bytes()?),
            _ => None,
        };
        export.file = file.as_deref();
        htex_exchange::export(texture.asset(), &export).map_err(raised)
    }

    fn path(&self, texture: &Texture) -> PyResult<htex_exchange::Path> {
        match &self.stroke {
            // The caller has checked that there is no speed and no force besides the stroke.
            Some(file) => Ok(htex_exchange::Path::Stroke(Stroke::open(file).map_err(raised)?)),
            None => {
                let (asset, model) = (texture.asset(), self.model.as_deref());
                htex_exchange::Path::at(asset, model, self.speed_mm_s, self.force_n).map_err(raised)
            }
        }
    }
}

impl IntoPyErr for ExchangeError {
    fn into_py_err(self) -> PyErr {
        match self {
            Self::Play(error) => error.into_py_err(),
            Self::Author(error) => error.into_py_err(),
            Self::File { .. } => Refused::new_err(self.to_string()),
            other => option(other.message_with(&keyword)),
        }
    }
}

/// Returns the Python keyword for a setting.
fn keyword(setting: &str) -> String {
    let name = match setting {
        "speed" => "speed_mm_s",
        "force" => "force_n",
        "pitch" => "pitch_mm",
        "rate" => "rate_hz",
        other => other,
    };
    format!("`{name}`")
}
