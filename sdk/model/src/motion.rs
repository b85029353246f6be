//! The motion of a finger, as models with the extension `htex.motion/1` are told it.

use crate::motion_1::{MAX_FORCE_N, MAX_POSITION_MM, MAX_SPEED_MM_S};
use crate::{Error, Voice, text};

/// The motion of a finger at one sample. From there on it goes on at this speed, until another motion is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Speed along the finger's path, mm/s; negative while the position falls, which is the way back.
    pub speed_mm_s: f64,
    /// Normal force, newtons, not negative.
    pub force_n: f64,
    /// Position along the finger's path, mm, of either sign.
    pub position_mm: f64,
}

impl Motion {
    /// Checks the ranges of the extension.
    ///
    /// # Errors
    /// [`InvalidArgument`](crate::Status::InvalidArgument) for a number that is not finite or beyond its range.
    ///
    /// ```
    /// let motion = htex_model::Motion { speed_mm_s: -80.0, force_n: 0.4, position_mm: 12.5 };
    /// assert!(motion.check().is_ok());
    /// assert!(htex_model::Motion { force_n: -0.1, ..motion }.check().is_err());
    /// ```
    pub fn check(self) -> Result<(), Error> {
        within(
            "speed_mm_s",
            self.speed_mm_s,
            (-MAX_SPEED_MM_S, MAX_SPEED_MM_S),
        )?;
        within("force_n", self.force_n, (0.0, MAX_FORCE_N))?;
        within(
            "position_mm",
            self.position_mm,
            (-MAX_POSITION_MM, MAX_POSITION_MM),
        )
    }
}

impl Motion {
    /// The nearest motion in the ranges of the extension; NaN stays.
    #[must_use]
    pub fn clamped(self) -> Self {
        Self {
            speed_mm_s: self.speed_mm_s.clamp(-MAX_SPEED_MM_S, MAX_SPEED_MM_S),
            force_n: self.force_n.clamp(0.0, MAX_FORCE_N),
            position_mm: self.position_mm.clamp(-MAX_POSITION_MM, MAX_POSITION_MM),
        }
    }
}

/// The motion at which a recording was made, as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FitCondition {
    /// Scanning speed, mm/s, not negative.
    pub speed_mm_s: Option<f64>,
    /// Normal force, newtons, not negative.
    pub force_n: Option<f64>,
}

impl FitCondition {
    /// Of numbers that crossed the ABI: NaN is not known.
    ///
    /// # Errors
    /// [`InvalidArgument`](crate::Status::InvalidArgument) for a number that is infinite or beyond its range.
    pub fn from_numbers(speed_mm_s: f64, force_n: f64) -> Result<Self, Error> {
        let known = |name, x: f64, most| match x.is_nan() {
            true => Ok(None),
            false => within(name, x, (0.0, most)).map(|()| Some(x)),
        };
        Ok(Self {
            speed_mm_s: known("speed_mm_s", speed_mm_s, MAX_SPEED_MM_S)?,
            force_n: known("force_n", force_n, MAX_FORCE_N)?,
        })
    }

    /// Speed and force as numbers that cross the ABI: NaN where one is not known.
    pub fn numbers(self) -> (f64, f64) {
        let number = |known: Option<f64>| known.unwrap_or(f64::NAN);
        (number(self.speed_mm_s), number(self.force_n))
    }
}

/// A voice that follows the finger itself, by the extension `htex.motion/1`. A model has the extension when
/// [`export_model!`](crate::export_model) is told `extensions: [motion]`, which requires this trait of its voice.
///
/// A host then scales neither frequencies with the speed nor the level with the force. A voice that was never told
/// a motion plays as its parameters say, at the motion of their recording.
pub trait MotionVoice: Voice {
    /// Takes the motion at the next sample, which is checked. The samples depend on the motions and on the samples
    /// before which they come, not on the blocks. A voice glides to a new motion without a click; what it does at
    /// a speed of 0 is the model's own. Before the same sample as a [`retune`](Voice::retune), the order of the
    /// two does not matter.
    /// `[render thread, no allocation, no lock, no I/O]`
    fn set_motion(&mut self, motion: Motion);
}

fn within(name: &str, x: f64, (low, high): (f64, f64)) -> Result<(), Error> {
    if (low..=high).contains(&x) {
        return Ok(());
    }
    Err(Error::argument(text![
        "`",
        name,
        "` is ",
        x,
        "; ",
        low,
        " to ",
        high,
        " is allowed",
    ]))
}
