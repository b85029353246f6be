//! What a session needs from outside: someone to ask, a clock, and a rig that plays.

use std::time::Duration;

use serde::Serialize;

use crate::error::LabError;
use crate::study::file::{Attribute, GainMethod, Phase, Scale};
use crate::study::gain::GainKey;
use crate::study::lines::{FeltFile, OutputLevels};
use crate::study::stimulus::Stimulus;

/// What a participant sees.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum View {
    /// The next trial, or the matching of the next texture, begins when a key is pressed.
    Ready {
        /// The phase that begins.
        phase: Phase,
        texture: String,
        /// What happened before, for example that a trial is repeated.
        notice: Option<String>,
    },
    /// A trial plays.
    Playing { texture: String },
    Question {
        attribute: Attribute,
        scale: Scale,
        /// What happened in the trial, for example that the motion left its target.
        notice: Option<String>,
    },
    /// The texture plays. Either its level rises until it is felt, or its gain is matched.
    Matching {
        texture: String,
        /// The method, which determines the available keys.
        method: GainMethod,
        /// Whether the level is still rising until the texture is felt. While it rises, all keys
        /// have a meaning.
        rising: bool,
        /// The current gain, decibels relative to the maximum.
        gain_db: f64,
    },
    Rest {
        /// Seconds until the rest may end.
        seconds: u64,
    },
    /// The session is over.
    Done,
}

/// Time during which a question or a matching accepts no answer. A press in that time is the second
/// press of the key that answered the view before.
const GUARD: Duration = Duration::from_millis(300);
/// Time during which the start of a trial or the end of a rest accepts no key. Both use the same
/// key, and a double press, whose second press comes within 0.5 s, must only do one of them.
const LONG_GUARD: Duration = Duration::from_millis(600);

impl View {
    /// Returns how long after it is shown a press does not count, because it was meant for the view
    /// before.
    pub fn guard(&self) -> Duration {
        match self {
            Self::Question { .. } | Self::Matching { .. } => GUARD,
            Self::Ready { .. } | Self::Rest { seconds: 0 } => LONG_GUARD,
            Self::Rest { .. } | Self::Playing { .. } | Self::Done => Duration::ZERO,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Key {
    Digit(u8),
    /// A key of the gain matching.
    Gain(GainKey),
    /// The next thing may begin.
    Go,
    /// The session ends here and continues another time.
    Quit,
}

/// The participant who is asked, or a stand-in. Keys pressed within [`View::guard`] must be
/// ignored.
pub trait Asker {
    /// Shows a view. Keys that were pressed before are dropped. `done` of `all` trials have been
    /// rated.
    fn show(&mut self, view: &View, done: usize, all: usize);

    /// Returns the next key since the last [`Self::show`], if there is one.
    fn key(&mut self) -> Option<Key>;
}

pub trait Clock {
    /// Returns milliseconds since 1970, or since the start of a simulated session.
    fn now_ms(&self) -> u64;

    /// Waits for this time. A simulated clock only advances.
    fn pass(&mut self, time: Duration);

    /// Reports that something of this length was played, so that a simulated clock can advance.
    fn played(&mut self, time: Duration);

    /// Returns date and time in UTC in the format of [`crate::study::utc`]; `None` for a simulated
    /// clock.
    fn date(&self) -> Option<String>;

    /// Makes a simulated clock continue from this time. Other clocks ignore it.
    fn go_on_at(&mut self, ms: u64);
}

/// How something was played.
#[derive(Debug, Clone, PartialEq)]
pub struct Playback {
    /// Drive of a display, volts.
    pub drive_v: Option<f64>,
    /// Levels that the device was given.
    pub output: OutputLevels,
    /// RMS that corresponds to this drive, in the assets' unit.
    pub reference_rms: f64,
    /// The recording of what was felt, already on disk.
    pub felt: Option<FeltFile>,
}

/// Plays trials: a renderer and a device.
pub trait Rig {
    type Error: From<LabError> + std::fmt::Display;

    /// Plays a stimulus. Calls `ends` for each block and stops as soon as possible once it returns
    /// true.
    ///
    /// # Errors
    /// The errors of the renderer and of the device.
    fn play(
        &mut self,
        stimulus: &Stimulus,
        ends: &mut dyn FnMut() -> bool,
    ) -> Result<Playback, Self::Error>;

    /// Returns what the device was given in the last [`Self::play`] that ended with an error, and
    /// the drive of a display in volts. `None` if the device was not opened.
    fn output_before_error(&mut self) -> Option<(Option<f64>, OutputLevels)>;

    /// Returns whether an error of [`Self::play`] means that the device ran dry, so that playing
    /// again may succeed.
    fn ran_dry(error: &Self::Error) -> bool;

    /// Tells the experimenter what happened in a trial. The participant's view shows the same
    /// notice.
    fn tell(&self, notice: &str);

    /// Returns the nine-band error of a representation, decibels, if the asset states it.
    fn band_error_db(&self, texture: &str, model: &str) -> Option<f64>;

    /// Returns whether the program was asked to end.
    fn is_interrupted(&self) -> bool;
}
