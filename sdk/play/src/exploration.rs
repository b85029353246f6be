//! What a motion does beyond the conditions that were recorded. Voices and scenes share these rules.

use std::fmt;

use htex_format::{AtCondition, Condition};

use crate::Motion;

/// Below this speed, mm/s, the finger does not slide, and there is no texture to feel.
pub const MIN_SLIDING_MM_S: f64 = 0.5;
/// Slowest and fastest reading of a texture, in its recorded speed.
pub const MIN_RATIO: f64 = 1.0 / 16.0;
/// See [`MIN_RATIO`].
pub const MAX_RATIO: f64 = 8.0;
/// Length of an onset or offset of contact, seconds.
pub const CONTACT_RAMP_S: f64 = 0.020;
/// Largest gain of a force: no finger presses harder, and a gain that is not finite would be in every sample.
const MOST_GAIN: f64 = 1e6;

/// Whether a finger slides at this speed (mm/s, either sign) and force (newtons).
pub fn slides(speed_mm_s: f64, force_n: f64) -> bool {
    speed_mm_s.abs() >= MIN_SLIDING_MM_S && force_n > 0.0
}

/// What a voice does with a motion beside interpolating between recorded conditions; a scene has an effect of the
/// same name for each.
///
/// ```
/// use htex::Effects;
/// let as_recorded_but_silent_at_rest = Effects { contact: true, ..Effects::NONE };
/// assert!(!as_recorded_but_silent_at_rest.speed_scaling);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effects {
    /// Frequencies in proportion to the speed, where one speed was recorded.
    pub speed_scaling: bool,
    /// Level in proportion to the normal force, where one force was recorded.
    pub force_scaling: bool,
    /// Silence where the finger does not slide.
    pub contact: bool,
}

impl Effects {
    /// The texture as it was recorded, whatever the motion; between several conditions it is still interpolated.
    pub const NONE: Self = Self {
        speed_scaling: false,
        force_scaling: false,
        contact: false,
    };
}

impl Default for Effects {
    /// All of them.
    fn default() -> Self {
        Self {
            speed_scaling: true,
            force_scaling: true,
            contact: true,
        }
    }
}

/// The speeds, or the forces, at which a representation was fitted.
///
/// ```
/// use htex::Recorded;
/// let speed = Recorded::One { low: 80.0, high: 80.0 };
/// assert_eq!(speed.ratio(160.0), 2.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Recorded {
    /// The asset does not say, or says 0.
    Unknown,
    /// One value, whose measurements lie within the tolerance of [`htex_format::SAME_CONDITION`].
    One {
        /// The lowest.
        low: f64,
        /// The highest.
        high: f64,
    },
    /// Several, between which is interpolated.
    Several {
        /// The lowest.
        low: f64,
        /// The highest.
        high: f64,
    },
}

impl Recorded {
    fn new(values: impl Iterator<Item = Option<f64>>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, 0.0f64);
        for value in values {
            let Some(x) = value else {
                return Self::Unknown;
            };
            (low, high) = (low.min(x), high.max(x));
        }
        match high > 0.0 {
            true if Condition::is_same(low, high) => Self::One { low, high },
            true => Self::Several { low, high },
            false => Self::Unknown,
        }
    }

    /// A speed or force in the one that was recorded: 1 within its measurements, and where not just one is known.
    pub fn ratio(&self, x: f64) -> f64 {
        match *self {
            Self::One { low, .. } if x < low => x / low,
            Self::One { high, .. } if x > high => x / high,
            _ => 1.0,
        }
    }

    /// Whether just one value was recorded.
    pub fn is_one(&self) -> bool {
        matches!(self, Self::One { .. })
    }
}

impl fmt::Display for Recorded {
    /// Such as `80` or `40 to 160`, without a unit.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Unknown => f.write_str("unknown"),
            Self::One { low, high } | Self::Several { low, high } if low == high => {
                write!(f, "{low}")
            }
            Self::One { low, high } | Self::Several { low, high } => write!(f, "{low} to {high}"),
        }
    }
}

/// At which speeds (mm/s) and forces (newtons) a representation was fitted.
///
/// ```
/// use htex::{Explored, Recorded};
/// let one = |x| Recorded::One { low: x, high: x };
/// let explored = Explored { speed: one(80.0), force: one(0.4) };
/// assert_eq!((explored.speed_ratio(40.0), explored.force_gain(0.8)), (0.5, 2.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Explored {
    /// Speeds, mm/s.
    pub speed: Recorded,
    /// Normal forces, newtons.
    pub force: Recorded,
}

impl Explored {
    /// Of the conditions that a representation is fitted `at`.
    pub fn new(at: &[AtCondition], conditions: &[Condition]) -> Self {
        let of = |value: fn(&Condition) -> Option<f64>| {
            let known = at.iter().filter_map(|at| conditions.get(at.condition));
            Recorded::new(known.map(value))
        };
        Self {
            speed: of(|c| c.speed_mm_s),
            force: of(|c| c.force_n),
        }
    }

    /// How many times as fast the texture is read at a speed: 1/16 to 8, and 1 where not just one speed is known.
    pub fn speed_ratio(&self, speed_mm_s: f64) -> f64 {
        self.speed.ratio(speed_mm_s).clamp(MIN_RATIO, MAX_RATIO)
    }

