use std::path::{Path, PathBuf};

use clap::Args;
use htex_format::signing::SignedContent;
use htex_host::Registry;

use crate::assets::{AssetSummary, read_asset};
use crate::commands::validate::refuse_library;
use crate::failure::{Exit, Result, for_file};
use crate::keys::Signer;
use crate::located;
use crate::output::{print, print_json, show};

/// Show the contents and the errors of assets
///
/// Prints an asset's metadata, and a table with a row for each model at each condition (a pair of
/// a speed and a force). `level` is the RMS in the asset's unit. The other columns compare the
/// model's spectrum with the recorded spectrum: `corr.` is the Pearson correlation, `bands/dB` the
/// error over nine overlapping bands, `third-oct/dB` the error over third octaves, and `log-sp/dB`
/// the error over all frequencies. The columns `played…` show the same errors for samples that the
/// model rendered. `bytes` is the size of the model's parameters.
#[derive(Args)]
pub(crate) struct Info {
    /// The assets
    #[arg(required = true, value_parser = located::ASSETS)]
    assets: Vec<PathBuf>,

    /// Print JSON instead of a table: an object, or an array if you ask for several assets
    #[arg(long)]
    json: bool,
}

impl Info {
    pub(crate) fn run(self) -> Result {
        let files = located::each(&self.assets);
        if let ([file], true) = (&files[..], files == self.assets) {
            return show(&summary(file)?, self.json);
        }
        let summaries = files.iter().map(|file| summary(file));
        if self.json {
            print_json(&summaries.collect::<Result<Vec<_>>>()?)?;
            return Ok(Exit::SUCCESS);
        }
        for (i, summary) in summaries.enumerate() {
            let line = if i == 0 { "" } else { "\n" };
            print(&format!("{line}{}", summary?))?;
        }
        Ok(Exit::SUCCESS)
    }
}

fn summary(file: &Path) -> Result<AssetSummary> {
    refuse_library(file)?;
    let asset = htex_format::Asset::open(file).map_err(for_file(file))?;
    let bytes = std::fs::metadata(file).map_or(0, |m| m.len());
    let mut summary = AssetSummary::new(file, bytes, &asset);
    summary.signer = Signer::of_file(file, |_| {
        SignedContent::asset(&read_asset(file)?).map_err(for_file(file))
    })?;
    let models = Registry::builtin();
    let embeds = |id: &str| asset.manifest.plugins.iter().any(|p| p.model == id);
    let representations = asset.manifest.representations.iter();
    for representation in representations.filter(|r| !embeds(&r.model)) {
        let model = htex::play::model_of(&models, representation).ok();
        let order = model.map(|model| htex::play::field_order(representation, model));
        if let Some(Err(error)) = order {
            summary.notes.push(error.to_string());
        }
    }
    Ok(summary)
}
