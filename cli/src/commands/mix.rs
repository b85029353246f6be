use std::path::{Path, PathBuf};

use clap::Args;
use htex_author::by_hand::{MixedAsset, mix};
use htex_author::settings::Metadata;

use crate::assets::{check_metadata, read_asset, write_and_show};
use crate::failure::{Failure, Result};
use crate::invocation::tool;
use crate::located;
use crate::outputs::check_outputs;
use crate::plugins::PlayerArgs;

/// Make a texture between two others
///
/// For each model that both textures have, htex interpolates between the parameters of the two
/// textures. htex interpolates in the same way between the recorded speeds and forces of one
/// texture. The new asset states the names of the two textures.
#[derive(Args)]
pub(crate) struct Mix {
    /// The first texture
    #[arg(value_parser = located::ASSET)]
    a: PathBuf,

    /// The second texture
    #[arg(value_parser = located::ASSET)]
    b: PathBuf,

    /// Weight of the second texture, from 0 to 1
    #[arg(long, value_name = "PART")]
    weight: f64,

    /// The asset to write
    #[arg(short, long, value_name = "HTEX", value_parser = located::OUTPUT)]
    output: PathBuf,

    #[command(flatten)]
    metadata: Metadata,

    #[command(flatten)]
    player: PlayerArgs,

    /// Print JSON instead of a table
    #[arg(long)]
    json: bool,
}

impl Mix {
    pub(crate) fn run(self) -> Result {
        check_outputs([self.output.as_path()], [self.a.as_path(), self.b.as_path()])?;
        check_metadata(&self.metadata)?;
        let [a, b] = [self.open(&self.a)?, self.open(&self.b)?];
        let [first, second] = [&a, &b].map(|(asset, blake3)| MixedAsset { asset, blake3 });
        let name = self.output.file_stem().unwrap_or_default().to_string_lossy();
        let mixed = mix(first, second, self.weight, &name, &tool());
        let mut asset = mixed.map_err(Failure::other)?;
        self.metadata.apply(&mut asset.manifest);
        write_and_show(&self.output, &asset, self.json)
    }

    /// Opens a texture and computes the hash of its file.
    fn open(&self, path: &Path) -> Result<(htex::Texture, String)> {
        let asset = self.player.open(path)?;
        // An opened asset does not keep its file's bytes, and writing it again may give different
        // bytes.
        let bytes = read_asset(path)?;
        Ok((asset, blake3::hash(&bytes).to_hex().to_string()))
    }
}
