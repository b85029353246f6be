//! The motion law of a texture: how its frequencies and level change at a speed or force that was
//! not recorded.
//!
//! To play at the speed v and the force F, a player starts from the nearest recorded motion (v0,
//! F0). It multiplies frequencies by `(v / v0)^a` and the level by `(v / v0)^b (F / F0)^c`.
//! [`Law::assumed`] provides the exponents that were neither measured nor given by the user. The
//! assumed exponents depend on what slid over the surface ([`Contact`]) and on what the samples
//! measure ([`Quantity`]), e.g. a force.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::quantity::{Quantity, UnknownName};

/// The kind of contact: what slid over the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Contact {
    /// A bare or gloved finger, or a soft artificial fingertip.
    Finger,
    /// A rigid tool.
    Tool,
    /// Not known.
    #[default]
    Unknown,
}

/// Parses the name used in a manifest.
///
/// ```
/// assert_eq!("tool".parse(), Ok(htex_format::Contact::Tool));
/// ```
impl FromStr for Contact {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        UnknownName::find("contact", text, Self::ALL, Self::name)
    }
}

impl Contact {
    /// All kinds of contact.
    pub const ALL: &[Self] = &[Self::Finger, Self::Tool, Self::Unknown];

    /// Returns the name used in a manifest.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Finger => "finger",
            Self::Tool => "tool",
            Self::Unknown => "unknown",
        }
    }

    /// Returns whether the contact is unknown.
    pub fn is_unknown(&self) -> bool {
        *self == Self::Unknown
    }
}

#[cfg(feature = "clap")]
impl clap::ValueEnum for Contact {
    fn value_variants<'a>() -> &'a [Self] {
        Self::ALL
    }

    fn to_possible_value(&self) -> Option<clap::builder::PossibleValue> {
        Some(self.name().into())
    }
}

/// The motion law: how frequencies and level change at speeds and forces outside the recorded
/// range.
///
/// ```
/// use htex_format::{Contact, Law, Quantity};
/// let law = Law::assumed(Quantity::LateralForce, Contact::Finger);
/// assert_eq!((law.frequency_factor(2.0), law.level_factor(2.0, 0.5)), (2.0, 0.5));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Law {
    /// Exponent a: how frequencies change with the speed.
    pub frequency_speed: Exponent,
    /// Exponent b: how the level changes with the speed.
    pub level_speed: Exponent,
    /// Exponent c: how the level changes with the normal force.
    pub level_force: Exponent,
}

/// An exponent of a motion law, and its source.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Exponent {
    /// The exponent that a player uses, -4 to 4.
    #[cfg_attr(feature = "schemars", schemars(range(min = -4, max = 4)))]
    pub exponent: f64,
    /// Source of the exponent.
    pub source: ExponentSource,
    /// The measured value. `exponent` is usually the weighted mean of this estimate and the assumed
    /// exponent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimate: Option<f64>,
    /// Standard error of `estimate`, not negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(min = 0)))]
    pub standard_error: Option<f64>,
}

/// Source of an exponent of a motion law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ExponentSource {
    /// Measured from recordings at several speeds or forces.
    Measured,
    /// Entered by the user.
    Given,
    /// The usual value for the quantity and the contact.
    Assumed,
}

impl ExponentSource {
    /// Returns the name used in a manifest.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::Given => "given",
            Self::Assumed => "assumed",
        }
    }
}

/// Smallest weight of a measurement in the weighted mean of the measured and the assumed exponent.
/// A measurement with a smaller weight is not used.
const LEAST_WEIGHT: f64 = 0.1;
/// How much each exponent differs between surfaces, as a standard deviation. The order is:
/// frequency over speed, level over speed, level over force.
const SPREAD: [f64; 3] = [0.5, 0.15, 0.3];
/// Exponents of the force for a tool and for an unknown contact. The first constant is for assets
/// that state no law, and the second is for new assets.
const UNSTATED_FORCE: [f64; 2] = [0.07, 0.5];
const NEW_FORCE: [f64; 2] = [0.0, 0.25];
/// Largest allowed absolute value of an exponent.
pub const MOST_EXPONENT: f64 = 4.0;

