//! Textures: open assets.

use std::path::{Path, PathBuf};

use htex::format::{Asset, write_file};
use htex::library::split_address;
use htex::play::{Effects, Parameter, Synthesis};
use htex::{Motion, Representation, VoiceOptions};
use htex_author::{SpectrumRef, read_spectrum};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyTuple};

use crate::errors::{of_file, option, raised};
use crate::library::open_file;
use crate::models::registry;
use crate::path::located;
use crate::python::{data, from_json, spectrum};
use crate::signed::{Keys, Signed};
use crate::voice::Voice;

/// A texture: an open asset (a .htex file), and the models that play it.
#[pyclass(frozen, module = "htex")]
pub(crate) struct Texture {
    asset: htex::Texture,
    plugins: Vec<PathBuf>,
    embedded: bool,
    installed: bool,
}

/// Opens a texture from a path, bytes, or an object with the method `read`. A texture of a library
/// is `cloth.htexlib#woven/cotton`, with a path or a URI of the library.
#[pyfunction]
#[pyo3(signature = (source, *, plugins=Vec::new(), embedded=true, installed=false, only_signed_by=None, signature=None))]
pub(crate) fn open(
    py: Python<'_>,
    source: &Bound<'_, PyAny>,
    plugins: Vec<PathBuf>,
    embedded: bool,
    installed: bool,
    only_signed_by: Option<Keys>,
    signature: Option<Vec<u8>>,
) -> PyResult<Texture> {
    let signed = Signed::new(only_signed_by, signature)?;
    let opened = Source::from_python(source)?;
    py.detach(|| {
        let data = match &opened {
            Source::File(path) => match path.to_str().and_then(split_address) {
                Some((library, name)) => {
                    let library = open_file(library.as_ref(), &signed)?;
                    let bytes = library.get(name).map_err(raised)?;
                    Asset::from_bytes(&bytes).map_err(raised)?
                }
                None => signed.open(path)?,
            },
            Source::Bytes(bytes) => signed.read(bytes)?,
        };
        Texture::new(data, plugins, embedded, installed)
    })
}

/// A file, or the bytes of a file.
pub(crate) enum Source {
    File(PathBuf),
    Bytes(Vec<u8>),
}

impl Source {
    /// Reads an argument: a path, bytes, or an object with the method `read`, which is called.
    pub(crate) fn from_python(source: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(bytes) = source.cast::<PyBytes>() {
            return Ok(Self::Bytes(bytes.as_bytes().to_vec()));
        }
        if let Ok(path) = source.extract::<PathBuf>() {
            return Ok(Self::File(path));
        }
        let read =
            if source.hasattr("read")? { source.call_method0("read")? } else { source.clone() };
        // Only objects with a buffer are passed to `bytes`, because it would turn a number or a
        // text into something else.
        let is_buffer =
            read.cast::<PyBytes>().is_ok() || is_named(&read, &["bytearray", "memoryview"])?;
        if !is_buffer {
            let class = read.get_type().name()?;
            let text =
                format!("expected a path, bytes or a file opened in binary mode, got {class}");
            return Err(PyTypeError::new_err(text));
        }
        let bytes = read.py().import("builtins")?.call_method1("bytes", (read,))?;
        Ok(Self::Bytes(bytes.cast::<PyBytes>()?.as_bytes().to_vec()))
    }
}

fn is_named(value: &Bound<'_, PyAny>, names: &[&str]) -> PyResult<bool> {
    let class = value.get_type().name()?;
    Ok(names.iter().any(|name| class == *name))
}

impl Texture {
    /// Makes a texture from an asset's data.
    pub(crate) fn new(
        data: Asset,
        plugins: Vec<PathBuf>,
        embedded: bool,
        installed: bool,
    ) -> PyResult<Self> {
        let asset = htex::Texture::with_registry(data, registry(&plugins, installed)?);
        Ok(Self {
            asset: if embedded { asset.with_embedded() } else { asset },
            plugins,
            embedded,
            installed,
        })
    }

