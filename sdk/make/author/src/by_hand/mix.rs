//! Mixing two textures into a texture between them.

use htex_format::{
    Asset, AtCondition, Condition, How, Ingredient, Made, Manifest, Provenance, Representation,
    Triangle, round_within,
};
use htex_host::LoadedModel;
use htex_play::Motion;

use crate::{AuthorError, new_asset, representation, stored_fields};

/// A texture to mix, with the hash of its file.
#[derive(Debug, Clone, Copy)]
pub struct MixedAsset<'a> {
    /// The texture, with the models that play it.
    pub asset: &'a htex_play::Texture,
    /// BLAKE3 hash of the texture's file, hexadecimal.
    pub blake3: &'a str,
}

impl MixedAsset<'_> {
    fn name(&self) -> &str {
        &self.asset.manifest().name
    }
}

/// Mixes two textures. `weight` is the share of `b`, from 0 to 1. If both textures contain a model,
/// this model interpolates between the parameters of the two textures, with the same method as
/// between the conditions of one texture. Levels are interpolated linearly.
///
/// The result has the conditions of both textures. If a condition occurs in only one of the
/// textures, the parameters of the other texture are interpolated for this condition, as in a
/// player. The law comes from the texture with the larger weight, or from `a` if the weights are
/// equal. A texture may store triangles of conditions. A player interpolates within these
/// triangles. The result gets the triangles of the texture that gives the law, if this texture has
/// exactly the conditions of the result. Otherwise the result has no stored triangles. In this
/// case, htex adds a warning if one of the two textures had triangles.
///
/// # Errors
/// Returns an error if the weight is out of range, if the textures have no model in common, if
/// their quantities or bands differ, or if a model cannot mix its parameters.
pub fn mix(
    a: MixedAsset<'_>,
    b: MixedAsset<'_>,
    weight: f64,
    name: &str,
    tool: &str,
) -> Result<Asset, AuthorError> {
    if !(0.0..=1.0).contains(&weight) {
        return Err(AuthorError::Weight { weight });
    }
    let different = |problem: String| AuthorError::NotMixable {
        a: a.name().to_owned(),
        b: b.name().to_owned(),
        problem,
    };
    check(a, b).map_err(different)?;
    let conditions = conditions(a, b).map_err(different)?;
    let ids = |part: MixedAsset<'_>| -> Vec<String> {
        let all = &part.asset.manifest().representations;
        all.iter().map(|r| r.model.clone()).collect()
    };
    let theirs = ids(b);
    let mut mixed = ids(a)
        .into_iter()
        .filter(|id| theirs.contains(id))
        .map(|id| {
            let model = a.asset.representation(&id[..])?.model()?;
            mixed(&model, (a, b), weight, &conditions)
        })
        .collect::<Result<Vec<_>, AuthorError>>()?;
    if mixed.is_empty() {
        let problem = format!(
            "no model describes both ({} and {}); fit them with the same model",
            ids(a).join(", "),
            theirs.join(", ")
        );
        return Err(different(problem));
    }
    let ingredient = |part: MixedAsset<'_>, weight| Ingredient {
        name: part.name().to_owned(),
        weight,
        blake3: part.blake3.to_owned(),
    };
    let manifest = a.asset.manifest();
    let heavier = if weight > 0.5 { b } else { a }.asset.manifest();
    let warnings = mixed.iter_mut().filter_map(|(made, _)| {
        made.triangles = triangles(heavier, made, &conditions);
        let stored =
            |part: MixedAsset<'_>| !of_model(part.asset.manifest(), &made.model).is_empty();
        let lost = made.triangles.is_empty() && (stored(a) || stored(b));
        lost.then(|| triangles_warning(&made.model))
    });
    let warnings: Vec<String> = warnings.collect();
    let simulated = [a, b].map(|part| part.asset.manifest().provenance.simulated);
    let provenance = Provenance {
        tool: tool.to_owned(),
        simulated: simulated.contains(&true),
        made: Some(Made {
            how: How::Mixed,
            from: vec![ingredient(a, 1.0 - weight), ingredient(b, weight)],
        }),
        warnings,
        ..Provenance::default()
    };
    let (quantity, band) = (manifest.quantity, manifest.band);
    let mut asset = new_asset(name, quantity, band, provenance, conditions, mixed);
    asset.manifest.contact = heavier.contact;
    asset.manifest.law = Some(heavier.law());
    let strength_db =
        |part: MixedAsset<'_>| part.asset.manifest().fluctuation.map_or([0.0; 2], |f| f.decibels());
    let (of_a, of_b) = (strength_db(a), strength_db(b));
    asset.manifest.fluctuation = htex_format::Fluctuation::from_db(
        [0, 1].map(|range| (1.0 - weight) * of_a[range] + weight * of_b[range]),
    );
    // A mixture of two coded assets is also coded. Any other mixture is not coded, so that every
    // reader of the two textures can read it.
    Ok(if a.asset.manifest().is_coded() && b.asset.manifest().is_coded() {
        asset.coded()
    } else {
        asset
    })
}

