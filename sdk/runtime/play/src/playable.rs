//! Chooses the model that plays a representation, and the order in which the fields are passed to
//! the model.

use htex_format::{FieldOrder, Representation, match_fields};
use htex_host::{LoadedModel, Registry};
use semver::Version;

use crate::Error;

/// Returns the model in `registry` that plays a representation. Candidates are the models with the
/// representation's id and major version, in the order of the registry. The function returns the
/// first candidate that has the representation's fields and is not older than the model version
/// that fitted the representation. If there is no such candidate, the function returns the first
/// candidate that has the fields. If no candidate has the fields, the function returns the first
/// candidate.
///
/// ```no_run
/// let asset = htex::Texture::open("sandpaper.htex")?;
/// for representation in &asset.manifest().representations {
///     let model = htex::play::model_of(asset.registry(), representation)?;
///     println!("{} is played by version {}", representation.model, model.descriptor().version);
/// }
/// # Ok::<(), htex::Error>(())
/// ```
///
/// # Errors
/// Returns an error if there is no candidate.
pub fn model_of<'a>(
    registry: &'a Registry,
    representation: &Representation,
) -> Result<&'a LoadedModel, Error> {
    let used = registry.find(&representation.model)?;
    let wanted = major(&representation.model_version);
    let of_major = |m: &&LoadedModel| wanted.is_some() && wanted == major(&m.descriptor().version);
    let all = || registry.all(used.id()).filter(of_major);
    let has_fields =
        |m: &&LoadedModel| match_fields(&representation.fields, m.descriptor()).is_ok();
    let is_new = |m: &&LoadedModel| !is_older(m, representation);
    let first = all()
        .filter(is_new)
        .find(has_fields)
        .or_else(|| all().find(has_fields))
        .or_else(|| all().next());
    first.ok_or_else(|| Error::ModelVersion {
        model: representation.model.clone(),
        asset: representation.model_version.clone(),
        installed: used.descriptor().version.clone(),
    })
}

/// Returns whether a model's version is earlier than the version that fitted a representation.
fn is_older(model: &LoadedModel, representation: &Representation) -> bool {
    let versions = [&model.descriptor().version, &representation.model_version];
    match versions.map(|version| Version::parse(version).ok()) {
        [Some(own), Some(fitted)] => own.cmp_precedence(&fitted).is_lt(),
        _ => false,
    }
}

/// Returns the order in which to pass a representation's fields to its model.
///
/// ```no_run
/// let asset = htex::Texture::open("sandpaper.htex")?;
/// let representation = &asset.manifest().representations[0];
/// let model = htex::play::model_of(asset.registry(), representation)?;
/// let order = htex::play::field_order(representation, model)?;
/// # Ok::<(), htex::Error>(())
/// ```
///
/// # Errors
/// Returns an error if the fields of the representation differ from the fields of the model. The
/// error is [`Error::ModelOlder`] if a newer version of the model fitted the representation, and
/// otherwise [`Error::Fields`].
pub fn field_order<'a>(
    representation: &'a Representation,
    loaded: &LoadedModel,
) -> Result<FieldOrder<'a>, Error> {
    let descriptor = loaded.descriptor();
    match_fields(&representation.fields, descriptor).map_err(|mismatches| {
        let all: Vec<String> = mismatches.iter().map(ToString::to_string).collect();
        let (model, problem) = (representation.model.clone(), all.join("; "));
        let (fitted, installed) = (&representation.model_version, &descriptor.version);
        if is_older(loaded, representation) {
            return Error::ModelOlder {
                model: model.into(),
                asset: fitted.as_str().into(),
                installed: installed.as_str().into(),
                problem: problem.into(),
                embedded: false,
            };
        }
        Error::Fields {
            model,
            problem: format!("{problem}; it was fitted by {fitted}, and {installed} is installed"),
        }
    })
}

fn major(version: &str) -> Option<u64> {
    Version::parse(version).ok().map(|version| version.major)
}
