//! The model of a representation, and the order of its fields.

use htex_format::{FieldOrder, Representation, match_fields};
use htex_host::{LoadedModel, Registry};
use semver::{Version, VersionReq};

use crate::Error;

/// Returns the model of `registry` that can play a representation: one with its id and the same major version.
///
/// ```no_run
/// let asset = htex::Asset::open("sandpaper.htex")?;
/// for representation in &asset.manifest().representations {
///     let model = htex::model_of(asset.registry(), representation)?;
///     println!("{} is played by version {}", representation.model, model.descriptor().version);
/// }
/// # Ok::<(), htex::Error>(())
/// ```
///
/// # Errors
/// When there is no such model.
pub fn model_of<'a>(
    registry: &'a Registry,
    representation: &Representation,
) -> Result<&'a LoadedModel, Error> {
    let model = registry.find(&representation.model)?;
    let installed = &model.descriptor().version;
    let wanted = major(&representation.model_version);
    if wanted.is_some() && wanted == major(installed) {
        return Ok(model);
    }
    // A model that a newer one shadows may have the right version.
    let other = wanted
        .and_then(|major| VersionReq::parse(&format!("={major}")).ok())
        .and_then(|wanted| registry.find_version(model.id(), &wanted).ok());
    other.ok_or_else(|| Error::ModelVersion {
        model: representation.model.clone(),
        asset: representation.model_version.clone(),
        installed: installed.clone(),
    })
}

/// Returns the order in which a representation's fields are passed to its model.
///
/// ```no_run
/// let asset = htex::Asset::open("sandpaper.htex")?;
/// let representation = &asset.manifest().representations[0];
/// let model = htex::model_of(asset.registry(), representation)?;
/// let order = htex::field_order(representation, model)?;
/// # Ok::<(), htex::Error>(())
/// ```
///
/// # Errors
/// [`Error::Fields`] when the fields differ from the model's.
pub fn field_order<'a>(
    representation: &'a Representation,
    model: &LoadedModel,
) -> Result<FieldOrder<'a>, Error> {
    let descriptor = model.descriptor();
    match_fields(&representation.fields, descriptor).map_err(|mismatches| {
        let all: Vec<String> = mismatches.iter().map(ToString::to_string).collect();
        let (fitted, installed) = (&representation.model_version, &descriptor.version);
        Error::Fields {
            model: representation.model.clone(),
            problem: format!(
                "{}; it was fitted by {fitted}, and {installed} is installed",
                all.join("; ")
            ),
        }
    })
}

fn major(version: &str) -> Option<u64> {
    Version::parse(version).ok().map(|version| version.major)
}
