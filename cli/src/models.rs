//! Models and their options on the command line.

use htex_author::ModelRequest;
use htex_host::{LoadedModel, Registry};

use crate::failure::Failure;

/// Name and version of this program, for an asset's provenance.
pub(crate) fn tool() -> String {
    concat!("htex ", env!("CARGO_PKG_VERSION")).to_owned()
}

/// The models named, each with its options.
pub(crate) fn model_requests(
    registry: &Registry,
    names: &[String],
    options: &[String],
) -> Result<Vec<ModelRequest>, Failure> {
    let models = named_models(registry, names)?;
    let options: Vec<(&str, &str, &str)> = options
        .iter()
        .map(|text| split_option(text))
        .collect::<Result<_, _>>()?;
    if let Some((owner, ..)) = options
        .iter()
        .find(|(owner, ..)| !models.iter().any(|m| is(m, owner)))
    {
        return Err(Failure::Usage(format!(
            "--option {owner}.…: no such model is fitted; there are {}",
            models
                .iter()
                .map(LoadedModel::short_name)
                .collect::<Vec<_>>()
                .join(", ")
        )));
    }
    let request = |model: LoadedModel| {
        let own = options.iter().filter(|(owner, ..)| is(&model, owner));
        let own: Vec<(&str, &str)> = own.map(|(_, name, value)| (*name, *value)).collect();
        let options = model.options(&own)?;
        Ok(ModelRequest::new(&model).with_options(options))
    };
    models.into_iter().map(request).collect()
}

/// All models, or those named, each once.
fn named_models(registry: &Registry, names: &[String]) -> Result<Vec<LoadedModel>, Failure> {
    if names.iter().any(|name| name == "all") {
        return Ok(registry.models().to_vec());
    }
    let mut models: Vec<LoadedModel> = Vec::new();
    for name in names {
        let model = registry.find(name)?;
        if !models.iter().any(|m| m.id() == model.id()) {
            models.push(model.clone());
        }
    }
    Ok(models)
}

fn is(model: &LoadedModel, name: &str) -> bool {
    model.id() == name || model.short_name().eq_ignore_ascii_case(name)
}

/// Splits `MODEL.NAME=VALUE`; a model may be named by its dotted id.
fn split_option(text: &str) -> Result<(&str, &str, &str), Failure> {
    let split = text.split_once('=').and_then(|(left, value)| {
        let (model, name) = left.rsplit_once('.')?;
        Some((model, name, value))
    });
    split.ok_or_else(|| {
        Failure::Usage(format!(
            "--option {text}: it looks like MODEL.NAME=VALUE, e.g. ar.order=6"
        ))
    })
}