impl Exponent {
    /// Creates an exponent with the source [`ExponentSource::Assumed`].
    pub const fn assumed(exponent: f64) -> Self {
        Self::new(exponent, ExponentSource::Assumed)
    }

    /// Creates an exponent from a measurement, its standard error and the assumed exponent.
    ///
    /// The result is the weighted mean of the measurement and the assumed exponent, limited to
    /// `bounds`. The weight of the measurement is the inverse square of its standard error. The
    /// weight of the assumed exponent is the inverse square of `spread`, the standard deviation of
    /// the exponent between surfaces. If the measurement has less than a tenth of the total weight,
    /// the result is the assumed exponent.
    ///
    /// ```
    /// use htex_format::{Exponent, ExponentSource};
    /// let sure = Exponent::measured(0.6, 0.01, 0.75, 0.15, [0.0, 1.0]);
    /// let unsure = Exponent::measured(3.0, 1.0, 0.75, 0.15, [0.0, 1.0]);
    /// assert!((sure.exponent - 0.6).abs() < 0.001);
    /// assert_eq!((unsure.exponent, unsure.source), (0.75, ExponentSource::Assumed));
    /// ```
    pub fn measured(
        estimate: f64,
        error: f64,
        assumed: f64,
        spread: f64,
        bounds: [f64; 2],
    ) -> Self {
        let (own, others) = (spread * spread, error * error);
        let weight = own / (own + others);
        // If the standard error is NaN, the weight is also NaN, and the comparison is false.
        let usable = weight >= LEAST_WEIGHT && estimate.is_finite();
        if !usable {
            return Self::assumed(assumed);
        }
        let drawn = weight * estimate + (1.0 - weight) * assumed;
        Self {
            exponent: drawn.clamp(bounds[0], bounds[1]),
            source: ExponentSource::Measured,
            estimate: Some(estimate),
            standard_error: Some(error),
        }
    }

    /// Creates an exponent from a value that the user entered.
    pub const fn given(exponent: f64) -> Self {
        Self::new(exponent, ExponentSource::Given)
    }

    pub(crate) const fn new(exponent: f64, source: ExponentSource) -> Self {
        Self { exponent, source, estimate: None, standard_error: None }
    }

    /// Returns whether all numbers of the exponent are in range.
    pub(crate) fn is_valid(&self) -> bool {
        let finite = self.estimate.is_none_or(f64::is_finite);
        let error = self.standard_error.is_none_or(|e| e.is_finite() && e >= 0.0);
        self.exponent.abs() <= MOST_EXPONENT && finite && error
    }
}

impl Law {
    /// Returns the usual law for a quantity and a contact.
    ///
    /// - Tool: frequencies do not change with the speed, and levels rise with `v^0.43 F^0.07`.
    ///   These are the medians of 81 materials of the Penn Haptic Texture Toolkit (H. Culbertson,
    ///   J. J. Lopez Delgado, K. J. Kuchenbecker 2014).
    /// - Bare finger: vibrations scale in time with the speed (C. M. Greenspon, K. R. McLellan, J.
    ///   D. Lieber, S. J. Bensmaia 2020; B. Delhaye, V. Hayward, P. Lefèvre, J.-L. Thonnard 2012).
    ///   Therefore, if the samples are a velocity, their level is proportional to the speed; if
    ///   they are an acceleration, their level is proportional to the square of the speed. The
    ///   level of other quantities does not change with the speed. All levels are proportional to
    ///   the normal force.
    /// - Unknown: frequencies do not change with the speed, and levels rise with `v^0.75 F^0.5`.
    ///   The exponent 0.75 is the median of recorded strokes on two materials.
    ///
    /// This is also the law of an asset that does not state a law. New assets state
    /// [`Self::for_new_assets`].
    ///
    /// The assumed exponents of the level depend on the frequency exponent a. In this law, a is 1
    /// (as for a relief) or 0 (as for a surface whose frequencies do not change with the speed).
    /// [`Self::reassumed`] interpolates between these two cases if a was measured or the user gave
    /// it.
    pub const fn assumed(quantity: Quantity, contact: Contact) -> Self {
        let a = match contact {
            Contact::Finger => 1.0,
            Contact::Tool | Contact::Unknown => 0.0,
        };
        let [b, c] = assumed_levels(a, quantity, contact, UNSTATED_FORCE);
        Self {
            frequency_speed: Exponent::assumed(a),
            level_speed: Exponent::assumed(b),
            level_force: Exponent::assumed(c),
        }
    }

