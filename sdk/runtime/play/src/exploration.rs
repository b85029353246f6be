//! Rules for playback at motions outside the recorded conditions. Voices and scenes share these
//! rules.

use std::fmt;

use htex_format::{AtCondition, Condition, Law};

use crate::Motion;

/// If the ratio of a motion to the nearest recorded value differs from 1 by at most this number,
/// the ratio counts as 1.
const SAME_RATIO: f64 = 1e-9;

/// Lowest speed at which the finger slides, mm/s. Below this speed, the texture is silent.
pub const MIN_SLIDING_MM_S: f64 = 0.5;
/// Lowest ratio of the playback speed to the recorded speed.
pub const MIN_RATIO: f64 = 1.0 / 16.0;
/// Highest ratio of the playback speed to the recorded speed.
pub const MAX_RATIO: f64 = 8.0;
/// Duration of the fade when the finger starts or stops sliding, seconds.
pub const CONTACT_RAMP_S: f64 = 0.020;
/// Highest speed that is accepted as a valid reading of a finger, mm/s.
pub const MOST_SPEED_MM_S: f64 = 1_000.0;
/// Highest normal force that is accepted as a valid reading of a finger, newtons.
pub const MOST_FORCE_N: f64 = 20.0;
/// Maximum time, in seconds, for which a voice holds the last valid motion while readings are out
/// of range.
pub const HOLD_S: f64 = 0.1;
/// Speed (mm/s) and normal force (newtons) that are assumed where a texture does not state them.
/// Balasubramanian & Vardar (2026) used the same speed and force in their study.
pub const USUAL: (f64, f64) = (80.0, 0.4);
/// Default ceiling of a voice's level, as a multiple of the strongest recorded level.
pub const CEILING: f64 = 4.0;

/// Returns whether a finger slides at this speed (mm/s, either sign) and force (newtons).
pub fn slides(speed_mm_s: f64, force_n: f64) -> bool {
    speed_mm_s.abs() >= MIN_SLIDING_MM_S && force_n > 0.0
}

/// Effects of a motion on a voice, in addition to interpolation between recorded conditions. The
/// effects of a scene have the same names.
///
/// ```
/// use htex::play::Effects;
/// let as_recorded_but_silent_at_rest = Effects::NONE.with_contact(true);
/// assert!(!as_recorded_but_silent_at_rest.frequency_scaling);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Effects {
    /// Outside the recorded speeds, frequencies follow the asset's scaling law ([`Law`]).
    pub frequency_scaling: bool,
    /// Outside the recorded speeds and forces, the level follows the asset's scaling law ([`Law`]).
    pub level_scaling: bool,
    /// The voice is silent while the finger does not slide.
    pub contact: bool,
}

impl Effects {
    /// Sets whether frequencies follow the asset's law outside the recorded speeds.
    #[must_use]
    pub const fn with_frequency_scaling(self, frequency_scaling: bool) -> Self {
        Self { frequency_scaling, ..self }
    }

    /// Sets whether the level follows the asset's law outside the recorded speeds and forces.
    #[must_use]
    pub const fn with_level_scaling(self, level_scaling: bool) -> Self {
        Self { level_scaling, ..self }
    }

    /// Sets whether the voice is silent while the finger does not slide.
    #[must_use]
    pub const fn with_contact(self, contact: bool) -> Self {
        Self { contact, ..self }
    }

    /// No effects. The motion still determines which recorded condition the voice plays, or between
    /// which recorded conditions it interpolates.
    pub const NONE: Self = Self { frequency_scaling: false, level_scaling: false, contact: false };
}

impl Default for Effects {
    /// All effects.
    fn default() -> Self {
        Self { frequency_scaling: true, level_scaling: true, contact: true }
    }
}

/// The range of speeds, or of forces, at which a representation was fitted.
///
/// ```
/// use htex::play::Interval;
/// let speed = Interval::Between { low: 40.0, high: 160.0 };
/// assert_eq!(speed.to_string(), "40 to 160");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Interval {
    /// The asset does not state this speed or force for every condition, or all stated values are
    /// 0. In both cases, the speed or force of the finger has no effect.
    Unknown,
    /// The conditions have one value, or several values between which the texture is interpolated.
    Between {
        /// The lowest recorded value, in mm/s or newtons.
        low: f64,
        /// The highest recorded value, in mm/s or newtons.
        high: f64,
    },
}

