//! Edits metadata by writing the asset again. An asset is refused if this version would not write
//! all of its parts again, such as entries that nothing refers to.

use std::path::PathBuf;

use clap::Args;
use htex_author::settings::Metadata;
use htex_author::{AuthorError, edit};

use crate::assets::AssetSummary;
use crate::bounded::read_asset;
use crate::commands::validate::{refuse_library, refuse_more};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::metadata::checked;
use crate::of_file::OfFile;
use crate::output::{print, print_json, write_file};
use crate::outputs::check_outputs;
use crate::shown::shown;

/// Change an asset's metadata
///
/// Metadata that you do not give stays. An empty text (--author "") removes the entry, and --tag
/// replaces all tags. Parameters, recorded spectra and embedded models with their signatures stay
/// the same byte for byte.
#[derive(Args)]
pub(crate) struct Edit {
    /// The asset
    #[arg(value_parser = located::ASSET)]
    asset: PathBuf,

    /// Further assets, which are refused with what to do
    #[arg(hide = true)]
    more: Vec<PathBuf>,

    /// The asset to write [default: the asset itself]
    #[arg(short, long, value_name = "HTEX", value_parser = located::OUTPUT)]
    output: Option<PathBuf>,

    #[command(flatten)]
    metadata: Metadata,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl Edit {
    pub(crate) fn run(mut self) -> Result<Exit, Failure> {
        refuse_more("edit", &self.more)?;
        let metadata = std::mem::take(&mut self.metadata);
        if metadata.is_empty() {
            let sentence = "nothing to change: give at least one of the metadata, such as --author";
            return Err(Failure::Usage(sentence.to_owned()));
        }
        // The command sees the local copy of a remote asset. Replacing the copy would change
        // nothing.
        if self.output.is_none() && located::is_copy(&self.asset) {
            let file = located::named(&shown(&self.asset));
            return Err(Failure::Usage(format!(
                "{file}: an asset elsewhere is not replaced; name another file to write by -o FILE"
            )));
        }
        check_outputs(self.output.as_deref(), [self.asset.as_path()])?;
        refuse_library(&self.asset)?;
        checked(&metadata)?;
        let edited = edit(&read_asset(&self.asset)?, &metadata);
        let asset = edited.map_err(|error| match error {
            AuthorError::ReadAsset(error) => error.of(&self.asset),
            lost => Failure::Other(format!("{}: {lost}", shown(&self.asset))),
        })?;
        let output = self.output.as_ref().unwrap_or(&self.asset);
        let bytes = asset.to_bytes()?;
        write_file(output, &bytes)?;
        let summary = AssetSummary::new(output, bytes.len() as u64, &asset);
        if self.json {
            print_json(&summary)?;
        } else {
            print(&summary.to_text())?;
        }
        Ok(Exit::SUCCESS)
    }
}
