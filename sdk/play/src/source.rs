//! The source of a voice: a texture's shape at the model's own rate, and its level.

use htex_host::{Band, LoadedModel, ModelVoice, Motion as ModelMotion};

use crate::known::{Known, Located, Motions};
use crate::mesh::Weights;
use crate::spectrum::scaled_magnitude;
use crate::travel::{Course, Finger};
use crate::{Error, Motion};

/// Most conditions that are interpolated.
const MIXED: usize = 3;

/// Samples of unit RMS at the model's own rate, and their level. A renderer of many textures
/// resamples their sum once; [`crate::Voice`] resamples a single texture. A source interpolates
/// between conditions; other effects of a motion ([`crate::Effects`]) are left to the renderer.
///
/// ```no_run
/// use htex::{Asset, VoiceOptions};
/// let mut source = Asset::open("sandpaper.htex")?.source(&VoiceOptions::default())?;
/// let mut block = vec![0.0f32; (source.rate_hz() / 100.0) as usize];
/// source.render(&mut block)?; // 10 ms of unit RMS
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug)]
pub struct SampleSource {
    known: Known,
    model: LoadedModel,
    voice: ModelVoice,
    /// Buffers for the parameter sets to interpolate, and for the result.
    sets: Vec<f64>,
    mixed: Vec<f64>,
    rate_hz: f64,
    /// Whether the model has this rate whichever is wanted.
    own_rate: bool,
    band: Band,
    motion: Motion,
    level_rms: f64,
    /// Whether the model follows the motion itself, and the finger's way over the surface for it.
    follows: bool,
    course: Course,
    /// Samples rendered so far.
    frames: u64,
}

impl SampleSource {
    pub(crate) fn new(
        known: Known,
        model: LoadedModel,
        band: Band,
        wanted_hz: f64,
        seed: u64,
        motion: Motion,
    ) -> Result<Self, Error> {
        let motion = motion.checked()?;
        let located = known.motions.locate(motion);
        let parameters = known.at(&model, &located)?;
        let rate_hz = model.voice_rate_hz(&parameters, band, wanted_hz)?;
        Ok(Self {
            voice: model.voice(&parameters, band, rate_hz, seed)?,
            sets: Vec::with_capacity(MIXED * known.longest()),
            mixed: vec![0.0; model.most_parameters()],
            known,
            rate_hz,
            own_rate: model.has_own_rate(&parameters, band, rate_hz)?,
            band,
            motion,
            level_rms: located.level_rms,
            follows: model.follows_motion(),
            course: Course::default(),
            model,
            frames: 0,
        })
    }

    /// Returns the rate at which the model renders, hertz.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Returns whether the model renders at this rate whichever is wanted. Its conversion is then
    /// [`Resampler::of_own_rate`](htex_dsp::resample::Resampler::of_own_rate), so that it has one
    /// level at all rates.
    pub fn has_own_rate(&self) -> bool {
        self.own_rate
    }

    /// Returns the highest frequency of the texture, hertz.
    pub fn top_hz(&self) -> f64 {
        self.band.high_hz
    }

    /// Returns the band of the texture.
    pub(crate) fn band(&self) -> Band {
        self.band
    }

    /// Returns the RMS of the texture at the current motion, in the asset's unit.
    pub fn level_rms(&self) -> f64 {
        self.level_rms
    }

    /// Returns whether the model follows the motion itself: the renderer then calls
    /// [`Self::set_finger`], and scales neither frequencies nor level.
    pub fn follows_motion(&self) -> bool {
        self.follows
    }

    /// Returns the motion of the current spectrum.
    pub(crate) fn motion(&self) -> Motion {
        self.motion
    }

    /// Returns the magnitudes of the texture at a motion, read at `ratio` times its recorded speed
    /// and played at a level.
    pub(crate) fn magnitude(
        &self,
        motion: Motion,
        frequency_hz: &[f64],
        ratio: f64,
        level_rms: f64,
    ) -> Result<Vec<f64>, Error> {
        let (model, located) = (&self.model, self.known.motions.locate(motion));
        let parameters = self.known.at(model, &located)?;
        scaled_magnitude(model, &parameters, self.band, frequency_hz, ratio, level_rms)
    }

