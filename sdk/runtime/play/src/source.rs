//! The source of a voice's samples: samples with unit RMS at the model's own rate, and the level.

use htex_host::{Band, LoadedModel, ModelVoice, Motion as ModelMotion};

use crate::conditions::{Conditions, Placement, RecordedConditions};
use crate::mesh::Weights;
use crate::spectrum::scaled_magnitude;
use crate::travel::Course;
use crate::{Error, Motion};

/// Maximum number of conditions between which a motion is interpolated.
const MIXED: usize = 3;

/// A stream of unit-RMS samples at the model's own rate, and the level to multiply them by. A
/// program that renders many textures can add their sources and resample the sum once, whereas a
/// [`crate::Voice`] resamples a single texture. A source interpolates between conditions. The
/// program must itself apply all effects of a motion that [`crate::Effects`] lists.
///
/// ```no_run
/// use htex::{Texture, VoiceOptions};
/// let texture = Texture::open("sandpaper.htex")?;
/// let mut source = texture.representation(None)?.source(&VoiceOptions::default())?;
/// let mut block = vec![0.0f32; (source.rate_hz() / 100.0) as usize];
/// source.render(&mut block)?; // 10 ms of unit RMS
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug)]
pub struct SampleSource {
    recorded: RecordedConditions,
    model: LoadedModel,
    voice: ModelVoice,
    /// Buffers for the parameter sets to interpolate, and for the result.
    sets: Vec<f64>,
    mixed: Vec<f64>,
    rate_hz: f64,
    /// Whether the model always has this rate, no matter which rate the player wants.
    own_rate: bool,
    band: Band,
    motion: Motion,
    level_rms: f64,
    /// Whether the model follows the motion itself. If so, `course` holds the finger's path for it.
    follows: bool,
    course: Course,
    /// Samples rendered so far.
    frames: u64,
}

impl SampleSource {
    pub(crate) fn new(
        recorded: RecordedConditions,
        model: LoadedModel,
        band: Band,
        wanted_hz: f64,
        seed: u64,
        motion: Motion,
    ) -> Result<Self, Error> {
        let motion = motion.checked()?;
        let placement = recorded.conditions.locate(motion);
        let parameters = recorded.mix(&model, &placement)?;
        let rate_hz = model.voice_rate_hz(&parameters, band, wanted_hz)?;
        Ok(Self {
            voice: model.voice(&parameters, band, rate_hz, seed)?,
            // Reserved here, because `set_motion` must not allocate.
            sets: Vec::with_capacity(MIXED * recorded.longest()),
            mixed: vec![0.0; model.most_parameters()],
            recorded,
            rate_hz,
            own_rate: model.has_own_rate(&parameters, band, rate_hz)?,
            band,
            motion,
            level_rms: placement.level_rms,
            follows: model.follows_motion(),
            course: Course::default(),
            model,
            frames: 0,
        })
    }

    /// Returns the model's sample rate, hertz.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Returns whether the model always renders at its own rate, no matter which rate the player
    /// wants. If this is the case, convert the samples with
    /// [`Resampler::of_own_rate`](htex_dsp::resample::Resampler::of_own_rate), so that the texture
    /// has the same level at all rates.
    pub fn has_own_rate(&self) -> bool {
        self.own_rate
    }

    /// Returns the highest frequency of the texture, hertz.
    pub fn top_hz(&self) -> f64 {
        self.band.high_hz
    }

    /// Returns the frequency band of the texture.
    pub(crate) fn band(&self) -> Band {
        self.band
    }

    /// Returns the RMS of the texture at the current motion, in the asset's unit.
    pub fn level_rms(&self) -> f64 {
        self.level_rms
    }

    /// Returns whether the model follows the motion itself. If this is the case, call
    /// [`Self::follow`] for every motion, and scale neither frequencies nor level.
    pub fn follows_motion(&self) -> bool {
        self.follows
    }

    /// Returns the motion to which the current spectrum belongs.
    pub(crate) fn motion(&self) -> Motion {
        self.motion
    }

    /// Returns the magnitudes of the texture at a motion, if the texture is read at `ratio` times
    /// its recorded speed and played at a level.
    pub(crate) fn magnitude(
        &self,
        motion: Motion,
        frequency_hz: &[f64],
        ratio: f64,
        level_rms: f64,
    ) -> Result<Vec<f64>, Error> {
        let (model, placement) = (&self.model, self.recorded.conditions.locate(motion));
        let parameters = self.recorded.mix(model, &placement)?;
        scaled_magnitude(model, &parameters, self.band, frequency_hz, ratio, level_rms)
    }

