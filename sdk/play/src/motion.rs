//! The motion of a finger over a texture, at one moment.

use crate::Error;
use crate::exploration::{MOST_FORCE_N, MOST_SPEED_MM_S};

/// The motion of a finger over a texture, at one moment.
///
/// ```
/// use htex::Motion;
/// let sliding = Motion::new(80.0, 0.4);
/// assert_eq!(sliding.position_mm, None);
/// let placed = sliding.with_position_mm(12.5);
/// assert_eq!((placed.speed_mm_s, placed.position_mm), (80.0, Some(12.5)));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Motion {
    /// Scanning speed, mm/s; finite and not negative.
    pub speed_mm_s: f64,
    /// Normal force, newtons; finite and not negative.
    pub force_n: f64,
    /// Position along the path, mm; finite, of either sign. `None` if unknown.
    pub position_mm: Option<f64>,
    /// Place on the surface, x and y, mm; finite, of either sign. `None` if unknown.
    pub place_mm: Option<[f64; 2]>,
}

impl Motion {
    /// Makes a motion with a scanning speed, mm/s, and a normal force, newtons. Position and place
    /// are unknown.
    pub const fn new(speed_mm_s: f64, force_n: f64) -> Self {
        Self { speed_mm_s, force_n, position_mm: None, place_mm: None }
    }

    /// Sets the position along the path, mm.
    #[must_use]
    pub const fn with_position_mm(self, position_mm: f64) -> Self {
        Self { position_mm: Some(position_mm), ..self }
    }

    /// Sets the place on the surface, mm.
    #[must_use]
    pub const fn with_place_mm(self, x_mm: f64, y_mm: f64) -> Self {
        Self { place_mm: Some([x_mm, y_mm]), ..self }
    }

    /// Returns the motion if its numbers are in range.
    ///
    /// # Errors
    /// [`Error::Motion`] if the speed or the force is negative or not finite; [`Error::Position`]
    /// if the position is not finite, and [`Error::Place`] if the place is not.
    ///
    /// ```
    /// use htex::Motion;
    /// assert!(Motion::new(80.0, 0.4).checked().is_ok());
    /// assert!(Motion::new(f64::NAN, 0.4).checked().is_err());
    /// ```
    pub fn checked(self) -> Result<Self, Error> {
        let in_range = |x: f64| x.is_finite() && x >= 0.0;
        if !(in_range(self.speed_mm_s) && in_range(self.force_n)) {
            return Err(Error::Motion { speed_mm_s: self.speed_mm_s, force_n: self.force_n });
        }
        if let Some(position_mm) = self.position_mm.filter(|mm| !mm.is_finite()) {
            return Err(Error::Position { position_mm });
        }
        match self.place_mm {
            Some([x_mm, y_mm]) if !(x_mm.is_finite() && y_mm.is_finite()) => {
                Err(Error::Place { x_mm, y_mm })
            }
            _ => Ok(self),
        }
    }

    /// Returns whether a finger can move like this: speed and force are at most [`MOST_SPEED_MM_S`]
    /// and [`MOST_FORCE_N`]. A voice treats other motions as failed readings and ignores them.
    pub fn is_plausible(&self) -> bool {
        self.speed_mm_s <= MOST_SPEED_MM_S && self.force_n <= MOST_FORCE_N
    }

    /// Returns whether speed and force equal those of another motion. Only they determine the
    /// parameters.
    pub(crate) fn has_conditions_of(&self, other: &Self) -> bool {
        (self.speed_mm_s, self.force_n) == (other.speed_mm_s, other.force_n)
    }
}
