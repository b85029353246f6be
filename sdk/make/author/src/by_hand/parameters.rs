//! Textures from parameters written by hand.

use std::collections::BTreeMap;

use htex_format::{
    Asset, AtCondition, Condition, Contact, How, Law, Made, Provenance, Quantity, Representation,
    round_within,
};
use htex_host::{Band, Field, Kind, LoadedModel};

use super::mix::is_same;
use crate::{AuthorError, new_asset, stored_fields};

/// Highest frequency of a band, hertz.
const HIGHEST_HZ: f64 = 20_000.0;

/// A texture to make from the parameters of one model.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ByHand {
    pub name: String,
    /// Values by field name. If a field is a list, its entry here contains all values of the list.
    pub values: BTreeMap<String, Vec<f64>>,
    /// RMS of the texture in the band, in the quantity's unit.
    pub level_rms: f64,
    /// Speed and force to which the parameters apply.
    pub condition: Condition,
    pub quantity: Quantity,
    pub band: Band,
    /// Program and version, stored in the provenance.
    pub tool: String,
}

impl ByHand {
    /// Starts the description of a texture. By default, the quantity of the texture is the lateral
    /// force, its band is the tactile band, and its speed and normal force are unknown.
    pub fn new(name: impl Into<String>, level_rms: f64, tool: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            values: BTreeMap::new(),
            level_rms,
            condition: Condition::default(),
            quantity: Quantity::LateralForce,
            band: Band::TACTILE,
            tool: tool.into(),
        }
    }

    /// Sets a parameter. If the parameter is a list, sets all values of the list.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, values: impl Into<Vec<f64>>) -> Self {
        self.values.insert(name.into(), values.into());
        self
    }

    /// Sets the speed and force to which the parameters apply.
    #[must_use]
    pub fn with_condition(mut self, condition: Condition) -> Self {
        self.condition = condition;
        self
    }

    #[must_use]
    pub fn with_quantity(mut self, quantity: Quantity) -> Self {
        self.quantity = quantity;
        self
    }
}

/// Makes an asset from parameters. The model computes the spectrum of the parameters once, so that
/// invalid parameters are found here and not during playback.
///
/// ```
/// use htex_author::by_hand::{ByHand, make};
/// use htex_host::Registry;
///
/// let registry = Registry::builtin();
/// let texture = ByHand::new("Hum", 0.02, "my-editor 1.0").with("alpha", [2.0]).with("beta", [5.0]);
/// let asset = make(registry.find("sbeta")?, &texture)?;
/// assert_eq!(asset.parameters, [[[2.0, 5.0]]]);
/// assert!(asset.manifest.provenance.made.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Returns an error if a parameter is unknown, missing or out of range, if the level is out of the
/// quantity's range, or if the model refuses the parameters.
pub fn make(model: &LoadedModel, texture: &ByHand) -> Result<Asset, AuthorError> {
    let at = ByHandAt {
        condition: texture.condition,
        values: texture.values.clone(),
        level_rms: Some(texture.level_rms),
    };
    make_all(&ByHandModels {
        name: texture.name.clone(),
        models: vec![ByHandModel { model: model.clone(), at: vec![at] }],
        quantity: texture.quantity,
        band: texture.band,
        tool: texture.tool.clone(),
    })
}

/// A texture to make from the parameters of one or more models. Each model has parameters at one or
/// more conditions.
#[derive(Debug, Clone)]
pub struct ByHandModels {
    pub name: String,
    /// The models, in the order of the representations.
    pub models: Vec<ByHandModel>,
    pub quantity: Quantity,
    pub band: Band,
    /// Program and version, stored in the provenance.
    pub tool: String,
}

/// A model of a texture, with its parameters.
#[derive(Debug, Clone)]
pub struct ByHandModel {
    pub model: LoadedModel,
    pub at: Vec<ByHandAt>,
}

/// A model's parameters at one condition.
#[derive(Debug, Clone)]
pub struct ByHandAt {
    pub condition: Condition,
    /// Values by field name. If a field is a list, its entry here contains all values of the list.
    pub values: BTreeMap<String, Vec<f64>>,
    /// RMS of the texture in the band, in the quantity's unit. Optional for a model whose
    /// parameters contain the level ([`htex_host::Descriptor::keeps_level`]).
    pub level_rms: Option<f64>,
}

/// Makes an asset from the parameters of several models, each at one or more conditions. [`make`]
/// does the same for one model at one condition. Conditions within 5 % of each other count as one
/// ([`htex_format::SAME_CONDITION`]).
///
/// # Errors
/// Returns the errors of [`make`]. Also returns an error if there is no model or no condition, or
/// if only some conditions have a speed or a force.
pub fn make_all(texture: &ByHandModels) -> Result<Asset, AuthorError> {
    let Band { low_hz, high_hz } = texture.band;
    if !(0.0 < low_hz && low_hz < high_hz && high_hz <= HIGHEST_HZ) {
        return Err(AuthorError::Band { low_hz, high_hz });
    }
    let all = texture.models.iter().flat_map(|model| &model.at);
    let conditions = distinct(all.map(|at| at.condition))?;
    let made = texture
        .models
        .iter()
        .map(|of| representation(of, texture, &conditions))
        .collect::<Result<Vec<_>, _>>()?;
    let provenance = Provenance {
        tool: texture.tool.clone(),
        made: Some(Made { how: How::Parameters, from: Vec::new() }),
        ..Provenance::default()
    };
    let (quantity, band) = (texture.quantity, texture.band);
    let mut asset = new_asset(&texture.name, quantity, band, provenance, conditions, made);
    asset.manifest.law = Some(Law::for_new_assets(quantity, Contact::Unknown));
    Ok(asset)
}

