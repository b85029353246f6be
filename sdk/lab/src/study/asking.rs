//! What a session needs of its surroundings: the one who is asked, a clock, and what plays.

use std::time::Duration;

use serde::Serialize;

use crate::study::error::StudyError;
use crate::study::file::{Attribute, GainMethod, Phase, Scale};
use crate::study::gain::GainKey;
use crate::study::lines::{FeltFile, OutputLevels};
use crate::study::stimulus::Stimulus;

/// What a participant sees.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum View {
    /// The next trial, or the matching of the next texture, begins with a key.
    Ready {
        /// What begins.
        phase: Phase,
        texture: String,
        /// What happened before, such as a trial that is repeated.
        notice: Option<String>,
    },
    /// A trial plays.
    Playing { texture: String },
    Question {
        attribute: Attribute,
        scale: Scale,
        /// What happened in the trial, such as a motion off its target.
        notice: Option<String>,
    },
    /// The texture plays, and its level rises until it is felt, or its gain is matched.
    Matching {
        texture: String,
        /// The method, which says which keys there are.
        method: GainMethod,
        /// Whether the level still rises to where the texture is felt: all keys have a meaning
        /// then.
        rising: bool,
        /// The present gain, decibels relative to the maximum.
        gain_db: f64,
    },
    Rest {
        /// Seconds until it may end.
        seconds: u64,
    },
    /// The session is over.
    Done,
}

/// A question or a matching takes no answer for this long: the second press of a key that answered
/// the one before.
const GUARD: Duration = Duration::from_millis(300);
/// What begins a trial or ends a rest takes no key for this long: both begin by the same key, and a
/// double press, of which the second one comes within 0.5 s, is to do one of them.
const LONG_GUARD: Duration = Duration::from_millis(600);

impl View {
    /// Time after it is shown in which a press is no answer: it was meant for what was shown
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
    /// The session ends here and goes on at another time.
    Quit,
}

/// The one who is asked. A key that a person presses within [`View::guard`] is none.
pub trait Asker {
    /// Shows what there is now. Keys that were pressed before are forgotten. `done` of `all` trials
    /// are rated.
    fn show(&mut self, view: &View, done: usize, all: usize);

    /// The next key since the last [`Self::show`], if there is one.
    fn key(&mut self) -> Option<Key>;
}

pub trait Clock {
    /// Milliseconds since 1970, or since the start of a simulated session.
    fn now_ms(&self) -> u64;

    /// Lets time pass; a simulated clock does not wait.
    fn pass(&mut self, time: Duration);

    /// Something of this length was played, which a simulated clock has not noticed.
    fn played(&mut self, time: Duration);

    /// Date and time in UTC, as [`crate::study::utc`] writes them; `None` of a simulated clock.
    fn date(&self) -> Option<String>;

    /// A simulated clock goes on at this time; others do not.
    fn go_on_at(&mut self, ms: u64);
}

/// How something was played.
#[derive(Debug, Clone, PartialEq)]
pub struct Played {
    /// Drive of a display, volts.
    pub drive_v: Option<f64>,
    /// What the device was given.
    pub output: OutputLevels,
    /// RMS that had this drive, in the assets' unit.
    pub reference_rms: f64,
    /// The recording of what was felt, which is on disk.
    pub felt: Option<FeltFile>,
}

/// What plays: a renderer and a device.
pub trait Rig {
    type Error: From<StudyError> + std::fmt::Display;

    /// Plays, and calls `ends` for each block; when that returns true, playing ends as soon as it
    /// can.
    ///
    /// # Errors
    /// Of the renderer and of the device.
    fn play(
        &mut self,
        stimulus: &Stimulus,
        ends: &mut dyn FnMut() -> bool,
    ) -> Result<Played, Self::Error>;

    /// What the device was given in the last [`Self::play`] that ended with an error, and the drive
    /// of a display, volts; `None` if the device was not opened.
    fn output_before_error(&mut self) -> Option<(Option<f64>, OutputLevels)>;

    /// Whether an error of [`Self::play`] is that of a device that ran dry, so that playing again
    /// may succeed.
    fn ran_dry(error: &Self::Error) -> bool;

    /// Tells the person who conducts the session what happened in a trial; the participant's view
    /// has the same notice.
    fn tell(&self, notice: &str);

    /// The nine-band error of a representation, decibels, if its asset says it.
    fn band_error_db(&self, texture: &str, model: &str) -> Option<f64>;

    /// Whether the program was asked to end.
    fn is_interrupted(&self) -> bool;
}
