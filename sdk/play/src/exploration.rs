//! Playback at motions outside the recorded conditions. Voices and scenes share these rules.

use std::fmt;

use htex_format::{AtCondition, Condition};

use crate::Motion;

/// Lowest speed at which the finger slides, mm/s; below it the texture is silent.
pub const MIN_SLIDING_MM_S: f64 = 0.5;
/// Lowest ratio of a playing speed to the recorded speed.
pub const MIN_RATIO: f64 = 1.0 / 16.0;
/// Highest ratio of a playing speed to the recorded speed.
pub const MAX_RATIO: f64 = 8.0;
/// Length of an onset or offset of contact, seconds.
pub const CONTACT_RAMP_S: f64 = 0.020;
/// Largest gain of a force, so that all samples are finite.
const MOST_GAIN: f64 = 1e6;

/// Returns whether a finger slides at this speed (mm/s, either sign) and force (newtons).
pub fn slides(speed_mm_s: f64, force_n: f64) -> bool {
    speed_mm_s.abs() >= MIN_SLIDING_MM_S && force_n > 0.0
}

/// Effects of a motion on a voice in addition to interpolation between recorded conditions; a scene has an effect of
/// the same name for each.
///
/// ```
/// use htex::Effects;
/// let as_recorded_but_silent_at_rest = Effects::NONE.with_contact(true);
/// assert!(!as_recorded_but_silent_at_rest.speed_scaling);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Effects {
    /// Frequencies are proportional to the speed if one speed was recorded.
    pub speed_scaling: bool,
    /// The level is proportional to the normal force if one force was recorded.
    pub force_scaling: bool,
    /// The voice is silent while the finger does not slide.
    pub contact: bool,
}

impl Effects {
    /// Sets whether frequencies are proportional to the speed.
    #[must_use]
    pub const fn with_speed_scaling(self, speed_scaling: bool) -> Self {
        Self {
            speed_scaling,
            ..self
        }
    }

    /// Sets whether the level is proportional to the normal force.
    #[must_use]
    pub const fn with_force_scaling(self, force_scaling: bool) -> Self {
        Self {
            force_scaling,
            ..self
        }
    }

    /// Sets whether the voice is silent while the finger does not slide.
    #[must_use]
    pub const fn with_contact(self, contact: bool) -> Self {
        Self { contact, ..self }
    }

    /// The texture as recorded, at any motion; it is still interpolated between several conditions.
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
    /// The asset does not state it, or states 0.
    Unknown,
    /// One value, whose measurements lie within the tolerance of [`htex_format::SAME_CONDITION`].
    One {
        /// The lowest recorded value, in mm/s or newtons.
        low: f64,
        /// The highest recorded value, in mm/s or newtons.
        high: f64,
    },
    /// Several values, between which the texture is interpolated.
    Several {
        /// The lowest recorded value, in mm/s or newtons.
        low: f64,
        /// The highest recorded value, in mm/s or newtons.
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
        if high <= 0.0 {
            Self::Unknown
        } else if Condition::is_same(low, high) {
            Self::One { low, high }
        } else {
            Self::Several { low, high }
        }
    }

    /// Returns the ratio of a speed or force to the recorded one: 1 within its measurements, and 1 unless exactly one
    /// value was recorded.
    pub fn ratio(&self, x: f64) -> f64 {
        match *self {
            Self::One { low, .. } if x < low => x / low,
            Self::One { high, .. } if x > high => x / high,
            _ => 1.0,
        }
    }

    /// Returns whether exactly one value was recorded.
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

/// The speeds (mm/s) and forces (newtons) at which a representation was fitted.
///
/// ```
/// use htex::{Explored, Recorded};
/// let one = |x| Recorded::One { low: x, high: x };
/// let explored = Explored { speed: one(80.0), force: one(0.4) };
/// assert_eq!((explored.speed_ratio(40.0), explored.force_gain(0.8)), (0.5, 2.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Explored {
    /// Recorded speeds, mm/s.
    pub speed: Recorded,
    /// Recorded normal forces, newtons.
    pub force: Recorded,
}

impl Explored {
    /// Collects the conditions that a representation is fitted `at`.
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

    /// Returns the ratio of the playing speed to the recorded one: 1/16 to 8, and 1 unless exactly one speed was recorded.
    pub fn speed_ratio(&self, speed_mm_s: f64) -> f64 {
        self.speed.ratio(speed_mm_s).clamp(MIN_RATIO, MAX_RATIO)
    }

    /// Returns the gain of the level at a force; 1 unless exactly one force was recorded.
    pub fn force_gain(&self, force_n: f64) -> f64 {
        self.force.ratio(force_n).min(MOST_GAIN)
    }

    /// Returns the coverage of a motion whose interpolation uses the conditions at `nearest`.
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

/// The relation of a motion to the recorded conditions, and how a voice plays it.
///
/// ```
/// use htex::{Coverage, Reach};
/// let speed = Reach::Clamped { asked: 160.0, played: 80.0 };
/// let coverage = Coverage { slides: true, speed, force: Reach::Inside };
/// assert!(!coverage.is_inside() && coverage.excess() == 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coverage {
    /// Whether the voice is audible: the finger slides, or the effect `contact` is off.
    pub slides: bool,
    /// How the requested speed relates to the recorded ones, in mm/s.
    pub speed: Reach,
    /// How the requested normal force relates to the recorded ones, in newtons.
    pub force: Reach,
}

/// The relation of a speed or force to the recorded ones.
///
/// ```
/// use htex::Reach;
/// let reach = Reach::Scaled { asked: 160.0, recorded: 80.0, factor: 2.0 };
/// assert_ne!(reach, Reach::Inside);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reach {
    /// It was recorded, or lies between recorded conditions, within the tolerance of
    /// [`htex_format::SAME_CONDITION`].
    Inside,
    /// The asset does not state the recorded value; the speed or force has no effect.
    Unknown,
    /// One value was recorded, and the texture is scaled from it.
    Scaled {
        /// The value of the requested motion, in mm/s or newtons.
        asked: f64,
        /// The value of the recording, or the nearest of its interval.
        recorded: f64,
        /// Factor of all frequencies for a speed, of the level for a force.
        factor: f64,
    },
    /// The model follows the motion itself ([`crate::Voice::follows_motion`]).
    Followed,
    /// The texture is played at the nearest recorded value.
    Clamped {
        /// The value of the requested motion, in mm/s or newtons.
        asked: f64,
        /// The value that is played.
        played: f64,
    },
}

impl Coverage {
    /// Returns the relative distance of the motion from the one that is played; 0 if the texture is played as
    /// recorded, interpolated, or scaled to the motion.
    pub fn excess(&self) -> f64 {
        let excess = self.speed.excess().max(self.force.excess());
        // Smaller values are rounding errors.
        if excess > 1e-9 { excess } else { 0.0 }
    }

    /// Returns whether the texture is played as recorded, or interpolated between recordings; unknown values are
    /// ignored.
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

/// Rounds to four digits, the precision of measured speeds and forces.
fn four_digits(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}

impl fmt::Display for Coverage {
    /// Describes in one sentence what differs from the recording; empty if nothing does.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.slides {
            return f.write_str("the finger does not slide, so the texture is silent");
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
                    "{joint}{} {unit} is outside the recorded range, and is played as {} {unit}",
                    four_digits(asked),
                    four_digits(played)
                )?,
            }
            joint = "; ";
        }
        Ok(())
    }
}