/// Returns the conditions, with equal ones merged into one.
fn distinct(all: impl Iterator<Item = Condition>) -> Result<Vec<Condition>, AuthorError> {
    let mut distinct: Vec<Condition> = Vec::new();
    for condition in all {
        let known = |c: &Condition| (c.speed_mm_s.is_some(), c.force_n.is_some());
        let first = distinct.first().map(known);
        if first.is_some_and(|first| first != known(&condition)) {
            return Err(AuthorError::PartialConditions);
        }
        if !distinct.iter().any(|other| is_same(other, &condition)) {
            distinct.push(condition);
        }
    }
    if distinct.is_empty() { Err(AuthorError::NoParameters) } else { Ok(distinct) }
}

fn representation(
    of: &ByHandModel,
    texture: &ByHandModels,
    conditions: &[Condition],
) -> Result<(Representation, Vec<Vec<f64>>), AuthorError> {
    let (model, band) = (&of.model, texture.band);
    let fields = stored_fields(model.descriptor());
    let (mut at, mut parameters) = (Vec::new(), Vec::new());
    for own in &of.at {
        let flat = flat(model, &own.values)?;
        let stored = round_within(&fields, model.descriptor(), &flat)?;
        // The spectrum is computed even if the level is given. Each parameter may be in its range,
        // and the model may still refuse the combination.
        let magnitude = model.magnitude(&stored, band, &band.grid_hz())?;
        let level_rms = match own.level_rms {
            Some(level_rms) => level_rms,
            None if model.descriptor().keeps_level => htex_dsp::grid::level_rms(&magnitude),
            None => {
                let model = model.short_name().to_owned();
                return Err(AuthorError::NoLevel { model });
            }
        };
        check_level(level_rms, texture.quantity)?;
        let place = conditions.iter().position(|c| is_same(c, &own.condition));
        at.push(AtCondition {
            condition: place.unwrap_or_default(),
            level_rms,
            quality: None,
            left_out: None,
        });
        parameters.push(stored);
    }
    Ok((crate::representation(model, at), parameters))
}

fn check_level(level_rms: f64, quantity: Quantity) -> Result<(), AuthorError> {
    let most = quantity.largest_level();
    if (0.0..=most).contains(&level_rms) {
        return Ok(());
    }
    Err(AuthorError::LevelRange { level_rms, unit: quantity.unit(), most })
}

/// Flattens named values into the model's parameter array.
fn flat(model: &LoadedModel, values: &BTreeMap<String, Vec<f64>>) -> Result<Vec<f64>, AuthorError> {
    let fields = &model.descriptor().fields;
    let named = || model.short_name().to_owned();
    if let Some(name) = values.keys().find(|name| !fields.iter().any(|f| f.name == **name)) {
        let (model, name) = (named(), name.clone());
        let there = words(fields.iter());
        return Err(AuthorError::UnknownParameter { model, name, there });
    }
    let missing = fields.iter().filter(|f| f.default.is_none() && !values.contains_key(&f.name));
    let missing = words(missing);
    if !missing.is_empty() {
        let model = named();
        return Err(AuthorError::MissingParameter { model, missing });
    }
    let mut flat = Vec::new();
    for field in fields {
        match (values.get(&field.name), field.default) {
            (Some(given), _) => push(field, given, &mut flat)?,
            (None, default) => flat.extend(default),
        }
    }
    Ok(flat)
}

/// Appends a field's values after checking its range.
fn push(field: &Field, given: &[f64], flat: &mut Vec<f64>) -> Result<(), AuthorError> {
    let wrong = |problem: String| AuthorError::ParameterValue {
        name: field.name.clone(),
        value: given.iter().map(f64::to_string).collect::<Vec<_>>().join(","),
        problem,
    };
    match field.kind {
        Kind::Scalar if given.len() != 1 => return Err(wrong("it is one number".to_owned())),
        Kind::List { max_len } if given.len() > max_len as usize => {
            return Err(wrong(format!("it is at most {max_len} numbers")));
        }
        Kind::List { .. } => flat.push(given.len() as f64),
        Kind::Scalar => {}
    }
    if given.iter().any(|x| !(field.min..=field.max).contains(x)) {
        return Err(wrong(format!("it is {}", range(field))));
    }
    flat.extend_from_slice(given);
    Ok(())
}

/// Describes fields with their units and ranges.
fn words<'a>(fields: impl Iterator<Item = &'a Field>) -> String {
    let all = fields.map(|field| match field.kind {
        Kind::Scalar => format!("{} ({})", field.name, range(field)),
        Kind::List { max_len } => {
            format!("{} (up to {max_len} numbers, {})", field.name, range(field))
        }
    });
    all.collect::<Vec<_>>().join(", ")
}

fn range(field: &Field) -> String {
    let unit = match field.unit.as_str() {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    format!("{} to {}{unit}", field.min, field.max)
}
