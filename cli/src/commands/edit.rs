//! Edits metadata by writing the asset again. Refuses an asset with parts that this version would
//! not write again, such as entries that nothing refers to.

use std::path::PathBuf;

use clap::Args;
use htex_author::settings::Metadata;
use htex_author::{AuthorError, edit};

use crate::assets::{check_metadata, read_asset, write_and_show};
use crate::commands::validate::{refuse_library, refuse_more};
use crate::failure::{Failure, Result};
use crate::located;
use crate::output::shown;
use crate::outputs::check_outputs;

/// Change an asset's metadata
///
/// The command changes only the metadata that you give. An empty text removes an entry, e.g.
/// --author "". The flag --tag replaces all tags of the asset. Parameters, recorded spectra and
/// embedded models with their signatures stay the same, byte for byte.
#[derive(Args)]
pub(crate) struct Edit {
    /// The asset
    #[arg(value_parser = located::ASSET)]
    asset: PathBuf,

    /// Further assets. The command refuses further assets, and says what to do instead
    #[arg(hide = true)]
    more: Vec<PathBuf>,

    /// The file to write [default: replace the asset]
    #[arg(short, long, value_name = "HTEX", value_parser = located::OUTPUT)]
    output: Option<PathBuf>,

    #[command(flatten)]
    metadata: Metadata,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl Edit {
    pub(crate) fn run(mut self) -> Result {
        refuse_more("edit", &self.more)?;
        let metadata = std::mem::take(&mut self.metadata);
        if metadata.is_empty() {
            return Err(Failure::usage(
                "nothing to change: give at least one of the metadata, such as --author",
            ));
        }
        // Here, a remote asset is only a local copy. Replacing the copy would not change the remote
        // asset.
        if self.output.is_none() && located::is_copy(&self.asset) {
            let file = located::with_uris(&shown(&self.asset));
            return Err(Failure::Usage(format!(
                "{file}: an asset elsewhere is not replaced; name another file to write by -o FILE"
            )));
        }
        check_outputs(self.output.as_deref(), [self.asset.as_path()])?;
        refuse_library(&self.asset)?;
        check_metadata(&metadata)?;
        let edited = edit(&read_asset(&self.asset)?, &metadata);
        let failure = |error| match error {
            AuthorError::ReadAsset(error) => Failure::from(error),
            lost => Failure::other(lost),
        };
        let asset = edited.map_err(|error| failure(error).in_file(&self.asset))?;
        write_and_show(self.output.as_ref().unwrap_or(&self.asset), &asset, self.json)
    }
}
