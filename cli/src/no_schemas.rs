//! Replaces the module `schemas` in a program that is built without the feature `schemas`. It
//! validates nothing.

use htex_base::finding::Report;
use serde_json::Value;

use crate::failure::{Failure, Result};

/// The note for builds that cannot validate documents against schemas.
pub(crate) const ABSENT: Option<&str> = Some(NOTE);
const NOTE: &str = "this program was built without its validator of JSON Schemas; build it with the Cargo feature \
                    `schemas`, which is on by default";

/// A schema that does not check anything.
pub(crate) struct SchemaFile;

impl SchemaFile {
    pub(crate) fn manifest() -> Result<Self> {
        Ok(Self)
    }

    pub(crate) fn scene() -> Result<Self> {
        Ok(Self)
    }

    pub(crate) fn model() -> Result<Self> {
        Ok(Self)
    }

    pub(crate) fn device() -> Result<Self> {
        Ok(Self)
    }

    pub(crate) fn check(&self, _: &Value, _: &mut Report) {}
}

/// A schema from an extension's author, which this program refuses.
pub(crate) struct ExtensionSchema;

impl ExtensionSchema {
    pub(crate) fn read(argument: &str) -> Result<Self> {
        Err(Failure::Usage(format!("--extension-schema {argument}: {NOTE}")))
    }

    pub(crate) fn check(&self, _: &Value, _: &mut Report) {}
}

pub(crate) fn settings(_: &htex_device::Descriptor) -> Result<SchemaFile> {
    Ok(SchemaFile)
}
