//! The physical quantity of samples, and its unit.

/// Physical quantity of the samples, with the unit in which they are rendered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
#[repr(u8)]
pub enum Quantity {
    /// Force along the surface, N.
    LateralForce = 1,
    /// Force normal to the surface, N.
    NormalForce = 2,
    /// Acceleration, m/s².
    Acceleration = 3,
    /// Velocity, m/s.
    Velocity = 4,
    /// Displacement, m.
    Displacement = 5,
}

impl Quantity {
    /// All quantities, in the order of their codes.
    pub const ALL: &[Self] = &[
        Self::LateralForce,
        Self::NormalForce,
        Self::Acceleration,
        Self::Velocity,
        Self::Displacement,
    ];

    /// Returns the quantity with this code in a block.
    pub(crate) fn of_code(code: u8) -> Option<Self> {
        Self::ALL.iter().copied().find(|q| *q as u8 == code)
    }

    /// Returns the name that the quantity has in a manifest.
    pub const fn name(self) -> &'static str {
        match self {
            Self::LateralForce => "lateral_force",
            Self::NormalForce => "normal_force",
            Self::Acceleration => "acceleration",
            Self::Velocity => "velocity",
            Self::Displacement => "displacement",
        }
    }

    /// Returns the symbol of the unit, as in a manifest: `N`, `m/s2`, `m/s` or `m`.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::LateralForce | Self::NormalForce => "N",
            Self::Acceleration => "m/s2",
            Self::Velocity => "m/s",
            Self::Displacement => "m",
        }
    }
}
