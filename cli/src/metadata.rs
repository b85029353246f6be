//! Arguments for a texture's metadata.

use clap::Args;
use htex_format::{Manifest, Severity, check_doi, check_license};

use crate::failure::Failure;
use crate::output::warn;

/// Metadata: what a texture is, who made it, and how it was recorded.
#[derive(Args)]
#[command(next_help_heading = "Metadata")]
pub(crate) struct MetadataArgs {
    /// Name of the texture
    #[arg(long)]
    name: Option<String>,

    /// Who made it
    #[arg(long)]
    author: Option<String>,

    /// Licence of the asset, as an SPDX expression, e.g. CC-BY-4.0
    #[arg(long, value_name = "SPDX")]
    license: Option<String>,

    /// What the surface is, in words
    #[arg(long, value_name = "TEXT")]
    description: Option<String>,

    /// Tags, comma-separated; may be given several times
    #[arg(
        long,
        visible_alias = "tags",
        value_delimiter = ',',
        value_name = "WORD,…"
    )]
    tag: Option<Vec<String>>,

    /// Where the recordings come from: a dataset, a laboratory, an address
    #[arg(long, value_name = "TEXT")]
    source: Option<String>,

    /// DOI of the recordings or of the paper that describes them, e.g. 10.5281/zenodo.1234567
    #[arg(long)]
    doi: Option<String>,

    /// What measured the signal, e.g. "six-axis force sensor, ATI Nano17"
    #[arg(long, value_name = "TEXT")]
    sensor: Option<String>,

    /// What slid over the surface, e.g. "bare index finger"
    #[arg(long, value_name = "TEXT")]
    finger: Option<String>,
}

impl MetadataArgs {
    /// Whether any metadata was given.
    pub(crate) fn is_given(&self) -> bool {
        let texts = [&self.name, &self.author, &self.license, &self.description];
        let more = [&self.source, &self.doi, &self.sensor, &self.finger];
        self.tag.is_some() || texts.into_iter().chain(more).any(Option::is_some)
    }

    /// Reports early the errors that the asset's validation would find.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        if self
            .name
            .as_deref()
            .is_some_and(|name| name.trim().is_empty())
        {
            return Err(Failure::Usage(
                "--name: the name is empty; give one".to_owned(),
            ));
        }
        let doi = self.doi.as_deref().filter(|doi| !doi.is_empty());
        if let Some(Err(error)) = doi.map(check_doi) {
            return Err(Failure::Usage(format!("--doi: {error}")));
        }
        self.check_license()
    }

    fn check_license(&self) -> Result<(), Failure> {
        let license = self
            .license
            .as_deref()
            .filter(|license| !license.is_empty());
        let Some(Err(error)) = license.map(check_license) else {
            return Ok(());
        };
        if error.rule().severity == Severity::Error {
            return Err(Failure::Usage(format!("--license: {error}")));
        }
        warn(&[format!("--license: {error}")]);
        Ok(())
    }

    /// Writes the given metadata into a manifest; an empty text removes an entry.
    pub(crate) fn apply(&self, manifest: &mut Manifest) {
        if let Some(name) = &self.name {
            manifest.name.clone_from(name);
        }
        if let Some(tags) = &self.tag {
            manifest.tags = tags.iter().filter(|tag| !tag.is_empty()).cloned().collect();
        }
        let texts = [
            (&self.author, &mut manifest.author),
            (&self.license, &mut manifest.license),
            (&self.description, &mut manifest.description),
            (&self.source, &mut manifest.source),
            (&self.doi, &mut manifest.doi),
            (&self.sensor, &mut manifest.sensor),
            (&self.finger, &mut manifest.finger),
        ];
        for (given, kept) in texts {
            if let Some(text) = given {
                *kept = Some(text.clone()).filter(|text| !text.is_empty());
            }
        }
        manifest.declare_version();
    }
}
