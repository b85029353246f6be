use std::path::PathBuf;

use clap::Args;
use htex::play::Effects;
use serde_json::json;

use crate::exit::Exit;
use crate::failure::Failure;
use crate::located;
use crate::of_file::of_file;
use crate::output::{print, print_json, warn};
use crate::plugins::PlayerArgs;

/// Show the spectrum that an asset plays
///
/// Prints one representation, 20 to 1000 Hz in steps of 5 Hz.
///
/// Magnitudes are comparable with `htex process`: they are what a long recording of the voice would
/// measure if segments are averaged by power. Outside the recorded speeds and forces they follow
/// the law of the asset, as a voice does.
#[derive(Args)]
pub(crate) struct Spectrum {
    /// The asset
    #[arg(value_parser = located::ASSET)]
    asset: PathBuf,

    #[command(flatten)]
    choice: ChoiceArgs,

    #[command(flatten)]
    player: PlayerArgs,

    /// Show the nearest recorded spectrum, without the law of the asset
    #[arg(long)]
    unscaled: bool,

    /// Print JSON instead of CSV
    #[arg(long)]
    json: bool,
}

/// A choice of a representation and a motion.
#[derive(Args)]
pub(crate) struct ChoiceArgs {
    /// The representation, by its model's short name or id [default: least nine-band error]
    #[arg(long, value_name = "ID")]
    pub(crate) model: Option<String>,

    /// Scanning speed, mm/s [default: the first condition, or the strongest if the first is silent]
    #[arg(long, value_name = "MM_S")]
    speed: Option<f64>,

    /// Normal force, N [default: the first condition, or the strongest if the first is silent]
    #[arg(long, value_name = "N")]
    force: Option<f64>,
}

impl ChoiceArgs {
    /// Returns the requested motion. Missing values come from the asset's default condition, or
    /// else from the paper's default.
    pub(crate) fn motion(
        &self,
        asset: &htex::Texture,
    ) -> Result<Option<htex::Motion>, htex::Error> {
        if self.speed.is_none() && self.force.is_none() {
            return Ok(None);
        }
        let representation = asset.representation(self.model.as_deref())?;
        Ok(Some(representation.motion(self.speed, self.force)))
    }
}

impl ChoiceArgs {
    /// Returns a note on how a motion that was not recorded is played.
    pub(crate) fn beyond(
        &self,
        asset: &htex::Texture,
        effects: Effects,
    ) -> Result<Option<String>, htex::Error> {
        let Some(motion) = self.motion(asset)? else {
            return Ok(None);
        };
        let conditions = asset.representation(self.model.as_deref())?.conditions()?;
        let coverage = conditions.coverage(motion, effects);
        Ok((!coverage.is_inside()).then(|| coverage.to_string()))
    }
}

impl Spectrum {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        let asset = self.player.open(&self.asset)?;
        let grid = htex::model::Band::TACTILE.grid_hz();
        let motion = self.choice.motion(&asset).map_err(of_file(&self.asset))?;
        let representation = asset.representation(self.choice.model.as_deref());
        let representation = representation.map_err(of_file(&self.asset))?;
        let (magnitude, effects) = if self.unscaled {
            (representation.recorded_magnitude(motion, &grid), Effects::NONE)
        } else {
            (representation.magnitude(motion, &grid), Effects::default())
        };
        let magnitude = magnitude.map_err(of_file(&self.asset))?;
        let beyond = self.choice.beyond(&asset, effects);
        if let Some(said) = beyond.map_err(of_file(&self.asset))? {
            warn(&[said]);
        }
        let quantity = asset.quantity();
        if self.json {
            print_json(&json!({
                "quantity": quantity,
                "unit": quantity.unit(),
                "frequency_hz": grid,
                "magnitude": magnitude,
            }))?;
        } else {
            let rows = grid.iter().zip(&magnitude);
            let rows: String = rows.map(|(f, m)| format!("{f},{m:.12}\n")).collect();
            let suffix = quantity.suffix();
            print(&format!("frequency_hz,magnitude_{suffix}\n{rows}"))?;
        }
        Ok(Exit::SUCCESS)
    }
}
