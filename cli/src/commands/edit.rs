//! Edits metadata, extensions and the fluctuation, and writes the asset again. Refuses an asset if this version
//! would lose a part of it when writing, such as an entry that the manifest does not name.

use std::path::{Path, PathBuf};

use clap::Args;
use htex_author::settings::{GivenFluctuation, Metadata};
use htex_author::{AuthorError, Coding, edit};
use htex_base::files::AtFile;
use serde_json::Value;

use crate::assets::{check_metadata, read_asset, write_and_show};
use crate::commands::validate::refuse_library;
use crate::failure::{Failure, Result};
use crate::located;
use crate::output::shown;
use crate::outputs::check_outputs;

/// Change an asset's metadata
///
/// The command changes only the metadata, extensions and fluctuation that you give. To remove an
/// entry, give an empty text, e.g. --author "". Only the name cannot be removed. The flag --tag
/// replaces all tags of the asset. Parameters, recorded spectra and embedded models with their
/// signatures stay the same, byte for byte. The flag --storage changes the bytes of the parameters,
/// but not their values.
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

    /// Set the extension with this name to the JSON in FILE. Without FILE, remove the extension.
    /// May be given several times
    #[arg(long, value_name = "com.vendor.NAME/1=FILE")]
    extension: Vec<String>,

    /// Set how much the strength of the texture varies over time: two standard deviations in
    /// decibels, for variations at 0.5 to 8 Hz and at 8 to 32 Hz, each from 0 to 7.97, e.g. 3,1.5.
    /// The value 0,0 removes the fluctuation
    #[arg(long, value_name = "SLOW,FAST", allow_hyphen_values = true)]
    fluctuation: Option<GivenFluctuation>,

    /// Make the asset a coded asset, or make a coded asset plain again. A coded asset plays the
    /// same texture and has fewer bytes, but readers of version 1.0 of the format refuse it.
    /// `auto`: code it only with more than eight conditions, and only if the file becomes smaller
    #[arg(long, value_enum)]
    storage: Option<Coding>,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl Edit {
    pub(crate) fn run(mut self) -> Result {
        if let Some(second) = self.more.first() {
            let file = shown(second);
            return Err(Failure::Usage(format!(
                "{file}: one asset is edited; run the command for each"
            )));
        }
        let metadata = std::mem::take(&mut self.metadata);
        let changes_more =
            !self.extension.is_empty() || self.fluctuation.is_some() || self.storage.is_some();
        if metadata.is_empty() && !changes_more {
            return Err(Failure::usage(
                "nothing to change: give at least one of the metadata, such as --author",
            ));
        }
        let extensions =
            self.extension.iter().map(|given| named_file(given)).collect::<Result<Vec<_>>>()?;
        // Here, a remote asset is only a local copy. Replacing the copy would not change the remote
        // asset.
        if self.output.is_none() && located::is_copy(&self.asset) {
            let file = located::with_uris(&shown(&self.asset));
            return Err(Failure::Usage(format!(
                "{file}: an asset elsewhere is not replaced; name another file to write by -o FILE"
            )));
        }
        let files = extensions.iter().filter_map(|(_, file)| file.as_deref());
        check_outputs(self.output.as_deref(), files.chain([self.asset.as_path()]))?;
        refuse_library(&self.asset)?;
        check_metadata(&metadata)?;
        let extensions = extensions
            .into_iter()
            .map(|(name, file)| Ok((name, file.map_or(Ok(Value::Null), |file| json_of(&file))?)))
            .collect::<Result<_>>()?;
        let edited = edit(&read_asset(&self.asset)?, &metadata);
        let failure = |error| match error {
            AuthorError::ReadAsset(error) => Failure::from(error),
            lost => Failure::other(lost),
        };
        let mut asset = edited.map_err(|error| failure(error).in_file(&self.asset))?;
        let is_set = asset.manifest.set_extensions(extensions);
        is_set.map_err(|error| Failure::Usage(format!("--extension: {error}")))?;
        if let Some(fluctuation) = self.fluctuation {
            fluctuation.apply(&mut asset.manifest);
        }
        if let Some(coding) = self.storage {
            asset = coding.of(asset);
        }
        write_and_show(self.output.as_ref().unwrap_or(&self.asset), &asset, self.json)
    }
}

/// Reads `com.vendor.NAME/1=FILE`. Without the file, the extension is removed.
fn named_file(argument: &str) -> Result<(String, Option<PathBuf>)> {
    let (name, file) = argument.split_once('=').ok_or_else(|| {
        Failure::Usage(format!("--extension {argument}: give com.vendor.NAME/1=FILE"))
    })?;
    Ok((name.to_owned(), Some(PathBuf::from(file)).filter(|_| !file.is_empty())))
}

fn json_of(file: &Path) -> Result<Value> {
    let bytes = std::fs::read(file).reading(file)?;
    htex_format::parse_json(&bytes)
        .map_err(|error| Failure::Usage(format!("{}: {error}", shown(file))))
}