impl Interval {
    fn new(values: impl Iterator<Item = Option<f64>>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, 0.0f64);
        for value in values {
            // A range of only some of the conditions would be wrong for the others.
            let Some(x) = value else {
                return Self::Unknown;
            };
            (low, high) = (low.min(x), high.max(x));
        }
        if high > 0.0 { Self::Between { low, high } } else { Self::Unknown }
    }

    /// Returns whether all recorded values are equal within [`htex_format::SAME_CONDITION`].
    pub fn is_one(&self) -> bool {
        matches!(*self, Self::Between { low, high } if Condition::is_same(low, high))
    }

    /// Returns whether the range is known.
    pub fn is_known(&self) -> bool {
        *self != Self::Unknown
    }

    /// Returns the ratio of a speed or force to the nearest recorded value. Returns 1 if the
    /// recorded values are unknown, or if the nearest value is 0.
    fn ratio(&self, asked: f64, nearest: f64) -> f64 {
        let ratio = if self.is_known() && nearest > 0.0 { asked / nearest } else { 1.0 };
        // A computed nearest value can have a rounding error. Scaling by this error would move a
        // spectrum beyond the edge of its band.
        if (ratio - 1.0).abs() <= SAME_RATIO { 1.0 } else { ratio }
    }
}

impl fmt::Display for Interval {
    /// Writes text such as `80` or `40 to 160`, without a unit.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Unknown => f.write_str("unknown"),
            Self::Between { low, high } if low == high => write!(f, "{low}"),
            Self::Between { low, high } => write!(f, "{low} to {high}"),
        }
    }
}

/// The range of speeds (mm/s) and forces (newtons) at which a representation was fitted, and the
/// scaling law that applies outside it.
///
/// ```no_run
/// let texture = htex::Texture::open("sandpaper.htex")?;
/// let conditions = texture.representation(None)?.conditions()?;
/// println!("recorded at {} mm/s", conditions.range().speed);
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordedRange {
    /// Recorded speeds, mm/s.
    pub speed: Interval,
    /// Recorded normal forces, newtons.
    pub force: Interval,
    /// The scaling law: how frequencies and level depend on the motion outside these ranges.
    pub law: Law,
}

impl RecordedRange {
    /// Collects the conditions at which a representation was fitted.
    pub fn new(at: &[AtCondition], conditions: &[Condition], law: Law) -> Self {
        let of = |value: fn(&Condition) -> Option<f64>| {
            let known = at.iter().filter_map(|at| conditions.get(at.condition));
            Interval::new(known.map(value))
        };
        Self { speed: of(|c| c.speed_mm_s), force: of(|c| c.force_n), law }
    }

    /// Returns whether frequencies depend on the speed outside the recorded range.
    pub fn moves_frequencies(&self) -> bool {
        self.speed.is_known() && self.law.frequency_speed.exponent != 0.0
    }

    /// Returns whether the level depends on the motion outside the recorded range.
    pub fn moves_level(&self) -> bool {
        let by_speed = self.speed.is_known() && self.law.level_speed.exponent != 0.0;
        by_speed || self.force.is_known() && self.law.level_force.exponent != 0.0
    }

    /// Returns the scaling factors for a motion. `nearest` is the nearest recorded motion: speed,
    /// mm/s, and force, newtons.
    pub(crate) fn scaling(&self, motion: Motion, nearest: [f64; 2]) -> Scaling {
        // The level also follows the limited speed, because the texture is played as if at that
        // speed.
        let speed = self.speed.ratio(motion.speed_mm_s, nearest[0]).clamp(MIN_RATIO, MAX_RATIO);
        let force = self.force.ratio(motion.force_n, nearest[1]);
        Scaling {
            frequency: self.law.frequency_factor(speed).clamp(MIN_RATIO, MAX_RATIO),
            level: self.law.level_factor(speed, force),
        }
    }

    /// Returns the coverage of a motion that is scaled with these factors. `nearest` is the nearest
    /// recorded motion.
    pub(crate) fn coverage(
        &self,
        motion: Motion,
        nearest: [f64; 2],
        scaling: Scaling,
        effects: Effects,
    ) -> Coverage {
        let slides = slides(motion.speed_mm_s, motion.force_n);
        Coverage {
            slides: slides || !effects.contact,
            speed: reach(self.speed, motion.speed_mm_s, nearest[0]),
            force: reach(self.force, motion.force_n, nearest[1]),
            scaling: scaling.with(effects),
            scales_level: effects.level_scaling,
            scales_speed: effects.level_scaling || effects.frequency_scaling,
        }
    }
}

/// The factors that scale a texture's frequencies and level at a motion outside the recorded range.
/// Inside the range, both factors are 1.
///
/// ```no_run
/// use htex::{Motion, Texture};
/// let texture = Texture::open("sandpaper.htex")?;
/// let conditions = texture.representation(None)?.conditions()?;
/// let scaling = conditions.scaling(Motion::new(160.0, 0.4), 4.0);
/// println!("frequencies are {} times as high", scaling.frequency);
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scaling {
    /// Factor of all frequencies, 1/16 to 8.
    pub frequency: f64,
    /// Factor of the level.
    pub level: f64,
}

impl Scaling {
    /// No scaling: the texture as recorded.
    pub const NONE: Self = Self { frequency: 1.0, level: 1.0 };

