//! The motion of a finger, for models with the extension `htex.motion/1`.

use crate::motion_1::{MAX_FORCE_N, MAX_POSITION_MM, MAX_SPEED_MM_S};
use crate::{Error, Voice, text};

/// The motion of a finger at one sample. The speed is constant from there until the next motion is
/// set.
///
/// ```
/// let back = htex_model::Motion { speed_mm_s: -80.0, force_n: 0.4, position_mm: 12.5, x_mm: 10.0, y_mm: 7.5 };
/// assert!(back.check().is_ok());
/// let too_strong = htex_model::Motion { force_n: f64::MAX, ..back };
/// assert!(too_strong.check().is_err() && too_strong.clamped().check().is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Speed along the finger's path, mm/s; negative while the position decreases.
    pub speed_mm_s: f64,
    /// Normal force, newtons, not negative.
    pub force_n: f64,
    /// Position along the finger's path, mm, of either sign.
    pub position_mm: f64,
    /// Place on the surface, mm, of either sign; where it is not known, the position along the
    /// path.
    pub x_mm: f64,
    /// Place on the surface across `x_mm`, mm, of either sign; where it is not known, 0.
    pub y_mm: f64,
}

impl Motion {
    /// Checks the ranges of the extension.
    ///
    /// # Errors
    /// [`InvalidArgument`](crate::Status::InvalidArgument) for a number that is not finite or
    /// beyond its range.
    ///
    /// ```
    /// let motion = htex_model::Motion { speed_mm_s: -80.0, force_n: 0.4, position_mm: 12.5, x_mm: 10.0, y_mm: 7.5 };
    /// assert!(motion.check().is_ok());
    /// assert!(htex_model::Motion { force_n: -0.1, ..motion }.check().is_err());
    /// ```
    pub fn check(self) -> Result<(), Error> {
        within("speed_mm_s", self.speed_mm_s, (-MAX_SPEED_MM_S, MAX_SPEED_MM_S))?;
        within("force_n", self.force_n, (0.0, MAX_FORCE_N))?;
        let far = (-MAX_POSITION_MM, MAX_POSITION_MM);
        within("position_mm", self.position_mm, far)?;
        within("x_mm", self.x_mm, far)?;
        within("y_mm", self.y_mm, far)
    }
}

impl Motion {
    /// Clamps the numbers to the ranges of the extension; NaN is kept.
    #[must_use]
    pub fn clamped(self) -> Self {
        let near = |mm: f64| mm.clamp(-MAX_POSITION_MM, MAX_POSITION_MM);
        Self {
            speed_mm_s: self.speed_mm_s.clamp(-MAX_SPEED_MM_S, MAX_SPEED_MM_S),
            force_n: self.force_n.clamp(0.0, MAX_FORCE_N),
            position_mm: near(self.position_mm),
            x_mm: near(self.x_mm),
            y_mm: near(self.y_mm),
        }
    }
}

/// The motion at which a recording was made, as far as known.
///
/// ```
/// let condition = htex_model::FitCondition::from_numbers(80.0, f64::NAN)?;
/// assert_eq!((condition.speed_mm_s, condition.force_n), (Some(80.0), None));
/// # Ok::<(), htex_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FitCondition {
    /// Scanning speed, mm/s, not negative.
    pub speed_mm_s: Option<f64>,
    /// Normal force, newtons, not negative.
    pub force_n: Option<f64>,
}

impl FitCondition {
    /// Converts numbers of the ABI: NaN means unknown.
    ///
    /// # Errors
    /// [`InvalidArgument`](crate::Status::InvalidArgument) for a number that is infinite or beyond
    /// its range.
    pub fn from_numbers(speed_mm_s: f64, force_n: f64) -> Result<Self, Error> {
        let known = |name, x: f64, most| {
            if x.is_nan() {
                return Ok(None);
            }
            within(name, x, (0.0, most)).map(|()| Some(x))
        };
        Ok(Self {
            speed_mm_s: known("speed_mm_s", speed_mm_s, MAX_SPEED_MM_S)?,
            force_n: known("force_n", force_n, MAX_FORCE_N)?,
        })
    }

    /// Returns speed and force as numbers of the ABI: NaN means unknown.
    pub fn numbers(self) -> (f64, f64) {
        let number = |known: Option<f64>| known.unwrap_or(f64::NAN);
        (number(self.speed_mm_s), number(self.force_n))
    }
}

/// A voice that follows the motion itself, by the extension `htex.motion/1`. A model has the
/// extension if [`export_model!`](crate::export_model) gets `extensions: [motion]`, which requires
/// this trait of its voice.
///
/// A host then scales neither frequencies with the speed nor the level with the force. Before its
/// first motion a voice plays its parameters as at the motion of their recording.
pub trait MotionVoice: Voice {
    /// Sets the motion at the next sample, which is in range. The samples depend on the motions and
    /// on the samples at which they are set, not on the blocks. A voice changes to a new motion
    /// without a click; the model determines the samples at a speed of 0. The order of this call
    /// and of [`retune`](Voice::retune) before the same sample does not matter.
    /// `[render thread, no allocation, no lock, no I/O]`
    fn set_motion(&mut self, motion: Motion);
}

fn within(name: &str, x: f64, (low, high): (f64, f64)) -> Result<(), Error> {
    if (low..=high).contains(&x) {
        return Ok(());
    }
    Err(Error::argument(text!["`", name, "` is ", x, "; ", low, " to ", high, " is allowed",]))
}
