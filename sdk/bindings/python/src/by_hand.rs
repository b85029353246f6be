//! Makes textures without recordings: from parameters, by interpolation between two textures, or by
//! changing the metadata of a texture.

use std::collections::BTreeMap;
use std::path::PathBuf;

use htex::format::{Quantity, UnknownName};
use htex_author::by_hand::{self, ByHand, MixedAsset};
use htex_author::edit as edited;
use htex_author::settings::{GivenFluctuation, Metadata};
use htex_format::Condition;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;

use crate::author::TOOL;
use crate::errors::{option, raised};
use crate::models::registry;
use crate::python::parsed;
use crate::reading::{Pair, unknown};
use crate::texture::Texture;

/// Arguments for making a texture from parameters: keywords of the package's function `make`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct ByHandTexture {
    model: String,
    /// Values by name of the parameter.
    parameters: BTreeMap<String, Vec<f64>>,
    level_rms: f64,
    at: Pair,
    quantity: String,
    /// The strengths of the slow and the fast fluctuation, decibels.
    fluctuation: Option<(f64, f64)>,
    /// JSON.
    metadata: PyBackedStr,
    plugins: Vec<PathBuf>,
    installed: bool,
}

/// Makes a texture from parameters.
#[pyfunction]
pub(crate) fn make(py: Python<'_>, made: ByHandTexture) -> PyResult<Texture> {
    py.detach(|| made.texture())
}

/// Makes a texture between two others. `weight` is the share of the second, 0 to 1.
#[pyfunction]
pub(crate) fn mix(
    py: Python<'_>,
    a: PyRef<'_, Texture>,
    b: PyRef<'_, Texture>,
    weight: f64,
    metadata: &str,
) -> PyResult<Texture> {
    let (a, b) = (&*a, &*b);
    py.detach(|| {
        let metadata = checked(metadata)?;
        let hashes = [hash(a)?, hash(b)?];
        let mixed = by_hand::mix(
            MixedAsset { asset: a.asset(), blake3: &hashes[0] },
            MixedAsset { asset: b.asset(), blake3: &hashes[1] },
            weight,
            metadata.name.as_deref().unwrap_or("mix"),
            TOOL,
        );
        let mut asset = mixed.map_err(raised)?;
        metadata.apply(&mut asset.manifest);
        a.made_of(&asset, &[b])
    })
}

/// Returns a texture with other metadata or another fluctuation.
#[pyfunction]
pub(crate) fn edit(
    py: Python<'_>,
    texture: PyRef<'_, Texture>,
    metadata: &str,
    fluctuation: Option<(f64, f64)>,
) -> PyResult<Texture> {
    let texture = &*texture;
    py.detach(|| {
        let metadata = checked(metadata)?;
        let fluctuation = given(fluctuation)?;
        if metadata.is_empty() && fluctuation.is_none() {
            return Err(option(
                "nothing to change: give at least one of the metadata, such as author",
            ));
        }
        let mut asset = edited(&texture.bytes()?, &metadata).map_err(raised)?;
        if let Some(fluctuation) = fluctuation {
            fluctuation.apply(&mut asset.manifest);
        }
        texture.made_of(&asset, &[])
    })
}

impl ByHandTexture {
    fn texture(self) -> PyResult<Texture> {
        let metadata = checked(&self.metadata)?;
        let fluctuation = given(self.fluctuation)?;
        let registry = registry(&self.plugins, self.installed)?;
        let model = registry.find(&self.model).map_err(raised)?;
        let quantity: Quantity = self.quantity.parse().map_err(|error: UnknownName| {
            unknown(error.what, &error.name, &error.known.join(", "))
        })?;
        let name = metadata.name.as_deref().unwrap_or("texture");
        let (speed_mm_s, force_n) = self.at;
        let mut texture = ByHand::new(name, self.level_rms, TOOL)
            .with_condition(Condition { speed_mm_s, force_n, ..Condition::default() })
            .with_quantity(quantity);
        texture.values = self.parameters;
        let mut asset = by_hand::make(model, &texture).map_err(raised)?;
        metadata.apply(&mut asset.manifest);
        if let Some(fluctuation) = fluctuation {
            fluctuation.apply(&mut asset.manifest);
        }
        Texture::from_asset(&asset, self.plugins, self.installed)
    }
}

/// Parses metadata, and returns an error if it would make the asset invalid.
fn checked(metadata: &str) -> PyResult<Metadata> {
    let metadata: Metadata = parsed(metadata)?;
    let checked = metadata.check();
    checked.map_err(|error| option(error.to_string()))?;
    Ok(metadata)
}

/// Checks the strengths of a fluctuation.
fn given(strength_db: Option<(f64, f64)>) -> PyResult<Option<GivenFluctuation>> {
    let given = strength_db.map(|(slow, fast)| GivenFluctuation::new([slow, fast]));
    given.transpose().map_err(|error| option(format!("fluctuation: {error}")))
}

fn hash(texture: &Texture) -> PyResult<String> {
    Ok(blake3::hash(&texture.bytes()?).to_hex().to_string())
}