    /// Returns the duration of the samples rendered so far, seconds.
    pub fn rendered_s(&self) -> f64 {
        self.frames as f64 / self.rate_hz
    }

    /// Sets the motion of the finger at `at_s` seconds after this source's first sample, for a
    /// model that follows the motion itself. The time may precede the samples rendered so far,
    /// because a resampler reads ahead. The speed is negative while the position decreases; numbers
    /// are clamped to the ranges of the model ABI. The position is moved on by the time that was
    /// rendered ahead; a known place is passed as it is, and an unknown one as a path along x. Does
    /// nothing for other models. Does not allocate, lock or do I/O if the model keeps to the ABI.
    ///
    /// # Errors
    /// When a number is not finite, or the model refuses the motion; the source then continues
    /// unchanged.
    pub fn set_finger(&mut self, finger: Finger, at_s: f64) -> Result<(), Error> {
        if !self.follows {
            return Ok(());
        }
        let ahead_s = self.rendered_s() - at_s;
        let position_mm = finger.position_mm + ahead_s * finger.speed_mm_s;
        let way_mm = ahead_s * finger.speed_mm_s.abs();
        let place_mm = finger.place_mm.map(|place| self.course.on(place, way_mm));
        let [x_mm, y_mm] = place_mm.unwrap_or([position_mm, 0.0]);
        let motion = ModelMotion {
            speed_mm_s: finger.speed_mm_s,
            force_n: finger.force_n,
            position_mm,
            x_mm,
            y_mm,
        };
        Ok(self.voice.set_motion(motion.clamped())?)
    }

    /// Returns the recorded motions.
    pub fn motions(&self) -> &Motions {
        &self.known.motions
    }

    /// Changes gradually to the spectrum of the recorded motion nearest to this one, and returns
    /// its level. An unchanged motion takes no time; a new one interpolates parameters in the
    /// voice's own memory. Does not allocate, lock or do I/O if the model keeps to the ABI, as the
    /// models of this project do.
    ///
    /// # Errors
    /// When a value is out of range (see [`Motion`]), or the model cannot interpolate; the source
    /// then continues unchanged.
    pub fn set_motion(&mut self, motion: Motion) -> Result<f64, Error> {
        let motion = motion.checked()?;
        if self.motion.has_conditions_of(&motion) || self.known.parameters.len() < 2 {
            return Ok(self.level_rms);
        }
        let located = self.known.motions.locate(motion);
        self.retune(motion, &located)
    }

    /// Changes the spectrum to that of a located motion, and returns its level.
    pub(crate) fn retune(&mut self, motion: Motion, located: &Located) -> Result<f64, Error> {
        if self.known.parameters.len() > 1 {
            self.mix(&located.weights)?;
            self.motion = motion;
            self.level_rms = located.level_rms;
        }
        Ok(self.level_rms)
    }

    /// Changes the spectrum to that of weighted conditions.
    fn mix(&mut self, weights: &Weights) -> Result<(), Error> {
        let known = &self.known.parameters;
        if weights.count == 1 {
            return Ok(self.voice.retune(&known[weights.condition[0]])?);
        }
        self.sets.clear();
        for (i, _) in weights.iter() {
            self.sets.extend_from_slice(&known[i]);
        }
        let weights = &weights.weight[..weights.count];
        Ok(self.voice.retune_mix(&self.sets, weights, &mut self.mixed)?)
    }

    /// Fills `out` with the next `frames` samples of each source, one source after another,
    /// bit-identical to [`Self::render`] of each, in as few calls as the models allow. AR then
    /// takes about six tenths of the time in blocks of 256 frames. If `out` is too short, the
    /// remaining sources are not advanced; if it is too long, the rest is filled with zeros. Does
    /// not allocate, lock or do I/O.
    ///
    /// # Errors
    /// The first error of a model. The samples of its source are zero, and other sources continue.
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
    /// When the model fails; `out` is then filled with zeros.
    pub fn render(&mut self, out: &mut [f32]) -> Result<(), Error> {
        self.frames += out.len() as u64;
        Ok(self.voice.render(out)?)
    }
}
