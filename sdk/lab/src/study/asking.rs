//! What a session needs of its surroundings: the one who is asked, a clock, and what plays.

use std::time::Duration;

use serde::Serialize;

use crate::study::error::StudyError;
use crate::study::file::{Attribute, GainMethod, Phase, Scale};
use crate::study::gain::GainKey;
use crate::study::lines::FeltFile;
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
    },
    /// A trial plays.
    Playing {
        texture: String,
    },
    Question {
        attribute: Attribute,
        scale: Scale,
    },
    /// The texture plays, and its gain is matched.
    Matching {
        texture: String,
        /// The method, which says which keys there are.
        method: GainMethod,
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

/// The one who is asked.
pub trait Asker {
    /// Shows what there is now. Keys that were pressed before are forgotten. `done` of `all` trials are rated.
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

    /// A simulated clock goes on at this time; others do not.
    fn go_on_at(&mut self, ms: u64);
}

/// How something was played.
#[derive(Debug, Clone, PartialEq)]
pub struct Played {
    /// Drive of a display, volts.
    pub drive_v: Option<f64>,
    /// RMS that had this drive, in the assets' unit.
    pub reference_rms: f64,
    /// The recording of what was felt, which is on disk.
    pub felt: Option<FeltFile>,
}

/// What plays: a renderer and a device.
pub trait Rig {
    type Error: From<StudyError>;

    /// Plays, and calls `ends` for each block; when that returns true, playing ends as soon as it can.
    ///
    /// # Errors
    /// Of the renderer and of the device.
    fn play(
        &mut self,
        stimulus: &Stimulus,
        ends: &mut dyn FnMut() -> bool,
    ) -> Result<Played, Self::Error>;

    /// The nine-band error of a representation, decibels, if its asset says it.
    fn band_error_db(&self, texture: &str, model: &str) -> Option<f64>;

    /// Whether the program was asked to end.
    fn is_interrupted(&self) -> bool;
}