    /// Returns the factors, with 1 in place of the factor of each effect that is switched off.
    pub(crate) fn with(self, effects: Effects) -> Self {
        let on = |is_on: bool, factor: f64| if is_on { factor } else { 1.0 };
        Self {
            frequency: on(effects.frequency_scaling, self.frequency),
            level: on(effects.level_scaling, self.level),
        }
    }
}

fn reach(recorded: Interval, asked: f64, nearest: f64) -> Reach {
    match recorded.is_known() {
        false => Reach::Unknown,
        true if Condition::is_same(asked, nearest) => Reach::Inside,
        true => Reach::Outside { asked, recorded: nearest },
    }
}

/// How a requested motion relates to the recorded conditions, and how a voice plays it.
///
/// ```no_run
/// use htex::{Motion, Texture, VoiceOptions};
/// let voice = Texture::open("sandpaper.htex")?.voice(&VoiceOptions::default())?;
/// let coverage = voice.coverage(Motion::new(160.0, 0.4));
/// if !coverage.is_inside() {
///     println!("{coverage}");
/// }
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coverage {
    /// Whether the voice is audible: the finger slides, or the effect `contact` is off.
    pub slides: bool,
    /// How the requested speed relates to the recorded speeds, in mm/s.
    pub speed: Reach,
    /// How the requested normal force relates to the recorded forces, in newtons.
    pub force: Reach,
    /// The factors that scale the texture.
    pub scaling: Scaling,
    scales_speed: bool,
    scales_level: bool,
}

/// How a speed or force relates to the recorded values.
///
/// ```
/// use htex::play::Reach;
/// let reach = Reach::Outside { asked: 160.0, recorded: 80.0 };
/// assert_ne!(reach, Reach::Inside);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reach {
    /// The value was recorded, or lies between recorded values, within the tolerance
    /// [`htex_format::SAME_CONDITION`].
    Inside,
    /// The asset does not state the recorded value, so the speed or force has no effect.
    Unknown,
    /// The model receives the motion and determines frequencies and level itself
    /// ([`crate::Voice::follows_motion`]).
    Followed,
    /// The voice plays the texture at the nearest recorded value, and then scales the texture by
    /// the asset's law.
    Outside {
        /// The requested value, in mm/s or newtons.
        asked: f64,
        /// The nearest recorded value.
        recorded: f64,
    },
}

impl Coverage {
    /// Returns the relative difference between the requested motion and the motion that is actually
    /// played. The difference is 0 if the texture is played as recorded, interpolated, or scaled to
    /// the requested motion.
    pub fn excess(&self) -> f64 {
        let speed = match (self.scales_speed, self.speed) {
            (false, speed) => speed.excess(1.0),
            // Beyond the limits of the frequency scaling, the texture plays as at the nearest
            // limit.
            (true, Reach::Outside { asked, recorded }) => {
                let ratio = asked / recorded;
                self.speed.excess(ratio.clamp(MIN_RATIO, MAX_RATIO))
            }
            (true, _) => 0.0,
        };
        let force = if self.scales_level { 0.0 } else { self.force.excess(1.0) };
        let excess = speed.max(force);
        // Smaller values come from rounding.
        if excess > 1e-9 { excess } else { 0.0 }
    }

    /// Returns whether the texture is played as recorded, or interpolated between recordings. The
    /// method ignores a speed or force that the asset does not state.
    pub fn is_inside(&self) -> bool {
        let inside = |reach| matches!(reach, Reach::Inside | Reach::Unknown);
        self.slides && inside(self.speed) && inside(self.force)
    }
}

impl Reach {
    /// Returns the relative difference between the requested value and `ratio` times the nearest
    /// recorded value.
    fn excess(&self, ratio: f64) -> f64 {
        match *self {
            Self::Inside | Self::Unknown | Self::Followed => 0.0,
            Self::Outside { asked, recorded } => (asked / recorded / ratio - 1.0).abs(),
        }
    }
}

/// Rounds to four digits, the precision of measured speeds and forces.
fn four_digits(x: f64) -> f64 {
    htex_host::decimal(&format!("{x:.3e}")).unwrap_or(x)
}

impl fmt::Display for Coverage {
    /// Describes in one sentence how the playback differs from the recording. Writes nothing if it
    /// does not differ.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.slides {
            return f.write_str("the finger does not slide, so the texture is silent");
        }
        let mut joint = "";
        for (reach, unit) in [(self.speed, "mm/s"), (self.force, "N")] {
            if let Reach::Outside { asked, recorded } = reach {
                let [asked, recorded] = [asked, recorded].map(four_digits);
                write!(f, "{joint}{asked} {unit}, where {recorded} {unit} was recorded")?;
                joint = "; ";
            }
        }
        if joint.is_empty() {
            return Ok(());
        }
        match self.scaling {
            Scaling::NONE => f.write_str(": played as recorded"),
            Scaling { frequency, level } => write!(
                f,
                ": frequencies are {frequency:.3} times as high, and the level is {level:.3} times as high"
            ),
        }
    }
}