    /// Returns the duration of all samples rendered so far, seconds.
    pub(crate) fn rendered_s(&self) -> f64 {
        self.frames as f64 / self.rate_hz
    }

    /// Sets the motion of the finger for a model that follows the motion itself. Does nothing for
    /// other models. Does not allocate, lock or do I/O if the model keeps to the ABI.
    ///
    /// `at_s` is the time of the motion, in seconds after this source's first sample. This time may
    /// be earlier than the time of the last rendered sample, because a resampler reads ahead. The
    /// source then moves the position and the place forward by the distance that the finger covers
    /// between the two times.
    ///
    /// The speed is negative while the position decreases. An unknown position counts as 0. If the
    /// place is unknown, the model receives places along the x axis. Numbers are clamped to the
    /// ranges of the model ABI.
    ///
    /// # Errors
    /// Returns an error if a number is not finite, or the model refuses the motion. The source then
    /// continues unchanged.
    pub fn follow(&mut self, motion: Motion, at_s: f64) -> Result<(), Error> {
        if !self.follows {
            return Ok(());
        }
        let ahead_s = self.rendered_s() - at_s;
        let position_mm = motion.position_mm.unwrap_or_default() + ahead_s * motion.speed_mm_s;
        let way_mm = ahead_s * motion.speed_mm_s.abs();
        let place_mm = motion.place_mm.map(|place| self.course.extrapolate(place, way_mm));
        let [x_mm, y_mm] = place_mm.unwrap_or([position_mm, 0.0]);
        let motion = ModelMotion {
            speed_mm_s: motion.speed_mm_s,
            force_n: motion.force_n,
            position_mm,
            x_mm,
            y_mm,
        };
        Ok(self.voice.set_motion(motion.clamped())?)
    }

    /// Returns the conditions at which the representation was recorded.
    pub fn conditions(&self) -> &Conditions {
        &self.recorded.conditions
    }

    /// Starts a gradual change to the spectrum at this motion, and returns the level at this
    /// motion. The spectrum is interpolated between recorded conditions. A motion outside the
    /// recorded range has the spectrum and the level of the nearest motion within this range.
    /// Setting the same motion again costs no time. For a new motion, the source interpolates
    /// parameters in memory that it already owns. Does not allocate, lock or do I/O if the model
    /// keeps to the ABI, as this project's models do.
    ///
    /// # Errors
    /// Returns an error if a value is out of range (see [`Motion`]), or the model cannot
    /// interpolate. The source then continues unchanged.
    pub fn set_motion(&mut self, motion: Motion) -> Result<f64, Error> {
        let motion = motion.checked()?;
        if self.motion.has_conditions_of(&motion) || self.recorded.parameters.len() < 2 {
            return Ok(self.level_rms);
        }
        let placement = self.recorded.conditions.locate(motion);
        self.retune(motion, &placement)
    }

    /// Changes to the spectrum of a motion at its placement, and returns its level.
    pub(crate) fn retune(&mut self, motion: Motion, placement: &Placement) -> Result<f64, Error> {
        if self.recorded.parameters.len() > 1 {
            self.mix(&placement.weights)?;
            self.motion = motion;
            self.level_rms = placement.level_rms;
        }
        Ok(self.level_rms)
    }

    /// Changes to the spectrum of a weighted mix of conditions.
    fn mix(&mut self, weights: &Weights) -> Result<(), Error> {
        let known = &self.recorded.parameters;
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

    /// Fills `out` with the next `frames` samples of each source, one source after another. The
    /// samples are bit-identical to the samples from [`Self::render`], but the models are called as
    /// few times as possible. For example, rendering several voices of the AR model in blocks of
    /// 256 frames takes about 60 % of the time of separate calls. If `out` is too short for all
    /// sources, the sources that do not fit are not advanced. If `out` is too long, the remaining
    /// samples are set to zero. Does not allocate, lock or do I/O.
    ///
    /// # Errors
    /// Returns the first error that a model returns. The samples of the failed source are zero, and
    /// the other sources continue.
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

    /// Fills `out` with the next samples, which have unit RMS. Does not allocate, lock or do I/O.
    ///
    /// # Errors
    /// Returns an error if the model fails. `out` is then filled with zeros.
    pub fn render(&mut self, out: &mut [f32]) -> Result<(), Error> {
        self.frames += out.len() as u64;
        Ok(self.voice.render(out)?)
    }
}
