//! A playing texture.

use htex_dsp::glide::Glide;
use htex_dsp::resample::Resampler;
use htex_host::{HostError, StillSound};

use crate::{Error, Source};

/// Length of a change of level, seconds.
const RAMP_S: f64 = 0.010;

/// An endless stream of lateral force, newtons, that follows the finger's motion.
#[derive(Debug)]
pub struct Voice {
    source: Source,
    resampler: Option<Resampler>,
    /// What is heard instead of the source, whose level counts then.
    still: Option<StillSound>,
    level_n: Glide,
}

impl Voice {
    /// A voice at `rate_hz`: the source and the resampler it needs, or a sound that stands for them.
    pub(crate) fn new(
        source: Source,
        rate_hz: f64,
        still: Option<StillSound>,
    ) -> Result<Self, Error> {
        let ramp = (RAMP_S * rate_hz).ceil().max(1.0) as u32;
        let resampler = Resampler::new(source.rate_hz(), rate_hz, source.top_hz());
        Ok(Self {
            resampler: resampler.map_err(HostError::from)?,
            level_n: Glide::new(source.level_n() as f32, ramp),
            source,
            still,
        })
    }

    /// Follows the finger: spectrum and level glide to those at this scanning speed (mm/s) and
    /// normal force (newtons), clamped to the conditions the asset knows; of a voice that is not
    /// streamed (see [`Synthesis`](crate::Synthesis)) the level alone. A motion that is not new
    /// costs nothing; a new one mixes parameters in the voice's own room. Does not allocate, lock or
    /// do I/O for the models of this project and others that keep to the ABI.
    ///
    /// # Errors
    /// When a value is negative or not a number, or the model cannot mix; the voice then plays on
    /// as before.
    pub fn set_motion(&mut self, speed_mm_s: f64, force_n: f64) -> Result<(), Error> {
        let level_n = self.source.set_motion(speed_mm_s, force_n)?;
        self.level_n.set(level_n as f32);
        Ok(())
    }

    /// Fills `out` with the next samples, newtons. Does not allocate, lock or do I/O.
    ///
    /// # Errors
    /// When the model fails; what it should have rendered is silent.
    pub fn render(&mut self, out: &mut [f32]) -> Result<(), Error> {
        let result = self.render_shape(out);
        self.level_n.apply(out);
        result
    }

    /// Samples of unit RMS at the voice's rate.
    fn render_shape(&mut self, out: &mut [f32]) -> Result<(), Error> {
        if let Some(still) = &mut self.still {
            still.render(out);
            return Ok(());
        }
        let Some(resampler) = &mut self.resampler else {
            return self.source.render(out);
        };
        let mut result = Ok(());
        resampler.process(out, &mut |block| {
            if let Err(error) = self.source.render(block) {
                result = Err(error);
            }
        });
        result
    }
}
