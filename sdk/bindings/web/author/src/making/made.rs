//! Makes textures without recordings: from parameters, by interpolation between two textures, or by
//! changing the metadata and extensions of a texture.

use std::collections::BTreeMap;

use htex::format::{Quantity, UnknownName};
use htex::model::Band;
use htex::model::Registry;
use htex_author::by_hand::{self, ByHandAt, ByHandModel, ByHandModels, MixedAsset};
use htex_author::settings::Metadata;
use htex_format::{Asset, Condition};
use serde_json::{Map, Value};

use super::TOOL;
use crate::answer::{Answer, Files};
use crate::document::{Document, number};
use crate::refusal::Refusal;

/// What a call says about a texture, besides how it is made.
struct Said {
    metadata: Metadata,
    /// An extension that is `null` is removed.
    extensions: Map<String, Value>,
}

impl Said {
    /// Takes the last entries of a call.
    fn new(mut call: Document) -> Result<Self, Refusal> {
        let mut given = call.object("metadata")?;
        let metadata: Metadata = given.table(Metadata::NAMES)?;
        given.finish()?;
        metadata.check()?;
        let extensions = call.map("extensions")?;
        call.finish()?;
        Ok(Self { metadata, extensions })
    }

    /// Answers with the bytes of the asset, with the extensions.
    fn answer(self, mut asset: Asset) -> Result<Answer, Refusal> {
        asset.manifest.set_extensions(self.extensions)?;
        Answer::new(&(), asset.to_bytes()?)
    }
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
    let said = Said::new(call)?;
    let name = said.metadata.name.clone();
    let mut asset = by_hand::make_all(&ByHandModels {
        name: name.unwrap_or_else(|| "texture".to_owned()),
        models,
        quantity,
        band,
        tool: TOOL.to_owned(),
    })?;
    said.metadata.apply(&mut asset.manifest);
    said.answer(asset)
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
    let said = Said::new(call)?;
    let [a, b] = files else {
        return Err(Refusal::argument("give two textures"));
    };
    let (first, first_hash) = opened(a)?;
    let (second, second_hash) = opened(b)?;
    let mixed = by_hand::mix(
        MixedAsset { asset: &first, blake3: &first_hash },
        MixedAsset { asset: &second, blake3: &second_hash },
        weight,
        said.metadata.name.as_deref().unwrap_or("mix"),
        TOOL,
    );
    let mut asset = mixed?;
    said.metadata.apply(&mut asset.manifest);
    said.answer(asset)
}

/// Opens a texture and computes its hash.
fn opened(bytes: &[u8]) -> Result<(htex::Texture, String), Refusal> {
    let asset = htex::Texture::new(htex::format::Asset::from_bytes(bytes)?);
    Ok((asset, blake3::hash(bytes).to_hex().to_string()))
}

/// Changes the metadata and extensions of a texture, which is the only file. The bytes of the answer
/// are the asset.
pub(crate) fn edit(call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let said = Said::new(call)?;
    if said.metadata.is_empty() && said.extensions.is_empty() {
        let sentence = "nothing to change: give at least one of the metadata, such as author";
        return Err(Refusal::argument(sentence));
    }
    let [bytes] = files else {
        return Err(Refusal::argument("give one texture"));
    };
    let asset = htex_author::edit(bytes, &said.metadata)?;
    said.answer(asset)
}