    /// Returns the law that a new asset states if no exponent was measured. This is the law of
    /// [`Self::assumed`] with another exponent of the force for two kinds of contact: 0 for a tool,
    /// and 0.25 for an unknown contact.
    ///
    /// On 20 materials of the Penn Haptic Texture Toolkit, the force exponent of the level is 0.03
    /// for a tool (median; quartiles 0.01 and 0.05). Three fingers gave -0.07, 1.18 and 2.58. For
    /// an unknown contact, 0.25 is a weighted mean of 0 for a tool (weight 3) and 1 for a finger
    /// (weight 1). Tools have the larger weight because the large public collections were recorded
    /// with tools.
    #[must_use]
    pub fn for_new_assets(quantity: Quantity, contact: Contact) -> Self {
        Self::assumed(quantity, contact).reassumed(quantity, contact)
    }

    /// Returns this law, adapted to a new asset or to another quantity or contact. The function
    /// replaces an assumed exponent with the exponent of [`Self::for_new_assets`], and replaces a
    /// measured exponent with a weighted mean of the measurement and that exponent. It does not
    /// change an exponent that the user gave.
    ///
    /// The assumed exponents of the level depend on the law's frequency exponent, for every kind of
    /// contact. But if the frequency exponent was measured, the function uses a measured speed
    /// exponent of the level without averaging it, because the assumed exponent could be far from
    /// the truth.
    ///
    /// If the frequency exponent is 1, so that the frequencies scale with the speed, the level gets
    /// the exponents of a relief. If this exponent is 0, the level gets the exponents of a surface
    /// whose frequencies do not change. Between 0 and 1, the exponents of the level are
    /// interpolated.
    #[must_use]
    pub fn reassumed(&self, quantity: Quantity, contact: Contact) -> Self {
        let mut assumed = Self::assumed(quantity, contact);
        let anew = |i: usize, exponent: Exponent, assumed: Exponent| {
            // The specification limits a and b to 1, and c to 1.5. If the assumed exponent is
            // larger, it is the limit.
            let most = if i == 2 { 1.5 } else { 1.0 };
            let bounds = [0.0, assumed.exponent.max(most)];
            match (exponent.source, exponent.estimate, exponent.standard_error) {
                (ExponentSource::Given, ..) => exponent,
                (ExponentSource::Measured, Some(estimate), Some(error)) => {
                    Exponent::measured(estimate, error, assumed.exponent, SPREAD[i], bounds)
                }
                _ => assumed,
            }
        };
        let frequency_speed = anew(0, self.frequency_speed, assumed.frequency_speed);
        // The frequency exponent comes first, because the assumed levels depend on the result.
        let [b, c] = assumed_levels(frequency_speed.exponent, quantity, contact, NEW_FORCE);
        assumed.level_speed = Exponent::assumed(b);
        assumed.level_force = Exponent::assumed(c);
        let mut level_speed = anew(1, self.level_speed, assumed.level_speed);
        if frequency_speed.source == ExponentSource::Measured
            && let (ExponentSource::Measured, Some(own)) =
                (level_speed.source, level_speed.estimate)
        {
            // If the frequency exponent was measured, the assumed exponent of the level depends on
            // this measurement, which may be wrong. The measured exponent of the level does not
            // depend on it.
            level_speed.exponent = own.clamp(0.0, assumed.level_speed.exponent.max(1.0));
        }
        Self {
            frequency_speed,
            level_speed,
            level_force: anew(2, self.level_force, assumed.level_force),
        }
    }

