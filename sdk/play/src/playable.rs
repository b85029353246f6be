//! Which model plays a representation, and how its stored fields become the model's.

use htex_format::{FieldOrder, Representation, match_fields};
use htex_host::{LoadedModel, Registry};
use semver::{Version, VersionReq};

use crate::Error;

/// The model of `registry` that can play a representation: of its id and of the same major version.
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
    // One that is shadowed by a newer one may still do.
    let other = wanted
        .and_then(|major| VersionReq::parse(&format!("={major}")).ok())
        .and_then(|wanted| registry.find_version(model.id(), &wanted).ok());
    other.ok_or_else(|| Error::ModelVersion {
        model: representation.model.clone(),
        asset: representation.model_version.clone(),
        installed: installed.clone(),
    })
}

/// How a representation's fields are arranged for its model.
///
/// # Errors
/// [`Error::Fields`] when they are not the model's.
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
