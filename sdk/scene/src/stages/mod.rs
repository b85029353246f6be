//! What a chain is made of. A file an effect: its need, stated beside its code.

mod carrier;
mod chain;
mod compensation;
mod contact;
mod crossfade;
mod direction;
mod dither;
mod force_scaling;
mod gain;
mod interpolation;
mod level;
mod limiter;
mod quantisation;
mod resampling;
mod speed_scaling;
mod square_root;
mod synthesis;

pub use chain::StageRun;
pub(crate) use chain::{Chain, Slot};
pub(crate) use compensation::taps as compensation_taps;
pub(crate) use crossfade::Crossfade;
pub(crate) use gain::{Drive, HEADROOM};
pub(crate) use level::Level;
pub(crate) use resampling::macs as resampling_macs;
pub(crate) use synthesis::Synthesis;

use htex_dsp::resample::UnusableRates;

use crate::call::{Call, Part};
use crate::file::Effect;
use crate::motion::Finger;

/// One part of a chain. Samples are pulled: a stage asks its source for what it needs.
pub(crate) trait Stage: Send {
    /// Hears of the finger, before each control block.
    fn follow(&mut self, _now: &Now) {}

    /// Fills `out`. Does not allocate, lock or do I/O.
    fn render(&mut self, out: &mut [f32], source: &mut dyn FnMut(&mut [f32]));

    /// Tells what it had to do to the samples.
    fn tell(&self, _told: &mut Told) {}
}

/// What a control block is to be made for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Now {
    pub(crate) finger: Finger,
    /// RMS of the surface at hand, newtons.
    pub(crate) level_rms: f64,
    /// Frames until the scene ends.
    pub(crate) ends_in: Option<u64>,
}

/// Why a surface is not scaled by the motion.
pub(crate) const FOLLOWS: &str = "the model follows the motion itself";

/// What the stages had to do to the samples.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Told {
    /// Samples held at the device's limit.
    pub(crate) limited: u64,
    /// Radicands held at zero.
    pub(crate) rooted: u64,
}

/// Whether a scene calls for an effect, and why.
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

/// An effect: when it is needed, and how it is made. `neutral`: the scene does not call for it, and
/// it must not change a sample.
#[derive(Debug)]
pub(crate) enum Place {
    /// For one surface, at its model's rate, before surfaces are mixed.
    Surface {
        need: fn(&Call, &Part) -> Need,
        /// None: it has no stage of its own in the chain of samples.
        build: Option<BuildFor>,
    },
    /// For the surfaces of one rate, mixed; the need is that of one of them.
    Mix {
        need: fn(&Call, &Part) -> Need,
        build: BuildMix,
    },
    /// For the sum of all, at the device's rate.
    Device {
        need: fn(&Call) -> Need,
        build: fn(&Call, neutral: bool) -> Box<dyn Stage>,
    },
}

/// Makes the stage of an effect for a surface.
type BuildFor = fn(&Call, &Part, neutral: bool) -> Box<dyn Stage>;

/// Makes the stage of an effect for the surfaces of one rate.
type BuildMix = fn(&Call, &Part, neutral: bool) -> Result<Box<dyn Stage>, UnusableRates>;

/// An effect in the table.
#[derive(Debug)]
pub(crate) struct Entry {
    pub(crate) effect: Effect,
    pub(crate) name: &'static str,
    pub(crate) place: Place,
}

/// All effects, in the order in which samples come through them.
pub(crate) const EFFECTS: &[Entry] = &[
    interpolation::ENTRY,
    speed_scaling::ENTRY,
    force_scaling::ENTRY,
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
