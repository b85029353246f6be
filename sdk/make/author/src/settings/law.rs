//! Exponents that the user gives for a texture's motion law (how frequencies and level change
//! outside the recorded range).

use std::str::FromStr;

use htex_format::{Exponent, Law, MOST_EXPONENT};
use serde::{Deserialize, Serialize};

/// Exponents that the user gives. A missing exponent is measured or assumed.
///
/// ```
/// use htex_author::settings::GivenLaw;
/// let law: GivenLaw = "frequency-speed=0,level-speed=0.4".parse()?;
/// assert_eq!((law.level_speed, law.level_force), (Some(0.4), None));
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields, try_from = "Exponents")]
#[cfg_attr(feature = "schemars", schemars(with = "Exponents"))]
pub struct GivenLaw {
    /// Exponent of the speed in the law of frequencies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency_speed: Option<f64>,
    /// Exponent of the speed in the law of the level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level_speed: Option<f64>,
    /// Exponent of the normal force in the law of the level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level_force: Option<f64>,
}

/// Exponents of the texture's law, from -4 to 4. A missing exponent is measured or assumed.
#[derive(Default, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
struct Exponents {
    /// Exponent with which frequencies follow the speed.
    #[cfg_attr(feature = "schemars", schemars(range(min = -4, max = 4)))]
    frequency_speed: Option<f64>,
    /// Exponent with which the level follows the speed.
    #[cfg_attr(feature = "schemars", schemars(range(min = -4, max = 4)))]
    level_speed: Option<f64>,
    /// Exponent with which the level follows the normal force.
    #[cfg_attr(feature = "schemars", schemars(range(min = -4, max = 4)))]
    level_force: Option<f64>,
}

impl TryFrom<Exponents> for GivenLaw {
    type Error = String;

    fn try_from(read: Exponents) -> Result<Self, String> {
        let law = Self {
            frequency_speed: read.frequency_speed,
            level_speed: read.level_speed,
            level_force: read.level_force,
        };
        law.check()
    }
}

impl GivenLaw {
    /// Returns `law` with the exponents that the user gave; the other exponents of `law` stay
    /// unchanged.
    #[must_use]
    pub fn over(&self, law: Law) -> Law {
        let given = |given: Option<f64>, own: Exponent| given.map_or(own, Exponent::given);
        Law {
            frequency_speed: given(self.frequency_speed, law.frequency_speed),
            level_speed: given(self.level_speed, law.level_speed),
            level_force: given(self.level_force, law.level_force),
        }
    }

    fn check(self) -> Result<Self, String> {
        let all = [self.frequency_speed, self.level_speed, self.level_force];
        match all.into_iter().flatten().find(|x| !is_exponent(*x)) {
            Some(x) => Err(format!(
                "{x} is not an exponent; write a number from -{MOST_EXPONENT} to {MOST_EXPONENT}"
            )),
            None => Ok(self),
        }
    }
}

fn is_exponent(x: f64) -> bool {
    // Written in this form to refuse NaN, for which every comparison is false.
    x.abs() <= MOST_EXPONENT
}

impl FromStr for GivenLaw {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut law = Self::default();
        for part in text.split(',') {
            let form = || {
                format!(
                    "`{part}` is not an exponent of a law; write frequency-speed=X, level-speed=X or level-force=X"
                )
            };
            let (name, value) = part.split_once('=').ok_or_else(form)?;
            // Recipes write the same names with underscores.
            let kept = match &*name.trim().replace('_', "-") {
                "frequency-speed" => &mut law.frequency_speed,
                "level-speed" => &mut law.level_speed,
                "level-force" => &mut law.level_force,
                _ => return Err(form()),
            };
            *kept = Some(value.trim().parse().map_err(|_| form())?);
        }
        law.check()
    }
}
