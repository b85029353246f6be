//! Physical quantities of an asset's samples.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A physical quantity of samples. Each quantity has one unit, which assets and players use for the
/// samples.
///
/// ```
/// use htex_format::Quantity;
/// assert_eq!(Quantity::Acceleration.unit(), "m/s2");
/// assert_eq!("lateral_force".parse(), Ok(Quantity::LateralForce));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Force on the finger or tool along the surface, N.
    #[default]
    LateralForce,
    /// Force on the finger or tool normal to the surface, N.
    NormalForce,
    /// Acceleration of the finger or tool, m/s².
    Acceleration,
    /// Velocity of the finger or tool, m/s.
    Velocity,
    /// Displacement of the finger or tool, m.
    Displacement,
}

/// The error for an unknown name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no {what} is called {name:?}; there are {}", known.join(", "))]
pub struct UnknownName {
    /// What the name should denote, such as `quantity`.
    pub what: &'static str,
    /// The unknown name.
    pub name: String,
    /// The names that exist.
    pub known: Vec<&'static str>,
}

impl UnknownName {
    /// Returns the value with this name.
    pub(crate) fn find<T: Copy>(
        what: &'static str,
        text: &str,
        all: &[T],
        name: impl Fn(T) -> &'static str,
    ) -> Result<T, Self> {
        let found = all.iter().copied().find(|one| name(*one) == text);
        found.ok_or_else(|| Self {
            what,
            name: text.to_owned(),
            known: all.iter().copied().map(name).collect(),
        })
    }
}

/// Parses the name used in a manifest.
impl FromStr for Quantity {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        UnknownName::find("quantity", text, Self::ALL, Self::name)
    }
}

impl Quantity {
    /// All quantities, in the order of the specification's table.
    pub const ALL: &[Self] = &[
        Self::LateralForce,
        Self::NormalForce,
        Self::Acceleration,
        Self::Velocity,
        Self::Displacement,
    ];

    /// Returns the name used in a manifest.
    pub const fn name(self) -> &'static str {
        match self {
            Self::LateralForce => "lateral_force",
            Self::NormalForce => "normal_force",
            Self::Acceleration => "acceleration",
            Self::Velocity => "velocity",
            Self::Displacement => "displacement",
        }
    }

    /// Returns the unit's symbol, as in a manifest.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::LateralForce | Self::NormalForce => "N",
            Self::Acceleration => "m/s2",
            Self::Velocity => "m/s",
            Self::Displacement => "m",
        }
    }

    /// Returns the unit as a suffix for the names of columns and fields: `n`, `m_s2`, `m_s` or `m`.
    pub const fn suffix(self) -> &'static str {
        match self {
            Self::LateralForce | Self::NormalForce => "n",
            Self::Acceleration => "m_s2",
            Self::Velocity => "m_s",
            Self::Displacement => "m",
        }
    }

    /// Returns the name used in running text.
    pub const fn words(self) -> &'static str {
        match self {
            Self::LateralForce => "lateral force",
            Self::NormalForce => "normal force",
            Self::Acceleration => "acceleration",
            Self::Velocity => "velocity",
            Self::Displacement => "displacement",
        }
    }

    /// Formats a value with its unit. An SI prefix is chosen so that the number has one to three
    /// digits before the decimal point.
    ///
    /// ```
    /// use htex_format::Quantity;
    /// assert_eq!(Quantity::LateralForce.text(0.01234), "12.34 mN");
    /// assert_eq!(Quantity::Displacement.text(2.5e-6), "2.500 um");
    /// assert_eq!(Quantity::Acceleration.text(12.0), "12.00 m/s2");
    /// ```
    pub fn text(self, value: f64) -> String {
        let prefixes = [(1.0, ""), (1e-3, "m"), (1e-6, "u"), (1e-9, "n")];
        let (size, prefix) =
            prefixes.into_iter().find(|(size, _)| value.abs() >= *size).unwrap_or((1.0, ""));
        let number = value / size;
        let digits = match number.abs() {
            large if large >= 100.0 => 1,
            middle if middle >= 10.0 => 2,
            _ => 3,
        };
        format!("{number:.digits$} {prefix}{}", self.unit())
    }

    /// Returns the largest allowed level (RMS) of an asset, in the quantity's unit. The limit keeps
    /// samples within the range of 32-bit floats in any scene. The limits of velocity and
    /// displacement follow from the largest allowed acceleration. A 20 Hz vibration with this
    /// acceleration reaches a velocity of 8.0e3 m/s and a displacement of 63 m. Each limit is
    /// rounded up to the next power of ten.
    pub const fn largest_level(self) -> f64 {
        match self {
            Self::LateralForce | Self::NormalForce | Self::Acceleration => 1e6,
            Self::Velocity => 1e4,
            Self::Displacement => 100.0,
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// On the command line, hyphens join the words of a name. The command line also accepts the names
/// used in manifests.
#[cfg(feature = "clap")]
impl clap::ValueEnum for Quantity {
    fn value_variants<'a>() -> &'a [Self] {
        Self::ALL
    }

    fn to_possible_value(&self) -> Option<clap::builder::PossibleValue> {
        let hyphens = match self {
            Self::LateralForce => "lateral-force",
            Self::NormalForce => "normal-force",
            other => return Some(other.name().into()),
        };
        Some(clap::builder::PossibleValue::new(hyphens).alias(self.name()))
    }
}
