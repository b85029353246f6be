//! What a voice is made of: a texture's shape at the model's own rate, and its level.

use htex_host::{Band, LoadedModel, ModelVoice, Motion as ModelMotion};

use crate::exploration::{Coverage, Effects, Explored};
use crate::known::Known;
use crate::mesh::Weights;
use crate::{Error, Motion};

/// Most conditions that are mixed.
const MIXED: usize = 3;

/// Samples of unit RMS at the rate the model itself renders at, and the level they stand for. A
/// renderer that brings many textures together resamples them once, behind their sum; [`crate::Voice`]
/// does it for a single one. A source interpolates between conditions and does nothing else with a motion: what
/// lies beyond ([`Effects`]) is its renderer's.
///
/// ```no_run
/// use htex::{Asset, VoiceOptions};
/// let mut source = Asset::open("sandpaper.htex")?.source(&VoiceOptions::default())?;
/// let mut block = vec![0.0f32; (source.rate_hz() / 100.0) as usize];
/// source.render(&mut block)?; // 10 ms of unit RMS
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug)]
pub struct Source {
    known: Known,
    voice: ModelVoice,
    /// Buffers for the sets to mix, and for the mix.
    sets: Vec<f64>,
    mixed: Vec<f64>,
    rate_hz: f64,
    top_hz: f64,
    motion: Motion,
    level_rms: f64,
    /// The model follows the motion itself.
    follows: bool,
    /// Samples so far.
    frames: u64,
}

impl Source {
    pub(crate) fn new(
        known: Known,
        model: LoadedModel,
        band: Band,
        wanted_hz: f64,
        seed: u64,
        motion: Motion,
    ) -> Result<Self, Error> {
        let motion = motion.checked()?;
        let (parameters, level_rms) = known.at(&model, motion)?;
        let rate_hz = model.voice_rate_hz(&parameters, band, wanted_hz)?;
        Ok(Self {
            voice: model.voice(&parameters, band, rate_hz, seed)?,
            sets: Vec::with_capacity(MIXED * known.longest()),
            mixed: vec![0.0; model.most_parameters()],
            known,
            rate_hz,
            top_hz: band.high_hz,
            motion,
            level_rms,
            follows: model.follows_motion(),
            frames: 0,
        })
    }

    /// The rate the model renders at, hertz.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// The frequency above which there is nothing, hertz.
    pub fn top_hz(&self) -> f64 {
        self.top_hz
    }

    /// RMS of the texture at the present motion, in the asset's unit.
    pub fn level_rms(&self) -> f64 {
        self.level_rms
    }

    /// Whether the model follows the motion itself: it is told by [`Self::set_finger`], and neither its frequencies nor its
    /// level are to be scaled by a motion.
    pub fn follows_motion(&self) -> bool {
        self.follows
    }

    /// The motion that the spectrum is of.
    pub(crate) fn motion(&self) -> Motion {
        self.motion
    }

    /// Seconds of samples so far.
    pub fn rendered_s(&self) -> f64 {
        self.frames as f64 / self.rate_hz
    }

    /// Tells a model that follows the motion itself where the finger is `at_s` seconds after this source's first sample,
    /// which may lie behind what was rendered already: a resampler reads ahead. The speed is negative where the position
    /// falls; what is beyond the model ABI's ranges is clamped to them. Does nothing to other models. Does not allocate,
    /// lock or do I/O for models that keep to the ABI.
    ///
    /// # Errors
    /// When a number is not finite, or the model refuses the motion; the source then plays on as before.
    pub fn set_finger(&mut self, finger: ModelMotion, at_s: f64) -> Result<(), Error> {
        if !self.follows {
            return Ok(());
        }
        let ahead_s = self.rendered_s() - at_s;
        let motion = ModelMotion {
            position_mm: finger.position_mm + ahead_s * finger.speed_mm_s,
            ..finger
        };
        Ok(self.voice.set_motion(motion.clamped())?)
    }

    /// The conditions that are known.
    pub fn explored(&self) -> Explored {
        self.known.motions.explored
    }

    /// What a voice with these effects makes of a motion. Does not allocate.
    pub fn coverage(&self, motion: Motion, effects: Effects) -> Coverage {
        self.known.motions.coverage(motion, effects)
    }

    /// Glides to the spectrum at this motion, clamped to
    /// the conditions the asset knows, and returns its level. A motion that is not new
    /// costs nothing; a new one mixes parameters in the voice's own memory. Does not allocate, lock or
    /// do I/O for the models of this project and others that keep to the ABI.
    ///
    /// # Errors
    /// When a value is out of range (see [`Motion`]), or the model cannot mix; the source then plays on
    /// as before.
    pub fn set_motion(&mut self, motion: Motion) -> Result<f64, Error> {
        let motion = motion.checked()?;
        if self.motion.has_conditions_of(&motion) || self.known.parameters.len() < 2 {
            return Ok(self.level_rms);
        }
        let weights = self.known.motions.weights(motion);
        self.retune(&weights)?;
        self.motion = motion;
        let level_rms = |(i, weight): (usize, f64)| weight * self.known.level_rms[i];
        self.level_rms = weights.iter().map(level_rms).sum();
        Ok(self.level_rms)
    }

    /// Changes the spectrum to the mix of some conditions.
    fn retune(&mut self, weights: &Weights) -> Result<(), Error> {
        let known = &self.known.parameters;
        if weights.count == 1 {
            return Ok(self.voice.retune(&known[weights.condition[0]])?);
        }
        self.sets.clear();
        for (i, _) in weights.iter() {
            self.sets.extend_from_slice(&known[i]);
        }
        let weights = &weights.weight[..weights.count];
        Ok(self
            .voice
            .retune_mix(&self.sets, weights, &mut self.mixed)?)
    }

    /// Fills `out` with the next `frames` samples of each source, one behind the other: what
    /// [`Self::render`] gives of each, to the bit, in as few calls as models allow. In blocks of 256
    /// frames AR takes some six tenths of the time then. Sources for which `out` is too short stay as
    /// they are, and what is left of `out` is silent. Does not allocate, lock or do I/O.
    ///
    /// # Errors
    /// The first, when a model fails; what it should have rendered is silent, and other sources play on.
    pub fn render_together<'a>(
        sources: impl IntoIterator<Item = &'a mut Self>,
        frames: usize,
        out: &mut [f32],
    ) -> Result<(), Error> {
        let rows = out.len().checked_div(frames).unwrap_or_default();
        let voices = sources.into_iter().enumerate().map(|(row, source)| {
            source.frames += if row < rows { frames as u64 } else { 0 };
            &mut source.voice
        });
        Ok(htex_host::render_together(voices, frames, out)?)
    }

    /// Fills `out` with the next samples, of unit RMS. Does not allocate, lock or do I/O.
    ///
    /// # Errors
    /// When the model fails; `out` is then silent.
    pub fn render(&mut self, out: &mut [f32]) -> Result<(), Error> {
        self.frames += out.len() as u64;
        Ok(self.voice.render(out)?)
    }
}
