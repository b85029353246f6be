//! The parameters of the five surfaces that can be simulated.

use std::fmt;
use std::str::FromStr;

use crate::AuthorError;

/// A surface that can be simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Surface {
    /// Strong and broadband: grains of many sizes, with energy up to several hundred hertz.
    Sandpaper,
    /// Weak and broadband: a weave of a quarter millimetre.
    FineFabric,
    /// Weak and low-frequency: a weave of a millimetre.
    CoarseFabric,
    /// Strong and low-frequency: parallel ridges (flutes), two millimetres apart.
    CorrugatedPaper,
    /// Weak and low-frequency: shallow embossing.
    Vinyl,
}

impl Surface {
    pub const ALL: [Self; 5] =
        [Self::Sandpaper, Self::FineFabric, Self::CoarseFabric, Self::CorrugatedPaper, Self::Vinyl];

    /// Returns the surface's name in kebab case.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sandpaper => "sandpaper",
            Self::FineFabric => "fine-fabric",
            Self::CoarseFabric => "coarse-fabric",
            Self::CorrugatedPaper => "corrugated-paper",
            Self::Vinyl => "vinyl",
        }
    }

    pub(super) const fn parameters(self) -> &'static Parameters {
        match self {
            Self::Sandpaper => &SANDPAPER,
            Self::FineFabric => &FINE_FABRIC,
            Self::CoarseFabric => &COARSE_FABRIC,
            Self::CorrugatedPaper => &CORRUGATED_PAPER,
            Self::Vinyl => &VINYL,
        }
    }
}

impl fmt::Display for Surface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Surface {
    type Err = AuthorError;

    fn from_str(text: &str) -> Result<Self, AuthorError> {
        Self::ALL
            .into_iter()
            .find(|surface| surface.name() == text)
            .ok_or_else(|| AuthorError::UnknownSurface { text: text.chars().take(40).collect() })
    }
}

/// A periodic part of the relief: the thread of a weave or a flute, with its harmonics.
#[derive(Debug)]
pub(super) struct Line {
    /// Periods per millimetre. At 80 mm/s the frequency in hertz is 80 times this number.
    pub(super) per_mm: f64,
    /// Standard deviation, relative to the other parts of the surface.
    pub(super) weight: f64,
    /// Random walk of the phase, radians per root millimetre, which sets the width of the line.
    pub(super) wander: f64,
}

/// An irregular part of the relief: noise with most of its power between two spatial frequencies.
#[derive(Debug)]
pub(super) struct Grain {
    /// Lower edge, periods per millimetre. Below it the spectrum falls by 6 dB per octave.
    pub(super) from_per_mm: f64,
    /// Upper edge, periods per millimetre. Above it the spectrum falls by 12 dB per octave.
    pub(super) to_per_mm: f64,
    /// Standard deviation, relative to the other parts of the surface.
    pub(super) weight: f64,
}

#[derive(Debug)]
pub(super) struct Parameters {
    /// Label of the random stream, so that different surfaces with the same seed differ.
    pub(super) label: u64,
    /// Coefficient of kinetic friction, unitless.
    pub(super) friction: f64,
    /// Standard deviation of the friction coefficient along the surface, before the finger smooths
    /// it.
    pub(super) relief: f64,
    /// Periodic parts.
    pub(super) lines: &'static [Line],
    /// Irregular parts.
    pub(super) grains: &'static [Grain],
}

impl Parameters {
    /// Returns the standard deviation of a part of the relief whose weight is 1.
    pub(super) fn unit(&self) -> f64 {
        let lines = self.lines.iter().map(|line| line.weight * line.weight);
        let grains = self.grains.iter().map(|grain| grain.weight * grain.weight);
        self.relief / libm::sqrt(lines.sum::<f64>() + grains.sum::<f64>())
    }
}

const SANDPAPER: Parameters = Parameters {
    label: 1,
    friction: 0.75,
    relief: 0.042,
    lines: &[],
    grains: &[
        Grain { from_per_mm: 2.0, to_per_mm: 6.0, weight: 1.0 },
        Grain { from_per_mm: 0.4, to_per_mm: 2.0, weight: 0.4 },
    ],
};

const FINE_FABRIC: Parameters = Parameters {
    label: 2,
    friction: 0.60,
    relief: 0.018,
    lines: &[
        Line { per_mm: 3.9, weight: 0.65, wander: 1.5 },
        Line { per_mm: 1.95, weight: 0.3, wander: 1.2 },
    ],
    grains: &[Grain { from_per_mm: 2.0, to_per_mm: 7.0, weight: 1.0 }],
};

const COARSE_FABRIC: Parameters = Parameters {
    label: 3,
    friction: 0.55,
    relief: 0.016,
    lines: &[
        Line { per_mm: 1.05, weight: 0.9, wander: 0.8 },
        Line { per_mm: 2.1, weight: 0.4, wander: 1.2 },
        Line { per_mm: 0.52, weight: 0.4, wander: 0.5 },
    ],
    grains: &[Grain { from_per_mm: 0.3, to_per_mm: 1.5, weight: 0.7 }],
};

const CORRUGATED_PAPER: Parameters = Parameters {
    label: 4,
    friction: 0.50,
    relief: 0.055,
    lines: &[
        Line { per_mm: 0.5, weight: 1.0, wander: 0.35 },
        Line { per_mm: 1.0, weight: 0.5, wander: 0.5 },
        Line { per_mm: 1.5, weight: 0.25, wander: 0.6 },
        Line { per_mm: 2.0, weight: 0.12, wander: 0.7 },
    ],
    grains: &[Grain { from_per_mm: 0.4, to_per_mm: 2.0, weight: 0.35 }],
};

const VINYL: Parameters = Parameters {
    label: 5,
    friction: 0.85,
    relief: 0.014,
    lines: &[],
    grains: &[
        Grain { from_per_mm: 0.25, to_per_mm: 0.9, weight: 1.0 },
        Grain { from_per_mm: 0.8, to_per_mm: 3.0, weight: 0.25 },
    ],
};
