//! The motion of a finger over a texture, at one moment.

use crate::Error;
use crate::exploration::{MOST_FORCE_N, MOST_SPEED_MM_S, slides};

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
    /// Scanning speed, mm/s, finite. A voice of a texture expects the speed without a direction and
    /// refuses a negative value. In a scene, the speed is negative on the back stroke.
    pub speed_mm_s: f64,
    /// Normal force, newtons. The force must be finite and not negative.
    pub force_n: f64,
    /// Position along the path, mm. The position must be finite and may have either sign. `None` if
    /// unknown.
    pub position_mm: Option<f64>,
    /// Place on the surface, x and y, mm. Both coordinates must be finite and may have either sign.
    /// `None` if unknown.
    pub place_mm: Option<[f64; 2]>,
}

impl Motion {
    /// A finger without contact, at an unknown place.
    pub const AWAY: Self = Self::new(0.0, 0.0);

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

    /// Sets the place on the surface, x and y, mm; `None` if unknown.
    #[must_use]
    pub fn with_place_mm(self, place_mm: impl Into<Option<[f64; 2]>>) -> Self {
        Self { place_mm: place_mm.into(), ..self }
    }

    /// Returns a motion with only the values that a texture follows: the speed without its sign,
    /// and the force.
    #[must_use]
    pub fn without_direction(self) -> Self {
        Self::new(self.speed_mm_s.abs(), self.force_n)
    }

    /// Returns whether a finger can make this motion. All numbers must be finite, the speed must be
    /// at most 1000 mm/s in either direction, and the force must be from 0 to 20 N. A motion
    /// outside these limits counts as a failed reading of a sensor.
    pub fn is_reading(&self) -> bool {
        let unsigned = Self { speed_mm_s: self.speed_mm_s.abs(), ..*self };
        unsigned.checked().is_ok() && unsigned.is_plausible()
    }

    /// Returns whether the finger is in contact and moves at 0.5 mm/s or more, in either direction.
    pub fn slides(&self) -> bool {
        slides(self.speed_mm_s, self.force_n)
    }

    /// Returns the motion if its numbers are in range.
    ///
    /// # Errors
    /// Returns [`Error::Motion`] if the speed or the force is negative or not finite. Returns
    /// [`Error::Position`] if the position is not finite. Returns [`Error::Place`] if the place is
    /// not finite.
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
    pub(crate) fn is_plausible(&self) -> bool {
        self.speed_mm_s <= MOST_SPEED_MM_S && self.force_n <= MOST_FORCE_N
    }

    /// Returns whether another motion has the same speed and force. The parameters depend only on
    /// these two.
    pub(crate) fn has_conditions_of(&self, other: &Self) -> bool {
        (self.speed_mm_s, self.force_n) == (other.speed_mm_s, other.force_n)
    }
}
