use std::fmt::{Display, Formatter};
use std::path::PathBuf;

use clap::Args;
use htex::play::Effects;
use htex_format::Quantity;
use serde::Serialize;

use crate::failure::{Result, for_file};
use crate::located;
use crate::output::{show, warn};
use crate::plugins::PlayerArgs;

/// Show the spectrum that an asset plays
///
/// Prints the spectrum of one of the asset's models, from 20 to 1000 Hz in steps of 5 Hz.
///
/// The magnitudes are the same as the output of `htex process` for a long recording of the played
/// texture (with the default --averaging rms). Outside the recorded speeds and forces, the
/// magnitudes follow the law of the asset, i.e. its rule for speeds and forces that were not
/// recorded.
#[derive(Args)]
pub(crate) struct Spectrum {
    /// The asset
    #[arg(value_parser = located::ASSET)]
    asset: PathBuf,

    #[command(flatten)]
    choice: ChoiceArgs,

    #[command(flatten)]
    player: PlayerArgs,

    /// Do not apply the law of the asset. Outside the recorded speeds and forces, show the spectrum
    /// at the nearest recorded speed and force instead
    #[arg(long)]
    unscaled: bool,

    /// Print JSON instead of CSV
    #[arg(long)]
    json: bool,
}

/// Options that select how to play an asset: with which model, and at which speed and force.
#[derive(Args)]
pub(crate) struct ChoiceArgs {
    /// Which of the asset's models to play, by short name or id [default: the model with the
    /// smallest nine-band error]
    #[arg(long, value_name = "ID")]
    pub(crate) model: Option<String>,

    /// Scanning speed, mm/s [default: the speed of the asset's first condition, or of the strongest
    /// condition if the first is silent]
    #[arg(long, value_name = "MM_S")]
    speed: Option<f64>,

    /// Normal force, N [default: the force of the asset's first condition, or of the strongest
    /// condition if the first is silent]
    #[arg(long, value_name = "N")]
    force: Option<f64>,
}

impl ChoiceArgs {
    /// Returns the requested motion, or `None` if the user gave neither a speed nor a force. A
    /// missing value comes from the asset's default condition, or else from the paper (80 mm/s, 0.4
    /// N).
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

    /// If the requested motion is outside the recorded speeds and forces, returns a note on how the
    /// asset plays it.
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
    pub(crate) fn run(self) -> Result {
        let asset = self.player.open(&self.asset)?;
        let grid = htex::model::Band::TACTILE.grid_hz();
        let motion = self.choice.motion(&asset).map_err(for_file(&self.asset))?;
        let representation = asset.representation(self.choice.model.as_deref());
        let representation = representation.map_err(for_file(&self.asset))?;
        let (magnitude, effects) = if self.unscaled {
            (representation.recorded_magnitude(motion, &grid), Effects::NONE)
        } else {
            (representation.magnitude(motion, &grid), Effects::default())
        };
        let magnitude = magnitude.map_err(for_file(&self.asset))?;
        let beyond = self.choice.beyond(&asset, effects);
        if let Some(said) = beyond.map_err(for_file(&self.asset))? {
            warn(&[said]);
        }
        let quantity = asset.quantity();
        let unit = quantity.unit();
        show(&PlayedSpectrum { frequency_hz: grid, magnitude, quantity, unit }, self.json)
    }
}

/// The spectrum that an asset plays.
#[derive(Serialize)]
struct PlayedSpectrum {
    frequency_hz: Vec<f64>,
    magnitude: Vec<f64>,
    quantity: Quantity,
    unit: &'static str,
}

impl Display for PlayedSpectrum {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write_spectrum(f, self.quantity, &self.frequency_hz, &self.magnitude)
    }
}

/// Writes a spectrum as CSV.
pub(super) fn write_spectrum(
    f: &mut Formatter<'_>,
    quantity: Quantity,
    frequency_hz: &[f64],
    magnitude: &[f64],
) -> std::fmt::Result {
    writeln!(f, "frequency_hz,magnitude_{}", quantity.suffix())?;
    frequency_hz.iter().zip(magnitude).try_for_each(|(hz, m)| writeln!(f, "{hz},{m:.12}"))
}
