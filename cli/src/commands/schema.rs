use clap::{Args, ValueEnum};
use htex_host::Registry;

use crate::failure::{Exit, Result};
use crate::output::print;

/// Print JSON Schemas and model descriptors
///
/// Prints either one JSON Schema (e.g. the schema of scenes) or the descriptors of all built-in
/// models.
#[derive(Args)]
pub(crate) struct Schema {
    /// What to print
    #[arg(value_enum, default_value = "manifest")]
    what: What,
}

#[derive(Clone, Copy, ValueEnum)]
enum What {
    /// JSON Schema of `manifest.json`, the description in an asset
    Manifest,
    /// JSON Schema of scenes
    Scene,
    /// JSON Schema of the report on one file in the output of `htex validate --json`
    Report,
    /// JSON Schema of recipes (`htex build`)
    #[cfg(feature = "build")]
    Recipe,
    /// JSON Schema of `build-report.json`, which `htex build` writes
    #[cfg(feature = "build")]
    BuildReport,
    /// JSON Schema of an entry in a registry of plugins (`htex registry`)
    #[cfg(feature = "build")]
    RegistryEntry,
    /// JSON Schema of studies (`htex study`)
    #[cfg(feature = "lab")]
    Study,
    /// JSON Schema of one line in the file with a participant's answers (`htex study run`)
    #[cfg(feature = "lab")]
    Answers,
    /// JSON Schema of the file that describes a recording made by `htex record`
    #[cfg(feature = "lab")]
    Take,
    /// JSON Schema of the file of stored gains (`htex gain`)
    Gains,
    /// Descriptors of the built-in models: parameters and fit options, with units and ranges
    Models,
}

impl Schema {
    pub(crate) fn run(self) -> Result {
        let value = match self.what {
            What::Manifest => Ok(htex_format::manifest_schema()),
            What::Scene => Ok(htex_scene::scene_schema()),
            What::Report => Ok(htex_format::report_schema()),
            #[cfg(feature = "build")]
            What::Recipe => Ok(htex_build::recipe_schema()),
            #[cfg(feature = "build")]
            What::BuildReport => Ok(htex_build::report_schema()),
            #[cfg(feature = "build")]
            What::RegistryEntry => Ok(htex_build::registry::entry_schema()),
            #[cfg(feature = "lab")]
            What::Study => Ok(htex_lab::study::study_schema()),
            #[cfg(feature = "lab")]
            What::Answers => Ok(htex_lab::study::answers_schema()),
            #[cfg(feature = "lab")]
            What::Take => Ok(htex_lab::record::take_schema()),
            What::Gains => Ok(htex_scene::gains_schema()),
            What::Models => {
                let registry = Registry::builtin();
                let all: Vec<_> = registry.models().iter().map(|m| m.descriptor()).collect();
                serde_json::to_value(all)
            }
        };
        let text = value.and_then(|value| serde_json::to_string_pretty(&value))?;
        print(&(text + "\n"))?;
        Ok(Exit::SUCCESS)
    }
}
