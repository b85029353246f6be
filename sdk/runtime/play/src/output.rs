//! The gain and the limiter of a voice, the last steps before the output.

use htex_dsp::glide::Glide;

use crate::Error;

/// Time constant with which the limiter recovers, seconds. A shorter time would distort the lowest
/// frequency of a texture, 20 Hz.
const RELEASE_S: f64 = 0.050;

/// The gain and the limiter of a voice.
#[derive(Debug)]
pub(crate) struct Output {
    gain: Glide,
    /// The gain at the end of its ramp.
    target: f32,
    limiter: Option<Limiter>,
}

impl Output {
    /// Makes a gain and a limiter. A change of the gain takes `ramp` samples. The limiter keeps
    /// samples within `limit`.
    ///
    /// # Errors
    /// Returns an error if the gain is negative or not finite, or the limit is not above 0.
    pub(crate) fn new(
        gain: f64,
        limit: Option<f64>,
        ramp: u32,
        rate_hz: f64,
    ) -> Result<Self, Error> {
        let limiter = limit.map(|limit| Limiter::new(limit, rate_hz)).transpose()?;
        let target = checked(gain)?;
        Ok(Self { gain: Glide::new(target, ramp), target, limiter })
    }

    /// Changes the gain: gradually, or at once if the voice is silent.
    ///
    /// # Errors
    /// Returns an error if `gain` is negative or not finite.
    pub(crate) fn set_gain(&mut self, gain: f64, rests: bool) -> Result<(), Error> {
        let gain = checked(gain)?;
        self.target = gain;
        // Nothing is heard, so a ramp would only delay the new gain.
        if rests {
            self.gain.restart(gain)
        } else {
            self.gain.set(gain)
        }
        Ok(())
    }

    /// Returns the gain, or the gain at the end of the current ramp.
    pub(crate) fn gain(&self) -> f64 {
        self.target.into()
    }

    pub(crate) fn apply(&mut self, block: &mut [f32]) {
        self.gain.apply(block);
        if let Some(limiter) = &mut self.limiter {
            limiter.apply(block);
        }
    }

    /// Ends all ramps at once. The samples are zero, so no jump is audible.
    pub(crate) fn rest(&mut self) {
        self.gain.finish();
        if let Some(limiter) = &mut self.limiter {
            limiter.gain = 1.0;
        }
    }
}

fn checked(gain: f64) -> Result<f32, Error> {
    // Checked in single precision, in which a large number may be infinite.
    let number = gain as f32;
    if number.is_finite() && number >= 0.0 {
        return Ok(number);
    }
    Err(Error::OutOfRange {
        name: "gain",
        value: gain,
        range: "it must be finite and not negative",
    })
}

/// A gain that drops at once when a sample would exceed the limit, and returns to 1 exponentially.
#[derive(Debug)]
struct Limiter {
    limit: f32,
    gain: f32,
    /// With each sample, the gain recovers by this fraction of its remaining distance to 1.
    release: f32,
}

impl Limiter {
    fn new(limit: f64, rate_hz: f64) -> Result<Self, Error> {
        let number = limit as f32;
        if !(number > 0.0 && number.is_finite()) {
            return Err(Error::OutOfRange {
                name: "limit",
                value: limit,
                range: "it must be finite and above 0",
            });
        }
        Ok(Self { limit: number, gain: 1.0, release: (1.0 / (RELEASE_S * rate_hz)) as f32 })
    }

    fn apply(&mut self, block: &mut [f32]) {
        for sample in block {
            // The gain recovers before the check, so that the sample stays within the limit.
            self.gain += (1.0 - self.gain) * self.release;
            let peak = sample.abs();
            if peak * self.gain > self.limit {
                self.gain = self.limit / peak;
            }
            // Rounding may raise the product above the limit.
            *sample = (*sample * self.gain).clamp(-self.limit, self.limit);
        }
    }
}
