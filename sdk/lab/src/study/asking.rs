//! Traits through which a session asks the participant, reads a clock and plays trials.

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
    /// The participant must press a key to begin the next trial, or the matching of the next
    /// texture.
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
    /// A texture plays. The participant either raises the texture's level until the texture can be
    /// felt, or matches the texture's gain.
    Matching {
        texture: String,
        /// The method, which determines the available keys.
        method: GainMethod,
        /// Whether the level is still rising. While it rises, all keys have a meaning.
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

/// After a question or a matching is shown, keys are ignored for this time. A press in this time is
/// the second press of the key that answered the previous view.
const GUARD: Duration = Duration::from_millis(300);
/// At the start of a trial and at the end of a rest, keys are ignored for this time. The same key
/// ends a rest and begins a trial. If the participant presses the key twice within 0.5 s, only one
/// of the two must happen.
const LONG_GUARD: Duration = Duration::from_millis(600);

impl View {
    /// Returns the time for which the connection to the participant must ignore keys after it shows
    /// this view. Keys pressed in this time were meant for the previous view.
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
    /// A key that the participant can press during the gain matching.
    Gain(GainKey),
    /// The key that begins a trial or continues the session.
    Go,
    /// The key that ends the session. The participant can continue the session later.
    Quit,
}

/// The connection to the participant, who may be simulated. After the connection shows a view, it
/// must ignore keys for the time that [`View::guard`] returns.
pub trait Asker {
    /// Shows a view, and drops keys that were pressed before. `done` is the number of trials rated
    /// so far, and `all` is the number of all trials.
    fn show(&mut self, view: &View, done: usize, all: usize);

    /// Returns the next key that was pressed since the last [`Self::show`], or `None` if no key was
    /// pressed.
    fn key(&mut self) -> Option<Key>;
}

pub trait Clock {
    /// Returns the time in milliseconds since 1970, or since the start of the session for a
    /// simulated clock.
    fn now_ms(&self) -> u64;

    /// Waits for this time. A simulated clock does not wait: it moves forward by this time at once.
    fn pass(&mut self, time: Duration);

    /// Advances a simulated clock by the duration of a stimulus that was played.
    fn played(&mut self, time: Duration);

    /// Returns date and time in UTC, in the format of [`crate::study::utc`], or `None` for a
    /// simulated clock.
    fn date(&self) -> Option<String>;

    /// Sets a simulated clock to the time `ms`, from which it then continues. Other clocks ignore
    /// this call.
    fn go_on_at(&mut self, ms: u64);
}

/// How a stimulus was played.
#[derive(Debug, Clone, PartialEq)]
pub struct Playback {
    /// Drive of a display, volts.
    pub drive_v: Option<f64>,
    /// Levels of the samples that were written to the device.
    pub output: OutputLevels,
    /// Reference level, in the assets' unit: the RMS that is mapped to the device's drive voltage
    /// or preview level.
    pub reference_rms: f64,
    /// The recording of the force on the participant's finger, already written to a file.
    pub felt: Option<FeltFile>,
}

/// A renderer and a device, which together play trials.
pub trait Rig {
    type Error: From<LabError> + std::fmt::Display;

    /// Plays a stimulus. Calls `ends` for each block, and stops as soon as possible after `ends`
    /// returns true.
    ///
    /// # Errors
    /// Returns the errors of the renderer and of the device.
    fn play(
        &mut self,
        stimulus: &Stimulus,
        ends: &mut dyn FnMut() -> bool,
    ) -> Result<Playback, Self::Error>;

    /// Returns two values of the last [`Self::play`] that ended with an error: the drive of a
    /// display (volts), and the levels of the samples that were written to the device. Returns
    /// `None` if the device was not opened.
    fn output_before_error(&mut self) -> Option<(Option<f64>, OutputLevels)>;

    /// Returns whether an error of [`Self::play`] means that the device ran out of samples. Playing
    /// again may then succeed.
    fn ran_dry(error: &Self::Error) -> bool;

    /// Tells the experimenter what happened in a trial. The participant's view shows the same
    /// notice.
    fn tell(&self, notice: &str);

    /// Returns the nine-band error of `model` for `texture`, decibels, if the asset states this
    /// error.
    fn band_error_db(&self, texture: &str, model: &str) -> Option<f64>;

    /// Returns whether the program was asked to end, for example by a signal.
    fn is_interrupted(&self) -> bool;
}