fn check(a: MixedAsset<'_>, b: MixedAsset<'_>) -> Result<(), String> {
    let (a, b) = (a.asset.manifest(), b.asset.manifest());
    if a.quantity != b.quantity {
        return Err(format!("they are a {} and a {}", a.quantity, b.quantity));
    }
    if a.band != b.band {
        let (a, b) = (a.band, b.band);
        return Err(format!(
            "their bands are {}-{} Hz and {}-{} Hz",
            a.low_hz, a.high_hz, b.low_hz, b.high_hz
        ));
    }
    Ok(())
}

/// Returns the conditions of both textures, without measurements of the recordings. Equal
/// conditions occur only once.
fn conditions(a: MixedAsset<'_>, b: MixedAsset<'_>) -> Result<Vec<Condition>, String> {
    let mut all: Vec<Condition> = Vec::new();
    for condition in [a, b].iter().flat_map(|part| &part.asset.manifest().conditions) {
        let known = |c: &Condition| (c.speed_mm_s.is_some(), c.force_n.is_some());
        // A player needs both numbers of every condition, or of none.
        if all.first().is_some_and(|first| known(first) != known(condition)) {
            return Err("the speed or the force of one alone is known; edit or fit it".to_owned());
        }
        if !all.iter().any(|other| is_same(other, condition)) {
            let Condition { speed_mm_s, force_n, .. } = *condition;
            let segments = if condition.is_recorded() { None } else { Some(0) };
            all.push(Condition { speed_mm_s, force_n, segments, ..Condition::default() });
        }
    }
    Ok(all)
}

/// Returns whether two conditions have the same speed and force. A value that is unknown in both
/// conditions counts as equal.
pub(super) fn is_same(a: &Condition, b: &Condition) -> bool {
    let same = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => Condition::is_same(a, b),
        _ => a == b,
    };
    same(a.speed_mm_s, b.speed_mm_s) && same(a.force_n, b.force_n)
}

/// The triangles that a texture stores for a model.
fn of_model<'a>(manifest: &'a Manifest, model: &str) -> &'a [Triangle] {
    let mut all = manifest.representations.iter();
    let own = all.find(|r| r.model == model);
    own.map_or(&[], |own| &own.triangles)
}

/// Returns the triangles that `from` stores for a mixed model, as indices into the mixed model's
/// `at`. The list is empty if the conditions of the mixture differ from the texture's own
/// conditions.
fn triangles(from: &Manifest, mixed: &Representation, conditions: &[Condition]) -> Vec<Triangle> {
    let own = from.representations.iter().find(|r| r.model == mixed.model);
    let Some(own) = own.filter(|own| own.at.len() == mixed.at.len()) else {
        return Vec::new();
    };
    let motion = |c: &Condition| (c.speed_mm_s, c.force_n);
    let place = |element: usize| {
        let condition = from.conditions.get(own.at.get(element)?.condition)?;
        conditions.iter().position(|other| motion(other) == motion(condition))
    };
    let moved = |corners: &Triangle| {
        let [a, b, c] = corners.map(place);
        Some([a?, b?, c?])
    };
    let all: Option<Vec<Triangle>> = own.triangles.iter().map(moved).collect();
    all.unwrap_or_default()
}

fn triangles_warning(model: &str) -> String {
    format!(
        "the stored triangles of {model} are left out, because the mixture has other conditions: it is interpolated in the triangles \
         that a player finds"
    )
}

/// Mixes one model's parameters at all conditions.
fn mixed(
    model: &LoadedModel,
    (a, b): (MixedAsset<'_>, MixedAsset<'_>),
    weight: f64,
    conditions: &[Condition],
) -> Result<(Representation, Vec<Vec<f64>>), AuthorError> {
    let fields = stored_fields(model.descriptor());
    let (mut at, mut parameters) = (Vec::new(), Vec::new());
    for (condition, place) in conditions.iter().enumerate() {
        let motion =
            Motion::new(place.speed_mm_s.unwrap_or_default(), place.force_n.unwrap_or_default());
        let (first, first_level) = a.asset.representation(model.id())?.parameters(Some(motion))?;
        let (second, second_level) =
            b.asset.representation(model.id())?.parameters(Some(motion))?;
        // With a weight of 0 or 1, the parameters are copied. Interpolation could change their last
        // digit, or fail for a model that cannot interpolate.
        let flat = match weight {
            0.0 => first,
            1.0 => second,
            _ => model.interpolate(&[&first, &second], &[1.0 - weight, weight])?,
        };
        parameters.push(round_within(&fields, model.descriptor(), &flat)?);
        at.push(AtCondition {
            condition,
            level_rms: (1.0 - weight) * first_level + weight * second_level,
            quality: None,
            left_out: None,
        });
    }
    Ok((representation(model, at), parameters))
}