    /// Makes a texture from a new asset as its file stores it. In a file, levels and errors have
    /// fewer digits than in memory.
    pub(crate) fn from_asset(
        made: &Asset,
        plugins: Vec<PathBuf>,
        installed: bool,
    ) -> PyResult<Self> {
        Self::new(stored(made)?, plugins, true, installed)
    }

    /// Makes a texture from the bytes of an asset file.
    pub(crate) fn of_bytes(bytes: &[u8], plugins: Vec<PathBuf>, installed: bool) -> PyResult<Self> {
        Self::new(Asset::from_bytes(bytes).map_err(raised)?, plugins, true, installed)
    }

    /// Makes a texture from an asset that was made from this texture and `others`. The new texture
    /// runs embedded models only if all of these textures do.
    pub(crate) fn made_of(&self, made: &Asset, others: &[&Self]) -> PyResult<Self> {
        let embedded = self.embedded && others.iter().all(|other| other.embedded);
        Self::new(stored(made)?, self.plugins.clone(), embedded, self.installed)
    }

    pub(crate) fn asset(&self) -> &htex::Texture {
        &self.asset
    }

    fn representation(&self, model: Option<&str>) -> PyResult<Representation<'_>> {
        self.asset.representation(model).map_err(raised)
    }

    /// Returns the motion at a condition. A missing value comes from the default condition.
    fn motion(&self, model: Option<&str>, at: Option<At>) -> PyResult<Option<Motion>> {
        match at {
            None | Some(At { speed_mm_s: None, force_n: None }) => Ok(None),
            Some(At { speed_mm_s, force_n }) => {
                Ok(Some(self.representation(model)?.motion(speed_mm_s, force_n)))
            }
        }
    }

    pub(crate) fn bytes(&self) -> PyResult<Vec<u8>> {
        self.asset.data().to_bytes().map_err(raised)
    }
}

/// A speed and a force, given as a `Condition` or as a pair of numbers or `None`.
#[derive(Clone, Copy)]
pub(crate) struct At {
    speed_mm_s: Option<f64>,
    force_n: Option<f64>,
}

impl<'py> FromPyObject<'_, 'py> for At {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let (speed_mm_s, force_n) = if value.hasattr("speed_mm_s")? {
            (value.getattr("speed_mm_s")?.extract()?, value.getattr("force_n")?.extract()?)
        } else {
            value.extract()?
        };
        Ok(Self { speed_mm_s, force_n })
    }
}

#[pymethods]
impl Texture {
    /// Name of the texture.
    #[getter]
    fn name(&self) -> &str {
        &self.asset.manifest().name
    }

