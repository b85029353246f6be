//! Makes textures without recordings: from parameters, between two other textures, or with other
//! metadata and extensions.

use std::collections::BTreeMap;

use htex::format::{Quantity, UnknownName};
use htex::model::Band;
use htex::model::Registry;
use htex_author::by_hand::{self, ByHandAt, ByHandModel, ByHandModels, MixedAsset};
use htex_author::settings::Metadata;
use htex_format::{Asset, Condition, is_extension_name};
use serde_json::{Map, Value};

use super::TOOL;
use crate::answer::{Answer, Files};
use crate::document::{Document, number};
use crate::refusal::Refusal;

fn metadata(mut given: Document) -> Result<Metadata, Refusal> {
    let metadata: Metadata = given.table(Metadata::NAMES)?;
    given.finish()?;
    metadata.check()?;
    Ok(metadata)
}

/// Takes the extensions that are set, and those that are removed by `null`.
fn extensions(call: &mut Document) -> Result<Map<String, Value>, Refusal> {
    let given = call.map("extensions")?;
    match given.keys().find(|name| !is_extension_name(name)) {
        None => Ok(given),
        Some(name) => Err(Refusal::argument(format!(
            "the extension {name}: give a name such as com.vendor.NAME/1"
        ))),
    }
}

fn answer(asset: &Asset) -> Result<Answer, Refusal> {
    Answer::new(&(), asset.to_bytes()?)
}

/// Makes a texture from parameters. The bytes of the answer are the asset.
pub(crate) fn make(mut call: Document, _: Files<'_>) -> Result<Answer, Refusal> {
    let registry = Registry::builtin();
    let models = call
        .list("representations")?
        .into_iter()
        .map(|value| model(value, &registry))
        .collect::<Result<_, _>>()?;
    let quantity = quantity(call.text("quantity")?)?;
    let band = band(&call.list("band")?)?;
    let metadata = metadata(call.object("metadata")?)?;
    let extensions = extensions(&mut call)?;
    call.finish()?;
    let name = metadata.name.clone();
    let mut asset = by_hand::make_all(&ByHandModels {
        name: name.unwrap_or_else(|| "texture".to_owned()),
        models,
        quantity,
        band,
        tool: TOOL.to_owned(),
    })?;
    metadata.apply(&mut asset.manifest);
    asset.manifest.set_extensions(extensions);
    answer(&asset)
}

pub(crate) fn quantity(name: Option<String>) -> Result<Quantity, Refusal> {
    let Some(name) = name else {
        return Ok(Quantity::default());
    };
    name.parse().map_err(|error: UnknownName| Refusal::argument(error.to_string()))
}

fn band(edges: &[Value]) -> Result<Band, Refusal> {
    let [low, high] = edges else {
        return if edges.is_empty() {
            Ok(Band::TACTILE)
        } else {
            Err(Refusal::argument("a band has two edges, Hz"))
        };
    };
    match (number(low), number(high)) {
        (Some(low_hz), Some(high_hz)) => Ok(Band { low_hz, high_hz }),
        _ => Err(Refusal::argument("the edges of a band are numbers, Hz")),
    }
}

/// Reads a model with its parameters at its conditions.
fn model(value: Value, registry: &Registry) -> Result<ByHandModel, Refusal> {
    let mut given = Document::from_value(value)?;
    let name = given.text("model")?.unwrap_or_default();
    let at = given.list("conditions")?.into_iter().map(at).collect::<Result<_, _>>()?;
    given.finish()?;
    Ok(ByHandModel { model: registry.find(&name)?.clone(), at })
}

fn at(value: Value) -> Result<ByHandAt, Refusal> {
    let mut given = Document::from_value(value)?;
    let condition = Condition {
        speed_mm_s: given.number("speed")?,
        force_n: given.number("force")?,
        ..Condition::default()
    };
    let level_rms = given.number("level")?;
    // Only the model knows the names of its parameters. They are checked later.
    let parameters = given.object("parameters")?.rest();
    given.finish()?;
    let mut values = BTreeMap::new();
    for (name, value) in parameters {
        let numbers: Option<Vec<f64>> = match &value {
            Value::Array(all) => all.iter().map(number).collect(),
            one => number(one).map(|number| vec![number]),
        };
        let numbers = numbers.ok_or_else(|| {
            let name = htex_base::finding::plain(&name);
            Refusal::argument(format!("the parameter {name} is a number, or a list of numbers"))
        })?;
        values.insert(name, numbers);
    }
    Ok(ByHandAt { condition, values, level_rms })
}

/// Makes a texture between two others, which are the two files. The bytes of the answer are the
/// asset.
pub(crate) fn mix(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let weight = call.number("weight")?;
    let weight = weight.ok_or_else(|| Refusal::argument("give a weight from 0 to 1"))?;
    let metadata = metadata(call.object("metadata")?)?;
    let extensions = extensions(&mut call)?;
    call.finish()?;
    let [a, b] = files else {
        return Err(Refusal::argument("give two textures"));
    };
    let (first, first_hash) = opened(a)?;
    let (second, second_hash) = opened(b)?;
    let mixed = by_hand::mix(
        MixedAsset { asset: &first, blake3: &first_hash },
        MixedAsset { asset: &second, blake3: &second_hash },
        weight,
        metadata.name.as_deref().unwrap_or("mix"),
        TOOL,
    );
    let mut asset = mixed?;
    metadata.apply(&mut asset.manifest);
    asset.manifest.set_extensions(extensions);
    answer(&asset)
}

/// Opens a texture and computes its hash.
fn opened(bytes: &[u8]) -> Result<(htex::Texture, String), Refusal> {
    let asset = htex::Texture::new(htex::format::Asset::from_bytes(bytes)?);
    Ok((asset, blake3::hash(bytes).to_hex().to_string()))
}

/// Changes the metadata and extensions of a texture, which is the only file. The bytes of the answer
/// are the asset.
pub(crate) fn edit(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let metadata = metadata(call.object("metadata")?)?;
    let extensions = extensions(&mut call)?;
    call.finish()?;
    if metadata.is_empty() && extensions.is_empty() {
        let sentence = "nothing to change: give at least one of the metadata, such as author";
        return Err(Refusal::argument(sentence));
    }
    let [bytes] = files else {
        return Err(Refusal::argument("give one texture"));
    };
    let mut asset = htex_author::edit(bytes, &metadata)?;
    asset.manifest.set_extensions(extensions);
    answer(&asset)
}
