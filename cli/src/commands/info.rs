use std::path::PathBuf;

use clap::Args;
use htex_host::Registry;

use crate::assets::AssetSummary;
use crate::commands::validate::{refuse_library, refuse_more};
use crate::failure::{Result, for_file};
use crate::located;
use crate::output::show;

/// Show the contents and the errors of an asset
///
/// Prints the asset's metadata, and a table with a row for each model at each condition (a pair of
/// a speed and a force). `level` is the RMS in the asset's unit. The other columns compare the
/// model's spectrum with the recorded spectrum: `corr.` is the Pearson correlation, `bands/dB` the
/// error over nine overlapping bands, `third-oct/dB` the error over third octaves, and `log-sp/dB`
/// the error over all frequencies. The columns `played…` show the same errors for samples that the
/// model rendered. `bytes` is the size of the model's parameters.
#[derive(Args)]
pub(crate) struct Info {
    /// The asset
    #[arg(value_parser = located::ASSET)]
    asset: PathBuf,

    /// Further assets. The command refuses further assets, and says what to do instead
    #[arg(hide = true)]
    more: Vec<PathBuf>,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl Info {
    pub(crate) fn run(self) -> Result {
        refuse_more("info", &self.more)?;
        refuse_library(&self.asset)?;
        let asset = htex_format::Asset::open(&self.asset).map_err(for_file(&self.asset))?;
        let bytes = std::fs::metadata(&self.asset).map_or(0, |m| m.len());
        let mut summary = AssetSummary::new(&self.asset, bytes, &asset);
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
        show(&summary, self.json)
    }
}
