//! A playing texture.

use htex_host::{Band, LoadedModel, Stream};

use crate::Error;
use crate::asset::Known;

/// Length of a change of level, seconds.
const RAMP_S: f64 = 0.010;

/// An endless stream of lateral force, newtons, that follows the finger's motion.
#[derive(Debug)]
pub struct Voice {
    known: Known,
    model: LoadedModel,
    stream: Stream,
    motion: (f64, f64),
    level_n: f32,
    target_n: f32,
    step_n: f32,
    ramp_len: u32,
    ramp_left: u32,
}

impl Voice {
    pub(crate) fn new(
        known: Known,
        model: LoadedModel,
        band: Band,
        rate_hz: f64,
        seed: u64,
        motion: (f64, f64),
    ) -> Result<Self, Error> {
        check_motion(motion.0, motion.1)?;
        let (parameters, level_n) = known.at(&model, motion.0, motion.1)?;
        Ok(Self {
            stream: Stream::new(&model, &parameters, band, rate_hz, seed)?,
            known,
            model,
            motion,
            level_n: level_n as f32,
            target_n: level_n as f32,
            step_n: 0.0,
            ramp_len: (RAMP_S * rate_hz).ceil().max(1.0) as u32,
            ramp_left: 0,
        })
    }

    /// Follows the finger: spectrum and level glide to those at this scanning speed (mm/s) and
    /// normal force (newtons), clamped to the conditions the asset knows. A motion that is not new
    /// costs nothing; a new one between conditions mixes parameters, which may allocate.
    ///
    /// # Errors
    /// When a value is negative or not a number, or the model cannot mix; the voice then plays on
    /// as before.
    pub fn set_motion(&mut self, speed_mm_s: f64, force_n: f64) -> Result<(), Error> {
        check_motion(speed_mm_s, force_n)?;
        if self.motion == (speed_mm_s, force_n) {
            return Ok(());
        }
        self.motion = (speed_mm_s, force_n);
        if self.known.parameters.len() < 2 {
            return Ok(());
        }
        let (parameters, level_n) = self.known.at(&self.model, speed_mm_s, force_n)?;
        self.stream.retune(&parameters)?;
        self.target_n = level_n as f32;
        self.step_n = (self.target_n - self.level_n) / self.ramp_len as f32;
        self.ramp_left = self.ramp_len;
        Ok(())
    }

    /// Fills `out` with the next samples, newtons. Does not allocate, lock or do I/O.
    ///
    /// # Errors
    /// When the model fails; `out` is then silent.
    pub fn render(&mut self, out: &mut [f32]) -> Result<(), Error> {
        self.stream.render(out)?;
        let ramp = out.len().min(self.ramp_left as usize);
        let (moving, steady) = out.split_at_mut(ramp);
        for sample in moving {
            self.ramp_left -= 1;
            self.level_n = if self.ramp_left == 0 {
                self.target_n
            } else {
                self.level_n + self.step_n
            };
            *sample *= self.level_n;
        }
        for sample in steady {
            *sample *= self.level_n;
        }
        Ok(())
    }
}

pub(crate) fn check_motion(speed_mm_s: f64, force_n: f64) -> Result<(), Error> {
    let sane = |x: f64| x.is_finite() && x >= 0.0;
    if sane(speed_mm_s) && sane(force_n) {
        return Ok(());
    }
    Err(Error::Motion {
        speed_mm_s,
        force_n,
    })
}
