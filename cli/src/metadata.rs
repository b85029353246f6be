//! Arguments for a texture's metadata.

use clap::Args;
use htex_author::settings::Metadata;

use crate::failure::Failure;
use crate::output::warn;

/// Metadata: what a texture is, who made it, and how it was recorded.
#[derive(Args, Default)]
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
    /// The metadata that was given.
    pub(crate) fn given(self) -> Metadata {
        Metadata {
            name: self.name,
            author: self.author,
            license: self.license,
            description: self.description,
            tags: self.tag,
            source: self.source,
            doi: self.doi,
            sensor: self.sensor,
            finger: self.finger,
        }
    }
}

/// Reports what the asset's validation would find in metadata.
pub(crate) fn checked(metadata: &Metadata) -> Result<(), Failure> {
    let warnings: Vec<String> = metadata.check()?.iter().map(|w| format!("--{w}")).collect();
    warn(&warnings);
    Ok(())
}