    /// Physical quantity of the samples, such as `lateral_force`.
    #[getter]
    fn quantity(&self) -> &'static str {
        self.asset.quantity().name()
    }

    /// Unit of the samples, such as `N`.
    #[getter]
    fn unit(&self) -> &'static str {
        self.asset.quantity().unit()
    }

    /// Lowest and highest frequency of the band, hertz.
    #[getter]
    fn band_hz(&self) -> (f64, f64) {
        self.asset.band().edges()
    }

    /// Everything that the asset's manifest states, as a dict.
    #[getter]
    fn manifest<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        from_json(py, self.asset.manifest())
    }

    /// The conditions at which the texture was recorded.
    #[getter]
    fn conditions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        for condition in &self.asset.manifest().conditions {
            let fields = PyDict::new(py);
            fields.set_item("speed_mm_s", condition.speed_mm_s)?;
            fields.set_item("force_n", condition.force_n)?;
            fields.set_item("repeatability_rms_db", condition.repeatability_rms_db)?;
            fields.set_item(
                "repeatability_third_octave_rms_db",
                condition.repeatability_third_octave_rms_db,
            )?;
            fields.set_item("segments", condition.segments)?;
            list.append(data(py, "Condition", &fields)?)?;
        }
        Ok(list)
    }

    /// What slid over the surface: `finger`, `tool` or `unknown`.
    #[getter]
    fn contact(&self) -> &'static str {
        self.asset.manifest().contact.name()
    }

    /// How frequencies and level change with speed and force outside the recorded conditions: the
    /// exponents of the law, by name.
    #[getter]
    fn law<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let law = PyDict::new(py);
        for (name, exponent) in self.asset.manifest().law().exponents() {
            let fields = PyDict::new(py);
            fields.set_item("exponent", exponent.exponent)?;
            fields.set_item("source", exponent.source.name())?;
            fields.set_item("estimate", exponent.estimate)?;
            fields.set_item("standard_error", exponent.standard_error)?;
            law.set_item(name, data(py, "Exponent", &fields)?)?;
        }
        Ok(law)
    }

    /// The model id of each representation.
    #[getter]
    fn models(&self) -> Vec<&str> {
        let all = &self.asset.manifest().representations;
        all.iter().map(|r| r.model.as_str()).collect()
    }

    /// Returns the spectrum of a representation at a condition.
    #[pyo3(signature = (frequency_hz=None, model=None, at=None))]
    fn spectrum<'py>(
        &self,
        py: Python<'py>,
        frequency_hz: Option<Vec<f64>>,
        model: Option<&str>,
        at: Option<At>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let frequency_hz = frequency_hz.unwrap_or_else(|| self.asset.band().grid_hz());
        let motion = self.motion(model, at)?;
        let representation = self.representation(model)?;
        let magnitude = py.detach(|| representation.magnitude(motion, &frequency_hz));
        let (quantity, band) = (self.asset.quantity(), self.asset.band());
        spectrum(py, quantity, band, frequency_hz, magnitude.map_err(raised)?)
    }

    /// Returns the spectrum that a recording of a representation's voice would show at a recorded
    /// condition.
    #[pyo3(signature = (model=None, condition=None))]
    fn read_spectrum<'py>(
        &self,
        py: Python<'py>,
        model: Option<&str>,
        condition: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let representation = self.representation(model)?;
        let condition = condition.unwrap_or_else(|| representation.default_condition());
        let known = self.asset.manifest().conditions.get(condition);
        let known =
            known.ok_or_else(|| option(format!("condition is {condition}; there is none")))?;
        let motion =
            known.speed_mm_s.zip(known.force_n).map(|(speed, force)| Motion::new(speed, force));
        let (quantity, band) = (self.asset.quantity(), self.asset.band());
        let (parameters, _) = representation.parameters(motion).map_err(raised)?;
        let level = representation.level_rms(motion).map_err(raised)?;
        let loaded = representation.model().map_err(raised)?;
        let (frequency_hz, silent) = (band.grid_hz(), vec![0.0; band.bins()]);
        let grid = SpectrumRef { band, frequency_hz: &frequency_hz, magnitude: &silent };
        let read = py.detach(|| read_spectrum(&loaded, &parameters, level, grid));
        spectrum(py, quantity, band, frequency_hz.clone(), read.map_err(raised)?)
    }

    /// Returns the level of a representation at a condition: the RMS within the band, in the unit
    /// of the samples.
    #[pyo3(signature = (model=None, at=None))]
    fn level(&self, py: Python<'_>, model: Option<&str>, at: Option<At>) -> PyResult<f64> {
        let motion = self.motion(model, at)?;
        let representation = self.representation(model)?;
        py.detach(|| representation.level_rms(motion)).map_err(raised)
    }

    /// Returns the parameters of a representation at a condition, by name.
    #[pyo3(signature = (model=None, at=None))]
    fn parameters<'py>(
        &self,
        py: Python<'py>,
        model: Option<&str>,
        at: Option<At>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let motion = self.motion(model, at)?;
        let representation = self.representation(model)?;
        let all = py.detach(|| representation.named_parameters(motion)).map_err(raised)?;
        let named = PyDict::new(py);
        for (name, parameter) in all {
            match parameter {
                Parameter::Number(number) => named.set_item(name, number)?,
                Parameter::List(list) => named.set_item(name, list)?,
            }
        }
        Ok(named)
    }

    /// Writes the asset to a file. If this fails, no incomplete file remains.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| write(&path, &self.bytes()?))
    }

    /// Returns the bytes of the asset's file.
    pub(crate) fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.bytes())?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Makes a voice, which plays the texture.
    #[pyo3(signature = (model=None, rate_hz=20_000.0, seed=0, speed_mm_s=None, force_n=None, position_mm=None,
                        synthesis="streamed", *, x_mm=None, y_mm=None, frequency_scaling=true, level_scaling=true,
                        contact=true, ceiling=4.0, gain=1.0, limit=None, envelope_bands=0,
                        fluctuation=false))]
    #[allow(clippy::too_many_arguments)]
    fn voice(
        &self,
        py: Python<'_>,
        model: Option<&str>,
        rate_hz: f64,
        seed: u64,
        speed_mm_s: Option<f64>,
        force_n: Option<f64>,
        position_mm: Option<f64>,
        synthesis: &str,
        x_mm: Option<f64>,
        y_mm: Option<f64>,
        frequency_scaling: bool,
        level_scaling: bool,
        contact: bool,
        ceiling: f64,
        gain: f64,
        limit: Option<f64>,
        envelope_bands: usize,
        fluctuation: bool,
    ) -> PyResult<Voice> {
        check_rate(rate_hz)?;
        let at = At { speed_mm_s, force_n };
        let motion = self.motion(model, Some(at))?;
        let motion = match motion {
            Some(motion) => Some(located(motion, position_mm, [x_mm, y_mm])?),
            None if [position_mm, x_mm, y_mm].iter().any(Option::is_some) => {
                let text = "a position or a place needs a motion: give speed_mm_s, force_n or both";
                return Err(option(text));
            }
            None => None,
        };
        let options = VoiceOptions::default()
            .with_rate_hz(rate_hz)
            .with_seed(seed)
            .with_motion(motion)
            .with_synthesis(synthesis.parse::<Synthesis>().map_err(raised)?)
            .with_ceiling(ceiling)
            .with_gain(gain)
            .with_limit(limit)
            .with_envelope_bands(envelope_bands)
            .with_fluctuation(fluctuation)
            .with_effects(
                Effects::default()
                    .with_frequency_scaling(frequency_scaling)
                    .with_level_scaling(level_scaling)
                    .with_contact(contact),
            );
        let representation = self.representation(model)?;
        let id = representation.id().to_owned();
        let voice = py.detach(|| representation.voice(&options)).map_err(raised)?;
        let unit = self.asset.quantity().unit();
        Ok(Voice::new(voice, id, rate_hz, seed, unit))
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let reopen = py.import("htex._data")?.getattr("_reopen")?;
        let bytes = self.to_bytes(py)?;
        let arguments = (bytes, self.plugins.clone(), self.embedded, self.installed);
        Ok((reopen, arguments.into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        let (name, quantity) = (self.name(), self.quantity());
        let models: Vec<&str> = self.models().iter().map(|id| short(id)).collect();
        let conditions = self.asset.manifest().conditions.len();
        format!(
            "<htex.Texture {name:?}: {quantity} in {}, {conditions} condition(s), models {}>",
            self.unit(),
            models.join(", ")
        )
    }
}

/// Returns a new asset as its file stores it.
fn stored(made: &Asset) -> PyResult<Asset> {
    Asset::from_bytes(&made.to_bytes().map_err(raised)?).map_err(raised)
}

/// Returns the last part of a model's id.
pub(crate) fn short(id: &str) -> &str {
    id.rsplit('.').next().unwrap_or(id)
}

/// Writes a file. If this fails, no incomplete file remains.
#[pyfunction(name = "write_file")]
pub(crate) fn write_content(py: Python<'_>, path: PathBuf, content: &[u8]) -> PyResult<()> {
    py.detach(|| write(&path, content))
}

#[allow(clippy::disallowed_methods, reason = "the user named this file")]
fn write(path: &Path, bytes: &[u8]) -> PyResult<()> {
    write_file(path, bytes).map_err(|error| of_file(path, &error))
}

/// Returns an error for a sample rate that the command also refuses.
fn check_rate(rate_hz: f64) -> PyResult<()> {
    if (100.0..=1e6).contains(&rate_hz) {
        Ok(())
    } else {
        Err(option(format!("rate_hz is {rate_hz}; 100 to 1,000,000 Hz are allowed")))
    }
}
