//! The motion of a finger, as models with the extension `htex.motion/1` receive it.

use crate::motion_1::{MAX_FORCE_N, MAX_POSITION_MM, MAX_SPEED_MM_S};
use crate::{Error, Voice, text};

/// The motion of a finger at one sample. From this sample on, the finger keeps its speed until the
/// host sets another motion.
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
    /// Position along the finger's path, mm; may be negative.
    pub position_mm: f64,
    /// First coordinate of the finger on the surface, mm; may be negative. If the coordinates are
    /// unknown, this is the position along the path.
    pub x_mm: f64,
    /// Second coordinate of the finger on the surface, mm; may be negative. If the coordinates are
    /// unknown, this is 0.
    pub y_mm: f64,
}

impl Motion {
    /// Checks that every number is finite and within the limits of the extension.
    ///
    /// # Errors
    /// Returns [`InvalidArgument`](crate::Status::InvalidArgument) if a number is not finite or out
    /// of range.
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
    /// Clamps every number to the limits of the extension. NaN stays NaN.
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

/// Speed and normal force of a recording. Each is `None` if it is unknown.
///
/// ```
/// let condition = htex_model::FitCondition::from_numbers(80.0, f64::NAN)?;
/// assert_eq!((condition.speed_mm_s, condition.force_n), (Some(80.0), None));
/// # Ok::<(), htex_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FitCondition {
    /// Speed of the finger along the surface, mm/s, not negative.
    pub speed_mm_s: Option<f64>,
    /// Normal force, newtons, not negative.
    pub force_n: Option<f64>,
}

impl FitCondition {
    /// Makes a condition from the ABI's two numbers for speed and force. NaN means unknown.
    ///
    /// # Errors
    /// Returns [`InvalidArgument`](crate::Status::InvalidArgument) if a number is infinite or out
    /// of range.
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

    /// Returns speed and force as two numbers for the ABI. NaN means unknown.
    pub fn numbers(self) -> (f64, f64) {
        let number = |known: Option<f64>| known.unwrap_or(f64::NAN);
        (number(self.speed_mm_s), number(self.force_n))
    }
}

/// A voice that receives the motion of the finger through the extension `htex.motion/1`.
///
/// Implement this trait if the sound depends on more than speed and force, e.g. on the finger's
/// position or direction, or if the model imitates stick-slip. To declare the extension, pass
/// `extensions: [motion]` to [`export_model!`](crate::export_model); the macro then requires that
/// [`Model::Voice`](crate::Model::Voice) implements this trait.
///
/// # How a host uses it
///
/// For a voice without this trait, the host scales all frequencies with the speed and the level
/// with the force. For a voice with this trait, the host does not scale anything. It only
/// interpolates parameters between conditions and calls [`set_motion`](Self::set_motion). It calls
/// this function once before the first sample, and again before each block for which the motion has
/// changed. A host that does not support the extension never calls `set_motion`. Until the first
/// call of `set_motion`, a voice therefore plays as if the finger moved as in the recording.
///
/// # Example
///
/// Noise that becomes louder with the force, and is silent while the finger rests:
///
/// ```
/// use htex_dsp::glide::Glide;
/// use htex_dsp::shaped_noise::ShapedNoise;
/// use htex_model::{Band, Error, Motion, MotionVoice, Values, Voice};
///
/// struct Pressed {
///     noise: ShapedNoise,
///     /// A gain that changes over 10 ms.
///     gain: Glide,
/// }
///
/// impl Voice for Pressed {
///     fn render(&mut self, out: &mut [f32]) {
///         self.noise.render(out);
///         self.gain.apply(out);
///     }
///
///     fn retune(&mut self, _: &Values<'_>) -> Result<(), Error> {
///         Ok(()) // This spectrum has no parameters.
///     }
/// }
///
/// impl MotionVoice for Pressed {
///     fn set_motion(&mut self, motion: Motion) {
///         // As loud as the recording, if that was made at 1 N.
///         let gain = if motion.speed_mm_s == 0.0 { 0.0 } else { motion.force_n.min(4.0) };
///         self.gain.set(gain as f32);
///     }
/// }
///
/// let mut noise = ShapedNoise::new(4_000.0, Band::TACTILE, 1);
/// noise.start(|_, _| 1.0);
/// let mut voice = Pressed { noise, gain: Glide::new(1.0, 40) };
/// let mut motion =
///     Motion { speed_mm_s: 80.0, force_n: 2.0, position_mm: 0.0, x_mm: 0.0, y_mm: 0.0 };
/// let mut block = [0.0; 64];
/// voice.set_motion(motion);
/// voice.render(&mut block);
/// assert!(voice.gain.rests_at(2.0));
/// motion.speed_mm_s = 0.0;
/// voice.set_motion(motion);
/// voice.render(&mut block);
/// assert_eq!(block[63], 0.0);
/// ```
///
/// `examples/model-rust-texel` is a complete model with this trait. Its sound follows the finger's
/// position.
///
/// # Limits
///
/// Samples are finite at every motion within the limits of [`motion_1`](crate::motion_1). With the
/// speed and force of the recording, the samples have unit RMS. At other motions, the model decides
/// the level.
pub trait MotionVoice: Voice {
    /// Sets the motion at the next sample. All numbers are in range: the caller has checked them.
    ///
    /// The voice changes to the new motion within about 10 ms and without a click. At a speed of 0
    /// the model decides what to play. If the new position is far from the current position, the
    /// finger has jumped, and the voice should not play the surface between the two positions. The
    /// samples depend only on the motions and on the times at which the host sets them, not on the
    /// block sizes. If a host calls this function and [`retune`](Voice::retune) before the same
    /// sample, the order of the two calls makes no difference. `[render thread, no allocation, no
    /// lock, no I/O]`
    fn set_motion(&mut self, motion: Motion);
}

fn within(name: &str, x: f64, (low, high): (f64, f64)) -> Result<(), Error> {
    if (low..=high).contains(&x) {
        return Ok(());
    }
    Err(Error::argument(text!["`", name, "` is ", x, "; ", low, " to ", high, " is allowed",]))
}
