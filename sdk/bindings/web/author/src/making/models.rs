//! The descriptors of the built-in models, with the usual ranges of their parameters.

use htex::model::{Descriptor, Field, FitOption, Kind, LoadedModel, Registry, UsualRange};
use serde::Serialize;

use crate::answer::{Answer, Files};
use crate::document::Document;
use crate::refusal::Refusal;

pub(crate) fn models(call: Document, _: Files<'_>) -> Result<Answer, Refusal> {
    call.finish()?;
    let registry = Registry::builtin();
    let all: Vec<Model<'_>> = registry.models().iter().map(Model::new).collect();
    Answer::new(&all, Vec::new())
}

#[derive(Serialize)]
struct Model<'a> {
    id: &'a str,
    name: &'a str,
    version: &'a str,
    summary: &'a str,
    fields: Vec<Parameter<'a>>,
    options: &'a [FitOption],
    keeps_level: bool,
}

#[derive(Serialize)]
struct Parameter<'a> {
    name: &'a str,
    unit: &'a str,
    kind: Kind,
    min: f64,
    max: f64,
    usual: Option<UsualRange>,
    default: Option<f64>,
    description: &'a str,
}

impl<'a> Model<'a> {
    fn new(model: &'a LoadedModel) -> Self {
        let Descriptor { id, name, version, summary, fields, options, keeps_level, .. } =
            model.descriptor();
        Self {
            id,
            name,
            version,
            summary,
            fields: fields.iter().map(parameter).collect(),
            options,
            keeps_level: *keeps_level,
        }
    }
}

fn parameter(field: &Field) -> Parameter<'_> {
    Parameter {
        name: &field.name,
        unit: &field.unit,
        kind: field.kind,
        min: field.min,
        max: field.max,
        usual: field.usual,
        default: field.default,
        description: &field.description,
    }
}
