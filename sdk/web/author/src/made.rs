//! Textures without recordings: of parameters, between two others, with other metadata.

use std::collections::BTreeMap;

use htex::host::Registry;
use htex::{Band, Quantity};
use htex_author::by_hand::{self, ByHandAt, ByHandModel, ByHandModels, MixedAsset};
use htex_author::settings::Metadata;
use htex_format::Condition;
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::TOOL;
use crate::call::{Answer, Files, parsed};
use crate::refusal::Refusal;
use crate::settings::Settings;

/// What a texture is made of.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Make {
    representations: Vec<MadeModel>,
    #[serde(default)]
    quantity: Quantity,
    #[serde(default)]
    band: Option<[f64; 2]>,
    #[serde(default)]
    metadata: Map<String, Value>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MadeModel {
    model: String,
    conditions: Vec<MadeAt>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MadeAt {
    #[serde(default)]
    speed: Option<f64>,
    #[serde(default)]
    force: Option<f64>,
    #[serde(default)]
    level: Option<f64>,
    parameters: BTreeMap<String, Numbers>,
}

/// A number, or those of a list.
#[derive(Deserialize)]
#[serde(untagged)]
enum Numbers {
    One(f64),
    Several(Vec<f64>),
}

impl From<Numbers> for Vec<f64> {
    fn from(numbers: Numbers) -> Self {
        match numbers {
            Numbers::One(number) => vec![number],
            Numbers::Several(numbers) => numbers,
        }
    }
}

fn metadata(given: Map<String, Value>) -> Result<Metadata, Refusal> {
    let mut settings = Settings::new(given);
    let metadata: Metadata = settings.take(Metadata::NAMES)?;
    settings.finish()?;
    metadata.check()?;
    Ok(metadata)
}

/// Makes a texture of parameters; the bytes are the asset.
pub(crate) fn make(json: &[u8], _: Files<'_>) -> Result<Answer, Refusal> {
    let Make {
        representations,
        quantity,
        band,
        metadata: given,
    } = parsed(json)?;
    let metadata = metadata(given)?;
    let registry = Registry::builtin();
    let name = metadata.name.as_deref().unwrap_or("texture");
    let mut models = Vec::new();
    for made in representations {
        let at = made.conditions.into_iter().map(|at| ByHandAt {
            condition: Condition {
                speed_mm_s: at.speed,
                force_n: at.force,
                ..Condition::default()
            },
            values: at
                .parameters
                .into_iter()
                .map(|(name, numbers)| (name, numbers.into()))
                .collect(),
            level_rms: at.level,
        });
        models.push(ByHandModel {
            model: registry.find(&made.model)?.clone(),
            at: at.collect(),
        });
    }
    let mut asset = by_hand::make_all(&ByHandModels {
        name: name.to_owned(),
        models,
        quantity,
        band: band.map_or(Band::TACTILE, |[low_hz, high_hz]| Band { low_hz, high_hz }),
        tool: TOOL.to_owned(),
    })?;
    metadata.apply(&mut asset.manifest);
    Answer::new(&json!({}), asset.to_bytes()?)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Mix {
    weight: f64,
    #[serde(default)]
    metadata: Map<String, Value>,
}

/// Makes a texture between two others, the files; the bytes are the asset.
pub(crate) fn mix(json: &[u8], files: Files<'_>) -> Result<Answer, Refusal> {
    let call: Mix = parsed(json)?;
    let metadata = metadata(call.metadata)?;
    let [a, b] = files else {
        return Err(Refusal::argument("give two textures"));
    };
    let hash = |bytes: &[u8]| blake3::hash(bytes).to_hex().to_string();
    let open =
        |bytes: &[u8]| Ok::<_, Refusal>(htex::Asset::new(htex::AssetData::from_bytes(bytes)?));
    let (first, second) = (open(a)?, open(b)?);
    let (first_hash, second_hash) = (hash(a), hash(b));
    let mixed = by_hand::mix(
        MixedAsset {
            asset: &first,
            blake3: &first_hash,
        },
        MixedAsset {
            asset: &second,
            blake3: &second_hash,
        },
        call.weight,
        metadata.name.as_deref().unwrap_or("mix"),
        TOOL,
    );
    let mut asset = mixed?;
    metadata.apply(&mut asset.manifest);
    Answer::new(&json!({}), asset.to_bytes()?)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Edit {
    metadata: Map<String, Value>,
}

/// Changes the metadata of a texture, the file; the bytes are the asset.
pub(crate) fn edit(json: &[u8], files: Files<'_>) -> Result<Answer, Refusal> {
    let call: Edit = parsed(json)?;
    let metadata = metadata(call.metadata)?;
    if metadata.is_empty() {
        return Err(Refusal::argument(
            "nothing to change: give at least one of the metadata, such as author",
        ));
    }
    let [bytes] = files else {
        return Err(Refusal::argument("give one texture"));
    };
    let asset = htex_author::edit(bytes, &metadata)?;
    Answer::new(&json!({}), asset.to_bytes()?)
}
