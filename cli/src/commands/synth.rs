use std::path::PathBuf;

use clap::Args;
use htex::VoiceOptions;
use htex::play::exploration::CEILING;
use htex::play::{Effects, Synthesis};
use htex_format::Rights;

use crate::commands::spectrum::ChoiceArgs;
use crate::failure::{Exit, Failure, Result, for_file};
use crate::located;
use crate::output::{OutputFile, warn};
use crate::outputs::check_outputs;
use crate::plugins::PlayerArgs;
use crate::wav::write_wav;

/// Play an asset to a WAV file
///
/// The samples are 32-bit floats in the asset's unit, such as newtons. A force of a few
/// millinewtons gives a very quiet file. To listen, raise the level of the file in an audio editor,
/// or use `htex play` in a build with sound.
#[derive(Args)]
pub(crate) struct Synth {
    /// The asset
    #[arg(value_parser = located::ASSET)]
    asset: PathBuf,

    #[command(flatten)]
    choice: ChoiceArgs,

    #[command(flatten)]
    player: PlayerArgs,

    /// Outside the recorded speeds and forces, play the texture as it was recorded at the nearest
    /// speed and force. By default, frequencies and level follow the asset's law outside the
    /// recorded speeds and forces, and a finger at rest feels nothing
    #[arg(long)]
    as_recorded: bool,

    /// Largest level of the texture outside the recorded speeds and forces, as a multiple of the
    /// strongest recorded level; above 0
    #[arg(long, default_value_t = CEILING, value_name = "TIMES", conflicts_with = "as_recorded")]
    ceiling: f64,

    /// Let the strength of the texture fluctuate over time as in its recording, if the asset
    /// contains this fluctuation (`htex info` shows it). The fluctuation does not change the mean
    /// level. Nobody has tested whether this makes a texture feel more real
    #[arg(long)]
    fluctuation: bool,

    /// Duration, s
    #[arg(long, default_value_t = 10.0, value_name = "S")]
    seconds: f64,

    /// Sample rate, Hz
    #[arg(long, default_value_t = 20_000, value_name = "HZ",
          value_parser = clap::value_parser!(u32).range(100..=1_000_000))]
    rate: u32,

    /// Seed of the random numbers: the same seed gives the same samples
    #[arg(long, default_value_t = 0)]
    seed: u64,

    /// How to make the samples. `streamed`: the model computes every sample. `loop[:SECONDS]`: a
    /// piece of the model's samples repeats. `filter[:TAPS]`: a filter shapes white noise. Loops
    /// and filters need less computation, but their spectrum cannot follow the motion
    #[arg(long, default_value_t = Synthesis::Streamed, value_name = "WAY")]
    quality: Synthesis,

    /// The WAV file to write
    #[arg(short, long, value_name = "WAV", value_parser = located::OUTPUT)]
    output: PathBuf,
}

impl Synth {
    pub(crate) fn run(self) -> Result {
        if !(self.seconds > 0.0 && self.seconds <= 1e9) {
            let sentence = format!("--seconds {}: more than 0, at most 1e9", self.seconds);
            return Err(Failure::Usage(sentence));
        }
        if !(self.ceiling > 0.0 && self.ceiling.is_finite()) {
            let sentence = format!("--ceiling {}: a number above 0", self.ceiling);
            return Err(Failure::Usage(sentence));
        }
        check_outputs([self.output.as_path()], [self.asset.as_path()])?;
        let asset = self.player.open(&self.asset)?;
        let effects = if self.as_recorded { Effects::NONE } else { Effects::default() };
        let options = VoiceOptions::default()
            .with_rate_hz(f64::from(self.rate))
            .with_seed(self.seed)
            .with_motion(self.choice.motion(&asset).map_err(for_file(&self.asset))?)
            .with_synthesis(self.quality)
            .with_ceiling(self.ceiling)
            .with_fluctuation(self.fluctuation)
            .with_effects(effects);
        let beyond = self.choice.beyond(&asset, effects).map_err(for_file(&self.asset))?;
        warn(&Vec::from_iter(beyond));
        let representation = asset.representation(self.choice.model.as_deref());
        let mut voice = representation
            .and_then(|representation| representation.voice(&options))
            .map_err(for_file(&self.asset))?;
        // Even a very short duration gives at least one sample.
        let frames = (self.seconds * f64::from(self.rate)).round().max(1.0) as u64;
        let rights = Rights::from_manifest(asset.manifest());
        let wav = OutputFile::Named(&self.output);
        write_wav(wav, self.rate, frames, &rights, |block| {
            voice.render(block).map_err(for_file(&self.asset))
        })?;
        Ok(Exit::SUCCESS)
    }
}
