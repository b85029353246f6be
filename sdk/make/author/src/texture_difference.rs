//! Compares two textures: their metadata, conditions and law, and the spectra of each model that
//! both have.

use htex_format::{Condition, Manifest};
use htex_play::{Motion, Representation, Texture};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::{AuthorError, Difference, FeltError, TextureSpectrum};

/// How two textures differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TextureDifference {
    /// Entries of the manifest that differ.
    pub metadata: Vec<EntryChange>,
    /// Conditions that only the first texture has.
    pub conditions_removed: Vec<Condition>,
    /// Conditions that only the second texture has.
    pub conditions_added: Vec<Condition>,
    /// Models that only the first texture has.
    pub models_removed: Vec<String>,
    /// Models that only the second texture has.
    pub models_added: Vec<String>,
    /// The models that both textures have.
    pub models: Vec<ModelDifference>,
}

/// An entry of the manifest with two values. A missing value is `null`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EntryChange {
    /// Name of the entry, such as `license`.
    pub name: String,
    pub from: Value,
    pub to: Value,
}

/// How the representations of one model differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelDifference {
    /// Id of the model.
    pub model: String,
    /// One entry for each condition of the first texture at which the spectra differ. If the
    /// quantities or the bands of the textures differ, spectra cannot be compared, and the list is
    /// empty.
    pub at: Vec<DifferenceAt>,
}

/// How two representations differ at one motion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DifferenceAt {
    /// Speed (mm/s) and force (newtons) at which both representations were evaluated.
    pub speed_mm_s: f64,
    pub force_n: f64,
    /// Level of the second representation minus the level of the first, decibels; `None` if one of
    /// them is silent.
    pub level_db: Option<f64>,
    #[serde(flatten)]
    pub difference: Difference,
}

/// Entries of the manifest that are compared one by one, and not as metadata.
const NOT_METADATA: [&str; 6] =
    ["htex", "conditions", "representations", "reference", "plugins", "provenance"];

impl TextureDifference {
    /// Compares two textures, of which the first is the reference.
    ///
    /// # Errors
    /// Returns an error if a representation cannot be read, or if a model refuses its parameters.
    pub fn new(a: &Texture, b: &Texture) -> Result<Self, AuthorError> {
        let (first, second) = (a.manifest(), b.manifest());
        let only = |one: &[Condition], other: &[Condition]| {
            one.iter().filter(|c| !other.contains(c)).copied().collect()
        };
        let ids = |manifest: &Manifest| {
            manifest.representations.iter().map(|r| r.model.clone()).collect::<Vec<_>>()
        };
        let (of_a, of_b) = (ids(first), ids(second));
        let missing = |one: &[String], other: &[String]| {
            one.iter().filter(|id| !other.contains(id)).cloned().collect()
        };
        let both = of_a.iter().filter(|id| of_b.contains(id));
        Ok(Self {
            metadata: metadata(first, second),
            conditions_removed: only(&first.conditions, &second.conditions),
            conditions_added: only(&second.conditions, &first.conditions),
            models_removed: missing(&of_a, &of_b),
            models_added: missing(&of_b, &of_a),
            models: both.map(|id| ModelDifference::new(a, b, id)).collect::<Result<_, _>>()?,
        })
    }

    /// Returns whether nothing differs.
    pub fn is_none(&self) -> bool {
        self.metadata.is_empty()
            && self.conditions_removed.is_empty()
            && self.conditions_added.is_empty()
            && self.models_removed.is_empty()
            && self.models_added.is_empty()
            && self.models.iter().all(|model| model.at.is_empty())
    }

    /// Returns the largest felt difference over all models and conditions; `None` if no spectra
    /// were compared.
    pub fn felt(&self) -> Option<FeltError> {
        let all = self.models.iter().flat_map(|model| &model.at);
        all.map(|at| at.difference.felt.error).reduce(FeltError::worse)
    }
}

/// Returns the entries of two manifests that differ.
fn metadata(a: &Manifest, b: &Manifest) -> Vec<EntryChange> {
    let entries = |manifest: &Manifest| match serde_json::to_value(manifest) {
        Ok(Value::Object(mut entries)) => {
            entries.retain(|name, _| !NOT_METADATA.contains(&&name[..]));
            // The law applies, whether or not the file states it.
            if let Ok(law) = serde_json::to_value(manifest.law()) {
                entries.insert("law".to_owned(), law);
            }
            entries
        }
        _ => Map::new(),
    };
    let (a, b) = (entries(a), entries(b));
    let mut names: Vec<&String> = a.keys().chain(b.keys()).collect();
    names.sort_unstable();
    names.dedup();
    let value = |of: &Map<String, Value>, name: &String| of.get(name).cloned().unwrap_or_default();
    names
        .into_iter()
        .map(|name| EntryChange { name: name.clone(), from: value(&a, name), to: value(&b, name) })
        .filter(|change| change.from != change.to)
        .collect()
}

impl ModelDifference {
    fn new(a: &Texture, b: &Texture, model: &str) -> Result<Self, AuthorError> {
        let mut at = Vec::new();
        if (a.quantity(), a.band()) == (b.quantity(), b.band()) {
            let (one, other) = (a.representation(model)?, b.representation(model)?);
            for motion in motions(a, &one) {
                at.extend(DifferenceAt::new((a, &one), &other, motion)?);
            }
        }
        Ok(Self { model: model.to_owned(), at })
    }
}

/// Returns the motions of a representation's conditions.
fn motions(texture: &Texture, of: &Representation<'_>) -> Vec<Motion> {
    let stated = texture.manifest().representations.iter().find(|r| r.model == of.id());
    let conditions = stated.into_iter().flat_map(|r| &r.at).map(|at| at.condition);
    let mut motions: Vec<Motion> = Vec::new();
    for condition in conditions {
        let condition = texture.manifest().conditions.get(condition).copied().unwrap_or_default();
        let motion = of.motion(condition.speed_mm_s, condition.force_n);
        if !motions.contains(&motion) {
            motions.push(motion);
        }
    }
    motions
}

impl DifferenceAt {
    fn new(
        (texture, a): (&Texture, &Representation<'_>),
        b: &Representation<'_>,
        motion: Motion,
    ) -> Result<Option<Self>, AuthorError> {
        let spectrum = |of: &Representation<'_>| -> Result<TextureSpectrum, AuthorError> {
            let frequency_hz = texture.band().grid_hz();
            let magnitude = of.magnitude(Some(motion), &frequency_hz)?;
            Ok(TextureSpectrum {
                quantity: texture.quantity(),
                band: texture.band(),
                frequency_hz,
                magnitude,
                segments: 0,
                repeatability: None,
                signal: Vec::new(),
                signal_rate_hz: 0.0,
            })
        };
        let (reference, other) = (spectrum(a)?, spectrum(b)?);
        if reference.magnitude == other.magnitude {
            return Ok(None);
        }
        let level = htex_dsp::grid::level_rms(&reference.magnitude);
        let Some(difference) = Difference::between(&reference, &other) else { return Ok(None) };
        let level_db = (level > 0.0 && difference.level_rms > 0.0)
            .then(|| 20.0 * libm::log10(difference.level_rms / level));
        let (speed_mm_s, force_n) = (motion.speed_mm_s, motion.force_n);
        Ok(Some(Self { speed_mm_s, force_n, level_db, difference }))
    }
}