    /// Returns the law without the measurements: only the exponents that a player uses, and their
    /// sources.
    #[must_use]
    pub const fn without_measurements(&self) -> Self {
        const fn plain(exponent: Exponent) -> Exponent {
            // Adding zero turns -0 into 0.
            Exponent::new(exponent.exponent + 0.0, exponent.source)
        }
        Self {
            frequency_speed: plain(self.frequency_speed),
            level_speed: plain(self.level_speed),
            level_force: plain(self.level_force),
        }
    }

    /// Returns the exponents with their keys, in the specification's order.
    pub const fn exponents(&self) -> [(&'static str, Exponent); 3] {
        [
            ("frequency_speed", self.frequency_speed),
            ("level_speed", self.level_speed),
            ("level_force", self.level_force),
        ]
    }

    /// Returns the factor by which all frequencies change. `speed_ratio` is the speed divided by
    /// the recorded speed.
    pub fn frequency_factor(&self, speed_ratio: f64) -> f64 {
        power(speed_ratio, self.frequency_speed.exponent)
    }

    /// Returns the factor by which the level changes. The ratios are the speed divided by the
    /// recorded speed, and the force divided by the recorded force.
    pub fn level_factor(&self, speed_ratio: f64, force_ratio: f64) -> f64 {
        power(speed_ratio, self.level_speed.exponent)
            * power(force_ratio, self.level_force.exponent)
    }
}

/// Writes the law as readable text:
/// `frequency over speed ^1.00 (assumed), level over speed ^0.43 (measured, 0.40 ± 0.10), ...`.
impl fmt::Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (key, exponent)) in self.exponents().into_iter().enumerate() {
            let (name, source) = (key.replace('_', " over "), exponent.source.name());
            let separator = if i == 0 { "" } else { ", " };
            write!(f, "{separator}{name} ^{:.2} ({source}", exponent.exponent)?;
            if let Some((estimate, error)) = exponent.estimate.zip(exponent.standard_error) {
                write!(f, ", {estimate:.2} ± {error:.2}")?;
            }
            write!(f, ")")?;
        }
        Ok(())
    }
}

/// Returns the assumed exponents of the level over speed and over force. They are interpolated
/// between two cases: a surface whose frequencies do not change (frequency exponent 0), and a
/// relief (frequency exponent 1). `force` contains the exponents of the force for a tool and for an
/// unknown contact.
const fn assumed_levels(
    frequency_speed: f64,
    quantity: Quantity,
    contact: Contact,
    force: [f64; 2],
) -> [f64; 2] {
    let stays = match contact {
        Contact::Tool => [0.43, force[0]],
        Contact::Finger | Contact::Unknown => [0.75, force[1]],
    };
    let relief = match quantity {
        Quantity::Velocity => [1.0, 1.0],
        Quantity::Acceleration => [2.0, 1.0],
        _ => [0.0, 1.0],
    };
    let part = frequency_speed.clamp(0.0, 1.0);
    [stays[0] + part * (relief[0] - stays[0]), stays[1] + part * (relief[1] - stays[1])]
}

/// Returns `x^exponent`: exactly x for an exponent of 1, and exactly 1 for an exponent of 0.
fn power(x: f64, exponent: f64) -> f64 {
    if exponent == 0.0 || x == 1.0 {
        1.0
    } else if exponent == 1.0 {
        x
    } else {
        libm::pow(x, exponent)
    }
}