    /// Gain on the level at a force; 1 where not just one force is known.
    pub fn force_gain(&self, force_n: f64) -> f64 {
        self.force.ratio(force_n).min(MOST_GAIN)
    }

    /// What becomes of a motion that is interpolated as if it were `nearest`.
    pub(crate) fn coverage(&self, motion: Motion, nearest: [f64; 2], effects: Effects) -> Coverage {
        let (speed, force) = (motion.speed_mm_s, motion.force_n);
        let slides = slides(speed, force);
        let factor = |on: bool, factor: f64| on.then_some(factor);
        Coverage {
            slides: slides || !effects.contact,
            speed: reach(
                self.speed,
                speed,
                nearest[0],
                factor(effects.speed_scaling, self.speed_ratio(speed)),
            ),
            force: reach(
                self.force,
                force,
                nearest[1],
                factor(effects.force_scaling, self.force_gain(force)),
            ),
        }
    }
}

fn reach(recorded: Recorded, asked: f64, nearest: f64, factor: Option<f64>) -> Reach {
    let played = match recorded {
        Recorded::Unknown => return Reach::Unknown,
        Recorded::Several { .. } => nearest,
        Recorded::One { low, high } => asked.clamp(low, high),
    };
    match (recorded, factor) {
        (Recorded::Several { .. }, _) if Condition::is_same(asked, played) => Reach::Inside,
        _ if asked == played => Reach::Inside,
        (Recorded::One { .. }, Some(factor)) => Reach::Scaled {
            asked,
            recorded: played,
            factor,
        },
        _ => Reach::Clamped { asked, played },
    }
}

/// How a motion relates to what was recorded, and what a voice makes of it.
///
/// ```
/// use htex::{Coverage, Reach};
/// let speed = Reach::Clamped { asked: 160.0, played: 80.0 };
/// let coverage = Coverage { slides: true, speed, force: Reach::Inside };
/// assert!(!coverage.is_inside() && coverage.excess() == 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coverage {
    /// Whether there is anything to feel: the finger slides, or the voice plays without contact.
    pub slides: bool,
    /// Speed, mm/s.
    pub speed: Reach,
    /// Normal force, newtons.
    pub force: Reach,
}

/// How a speed or a force relates to those that were recorded.
///
/// ```
/// use htex::Reach;
/// let reach = Reach::Scaled { asked: 160.0, recorded: 80.0, factor: 2.0 };
/// assert_ne!(reach, Reach::Inside);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reach {
    /// It was recorded, or lies between conditions that were; within the tolerance of
    /// [`htex_format::SAME_CONDITION`].
    Inside,
    /// The asset does not say what was recorded: it changes nothing.
    Unknown,
    /// One value was recorded, and the texture is scaled from it.
    Scaled {
        /// What was asked for.
        asked: f64,
        /// What was recorded.
        recorded: f64,
        /// Factor on all frequencies for a speed, on the level for a force.
        factor: f64,
    },
    /// The model follows it itself ([`crate::Voice::follows_motion`]).
    Followed,
    /// The texture is played as at another value, the nearest that is known.
    Clamped {
        /// What was asked for.
        asked: f64,
        /// What is played.
        played: f64,
    },
}

impl Coverage {
    /// How far a motion lies beyond the one that is played, relative to it; 0 where the texture is played as
    /// recorded, interpolated, or scaled to the motion.
    pub fn excess(&self) -> f64 {
        let excess = self.speed.excess().max(self.force.excess());
        // What is left is rounding.
        if excess > 1e-9 { excess } else { 0.0 }
    }

    /// Whether the texture is played as it was recorded, or interpolated between recordings; what is not known does
    /// not count.
    pub fn is_inside(&self) -> bool {
        let inside = |reach| matches!(reach, Reach::Inside | Reach::Unknown);
        self.slides && inside(self.speed) && inside(self.force)
    }
}

impl Reach {
    fn excess(&self) -> f64 {
        match *self {
            Self::Inside | Self::Unknown | Self::Followed => 0.0,
            Self::Scaled {
                asked,
                recorded,
                factor,
            } => (asked / recorded / factor - 1.0).abs(),
            Self::Clamped { asked, played } => (asked / played - 1.0).abs(),
        }
    }
}

/// Measured speeds and forces mean nothing beyond four digits.
fn four_digits(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}

impl fmt::Display for Coverage {
    /// What is not as recorded, as a sentence; empty when all of it is.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.slides {
            return f.write_str("the finger does not slide, and there is nothing to feel");
        }
        let mut joint = "";
        for (reach, unit, scaled) in [
            (self.speed, "mm/s", "frequencies are"),
            (self.force, "N", "the level is"),
        ] {
            match reach {
                Reach::Inside | Reach::Unknown | Reach::Followed => continue,
                Reach::Scaled {
                    asked,
                    recorded,
                    factor,
                } => write!(
                    f,
                    "{joint}{} {unit}, where {} {unit} was recorded: {scaled} {factor:.3} times as high",
                    four_digits(asked),
                    four_digits(recorded)
                )?,
                Reach::Clamped { asked, played } => write!(
                    f,
                    "{joint}{} {unit} is beyond what was recorded, and is played as {} {unit}",
                    four_digits(asked),
                    four_digits(played)
                )?,
            }
            joint = "; ";
        }
        Ok(())
    }
}
