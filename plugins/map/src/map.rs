//! The grey values of a parameter set, and the interpolation between pixels.

use htex_model::{Error, Values, text};

use crate::{FORCE, GREY, MOST_SIDE, PITCH, RMS, SPEED, WIDTH};

/// A friction map, as the parameters describe it.
pub(crate) struct Map<'a> {
    pub(crate) width: usize,
    pub(crate) pitch_mm: f64,
    pub(crate) speed_mm_s: f64,
    pub(crate) force_n: f64,
    pub(crate) rms: f64,
    pub(crate) grey: &'a [f64],
}

impl<'a> Map<'a> {
    pub(crate) fn new(parameters: &Values<'a>) -> Result<Self, Error> {
        Self {
            width: parameters.scalar(WIDTH) as usize,
            pitch_mm: parameters.scalar(PITCH),
            speed_mm_s: parameters.scalar(SPEED),
            force_n: parameters.scalar(FORCE),
            rms: parameters.scalar(RMS),
            grey: parameters.list(GREY),
        }
        .checked()
    }

    /// Checks that the grey values form whole rows.
    ///
    /// # Errors
    /// Returns an error if the number of grey values is not a multiple of the width, or if there
    /// are too many rows.
    pub(crate) fn checked(self) -> Result<Self, Error> {
        let rows = self.grey.len() / self.width.max(1);
        if self.width == 0 || rows == 0 || rows > MOST_SIDE || rows * self.width != self.grey.len()
        {
            return Err(Error::parameters(text![
                "`grey` has ",
                self.grey.len() as f64,
                " values; it has 1 to 255 rows of `width` = ",
                self.width as f64
            ]));
        }
        Ok(self)
    }

    /// Returns the frequency of the slowest wave along a row at the stated speed, hertz.
    pub(crate) fn fundamental_hz(&self) -> f64 {
        self.speed_mm_s / (self.width as f64 * self.pitch_mm)
    }
}

/// Returns the interpolation weights of the four pixels around a place. The place is between the
/// second and the third pixel: `part` is its distance from the second pixel, in pixels.
pub(crate) fn cubic(part: f64) -> [f64; 4] {
    let (t, u) = (part, 1.0 - part);
    [
        -0.5 * t * u * u,
        1.0 + t * t * (1.5 * t - 2.5),
        1.0 + u * u * (1.5 * u - 2.5),
        -0.5 * u * t * t,
    ]
}
