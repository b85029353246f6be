//! How strongly a texture fluctuates, i.e. becomes stronger and weaker in time.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The fluctuation of a texture: the strength of one random envelope that multiplies all bands.
///
/// Noise with a recorded spectrum is equally strong at all times, but a recording is not. A player
/// can multiply the noise by an envelope `exp(x)` with the mean square 1, where x is Gaussian
/// noise. The two fields contain the standard deviations of the slow and the fast part of x, in
/// steps of 1/32 dB. The fluctuation changes neither the texture's spectrum nor its level.
///
/// ```
/// use htex_format::Fluctuation;
/// let fluctuation = Fluctuation::from_db([3.0, 1.52]);
/// assert_eq!(fluctuation.map(|f| (f.slow, f.fast)), Some((96, 49)));
/// assert_eq!(Fluctuation::from_db([0.0, 0.01]), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Fluctuation {
    /// Standard deviation of the part at 0.5 to 8 Hz, in steps of 1/32 dB.
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 255)))]
    pub slow: u8,
    /// Standard deviation of the part at 8 to 32 Hz, in steps of 1/32 dB.
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 255)))]
    pub fast: u8,
    /// Held-out error, decibels. To measure it, the fluctuation is estimated from the first halves
    /// of the recordings and played. The error is the RMS difference between the modulation spectra
    /// of the result and of the second halves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 100)))]
    pub held_out_error_db: Option<f64>,
    /// RMS difference between the modulation spectra of the first and of the second halves of the
    /// recordings, decibels. It shows how much a second recording would differ.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schemars", schemars(range(min = 0, max = 100)))]
    pub halves_error_db: Option<f64>,
}

impl Fluctuation {
    /// Size of a step, decibels.
    pub const STEP_DB: f64 = 1.0 / 32.0;

    /// Largest error that an asset may state, decibels.
    pub const MOST_ERROR_DB: f64 = 100.0;

    /// Rounds two standard deviations in decibels to numbers of steps, each at most 255. The errors
    /// are unknown. `None` if both standard deviations become 0.
    pub fn from_db(strength_db: [f64; 2]) -> Option<Self> {
        // The conversion limits numbers that are out of range, and turns NaN into 0.
        let [slow, fast] = strength_db.map(|db| (db / Self::STEP_DB).round() as u8);
        (slow > 0 || fast > 0).then_some(Self { slow, fast, ..Self::default() })
    }

    /// Returns the standard deviations of the slow and the fast part, decibels: 0 to 7.97.
    pub fn decibels(self) -> [f64; 2] {
        [self.slow, self.fast].map(|steps| f64::from(steps) * Self::STEP_DB)
    }

    /// Returns the errors with their keys, in the order of the manifest.
    pub(crate) fn errors_db(&self) -> [(&'static str, Option<f64>); 2] {
        [("held_out_error_db", self.held_out_error_db), ("halves_error_db", self.halves_error_db)]
    }

    /// Returns whether the texture is equally strong at all times.
    pub fn is_zero(self) -> bool {
        self.slow == 0 && self.fast == 0
    }
}

/// Writes the standard deviations: Writes, for example, `3.00 dB at 0.5 to 8 Hz and 1.53 dB at 8 to
/// 32 Hz`.
impl fmt::Display for Fluctuation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [slow, fast] = self.decibels();
        write!(f, "{slow:.2} dB at 0.5 to 8 Hz and {fast:.2} dB at 8 to 32 Hz")
    }
}
