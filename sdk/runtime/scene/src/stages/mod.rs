//! The stages of a chain: one file per effect, with the condition under which the effect is needed.
//!
//! An effect that stays constant during the scene needs no stage. A constant frequency factor
//! becomes part of the resampler's ratio, and a constant level factor becomes part of the level.
//! Linear effects of a texture run at the model's rate, before resampling. Frequency scaling is the
//! only stage whose ratio of input samples to output samples changes.
//!
//! The fluctuation of textures is needed only in a scene that switches this effect on.
//!
//! A scene may switch on an effect that is not needed. An effect that is not needed changes no bit
//! of the samples, or changes them by at most 1e-6 of full scale
//! (`sdk/runtime/scene/tests/it/equivalence.rs`). Therefore, leaving out an effect that is not
//! needed only saves time.

mod carrier;
mod chain;
mod compensation;
mod contact;
mod crossfade;
mod direction;
mod dither;
mod fluctuation;
mod frequency_scaling;
mod gain;
mod interpolation;
mod level;
mod level_scaling;
mod limiter;
mod quantisation;
mod resampling;
mod square_root;
mod synthesis;

pub use chain::StageRun;
pub(crate) use chain::{Chain, Slot};
pub(crate) use compensation::taps as compensation_taps;
pub(crate) use crossfade::Crossfade;
pub(crate) use gain::{Drive, HEADROOM};
pub(crate) use level::Level;
pub(crate) use resampling::work as resampling_work;
pub(crate) use synthesis::Synthesis;

use htex_dsp::resample::UnusableRates;
use htex_play::Motion;

use crate::file::Effect;
use crate::played::PlayedSurface;
use crate::requirements::Requirements;

/// A stage of a chain. It requests the input that it needs from its source.
pub(crate) trait Stage: Send {
    /// Receives the motion before each control block.
    fn follow(&mut self, _now: &Context) {}

    /// Fills `out`. Does not allocate, lock or do I/O.
    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32]));

    /// Adds the number of samples that the stage corrected.
    fn count(&self, _statistics: &mut Statistics) {}
}

/// State of a control block.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Context {
    pub(crate) finger: Motion,
    /// RMS of the current surface, in the assets' unit.
    pub(crate) level_rms: f64,
    /// Frames until the end of the scene; `None` if endless.
    pub(crate) ends_in: Option<u64>,
}

/// The reason for leaving out frequency scaling and level scaling.
pub(crate) const FOLLOWS: &str = "the model follows the motion itself";

/// Counts of corrected samples.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Statistics {
    /// Samples clipped at the device's limit.
    pub(crate) limited: u64,
    /// Negative radicands set to zero.
    pub(crate) rooted: u64,
}

/// Whether an effect is needed, and the reason.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Need {
    In(String),
    Out(String),
}

impl Need {
    pub(crate) fn yes(reason: impl Into<String>) -> Self {
        Self::In(reason.into())
    }

    pub(crate) fn no(reason: impl Into<String>) -> Self {
        Self::Out(reason.into())
    }
}

/// The place of an effect in the chain. It holds the function that decides whether the effect is
/// needed, and the function that builds its stage. `neutral` means that the effect is not needed
/// and must not change any sample.
#[derive(Debug)]
pub(crate) enum StagePlace {
    /// Once per surface, at the model's rate, before surfaces are mixed.
    Surface {
        need: fn(&Requirements, &PlayedSurface) -> Need,
        /// `None` if the effect has no stage of its own in the chain.
        build: Option<BuildFor>,
    },
    /// Once per mix of surfaces with the same rate. One of the surfaces decides whether the effect
    /// is needed.
    Mix { need: fn(&Requirements, &PlayedSurface) -> Need, build: BuildMix },
    /// Once, after mixing, at the device's rate.
    Device {
        need: fn(&Requirements) -> Need,
        build: fn(&Requirements, neutral: bool) -> Box<dyn Stage>,
    },
}

/// Builds the stage of an effect for a surface.
type BuildFor = fn(&Requirements, &PlayedSurface, neutral: bool) -> Box<dyn Stage>;

/// Builds the stage of an effect for a mix of surfaces with the same rate.
type BuildMix =
    fn(&Requirements, &PlayedSurface, neutral: bool) -> Result<Box<dyn Stage>, UnusableRates>;

/// An entry of the table of effects.
#[derive(Debug)]
pub(crate) struct Entry {
    pub(crate) effect: Effect,
    pub(crate) name: &'static str,
    pub(crate) place: StagePlace,
}

/// All effects, in processing order.
pub(crate) const EFFECTS: &[Entry] = &[
    interpolation::ENTRY,
    frequency_scaling::ENTRY,
    level_scaling::ENTRY,
    fluctuation::ENTRY,
    crossfade::ENTRY,
    compensation::ENTRY,
    resampling::ENTRY,
    direction::ENTRY,
    gain::ENTRY,
    square_root::ENTRY,
    contact::ENTRY,
    carrier::ENTRY,
    limiter::ENTRY,
    dither::ENTRY,
    quantisation::ENTRY,
];
