//! A representation of a texture: the parameters of a model, and the model that plays them.

use htex_format::Condition;
use htex_host::{LoadedModel, StillSound, Synthesis};

use crate::conditions::{Conditions, RecordedConditions, default_condition};
use crate::exploration::{CEILING, Scaling, USUAL, slides};
use crate::parameter::{Parameter, with_names};
use crate::playable::field_order;
use crate::spectrum::scaled_magnitude;
use crate::{Error, Motion, SampleSource, Texture, Voice, VoiceOptions};

/// Highest sample rate, hertz, of models and of the resampler.
const MOST_RATE_HZ: f64 = 1e7;

/// A representation of a texture: the parameters of one model at each recorded condition.
/// [`Texture::representation`] returns it.
///
/// A texture may have several representations of the same surface, made by different models. The
/// model of a representation is loaded when a method first needs it.
///
/// ```no_run
/// use htex::{Motion, Texture, VoiceOptions};
/// let texture = Texture::open("sandpaper.htex")?;
/// let bands = texture.representation("bands")?;
/// let mut voice = bands.voice(&VoiceOptions::default())?;
/// println!("{} N at 160 mm/s", bands.level_rms(Some(Motion::new(160.0, 0.4)))?);
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Representation<'a> {
    texture: &'a Texture,
    index: usize,
}

impl<'a> Representation<'a> {
    pub(crate) fn new(texture: &'a Texture, index: usize) -> Self {
        Self { texture, index }
    }

    /// Returns the texture that the representation belongs to.
    pub fn texture(&self) -> &'a Texture {
        self.texture
    }

    /// Returns the manifest's entry for this representation.
    pub fn data(&self) -> &'a htex_format::Representation {
        &self.texture.manifest().representations[self.index]
    }

    /// Returns the full id of the model, such as `org.htex.bands`.
    pub fn id(&self) -> &'a str {
        &self.data().model
    }

    /// Returns whether this program has a model that can play the representation. Loads no model.
    pub fn is_runnable(&self) -> bool {
        self.texture.is_runnable(self.data())
    }

    /// Returns the model of the representation, and loads it if necessary.
    ///
    /// # Errors
    /// Returns an error if the model is missing or incompatible.
    pub fn model(&self) -> Result<LoadedModel, Error> {
        self.texture.model(self.index)
    }

    /// Returns the conditions at which the representation was recorded. Loads no model.
    ///
    /// # Errors
    /// Returns an error if the stored triangles are invalid.
    pub fn conditions(&self) -> Result<Conditions, Error> {
        let manifest = self.texture.manifest();
        Conditions::for_representation(self.data(), &manifest.conditions, manifest.law())
            .map_err(|error| Error::Triangles { model: self.id().to_owned(), error })
    }

    /// Makes a voice, which plays the representation.
    ///
    /// # Errors
    /// Returns an error if the model is missing or incompatible, or if it refuses the parameters.
    /// Also returns an error if the sample rate is below twice the highest frequency of the
    /// texture, or if another option is out of range.
    pub fn voice(&self, options: &VoiceOptions) -> Result<Voice, Error> {
        self.check_rate(options.rate_hz)?;
        let ceiling = options.ceiling;
        if !(ceiling > 0.0 && ceiling.is_finite()) {
            return Err(Error::Ceiling { ceiling });
        }
        let still = self.still(options)?;
        let base = self.base_ratio(options)?;
        // The voice reads the source at `base` times its speed, so the source can run at a lower
        // rate.
        let source = self.source(&options.clone().with_rate_hz(options.rate_hz / base))?;
        let fluctuation = self.texture.manifest().fluctuation.filter(|_| options.fluctuation);
        Voice::new(source, still, options, base, fluctuation)
    }

    /// Refuses a sample rate that is too low for the texture's frequencies.
    fn check_rate(&self, rate_hz: f64) -> Result<(), Error> {
        let least_hz = 2.0 * self.texture.band().high_hz;
        if (least_hz..=MOST_RATE_HZ).contains(&rate_hz) {
            Ok(())
        } else {
            Err(Error::Rate { rate_hz, least_hz })
        }
    }

    /// Returns the initial reading speed of a voice, as a multiple of the recorded speed.
    fn base_ratio(&self, options: &VoiceOptions) -> Result<f64, Error> {
        let Some(motion) = options.motion else {
            return Ok(1.0);
        };
        let motion = motion.checked()?;
        let streamed = options.synthesis == Synthesis::Streamed;
        let follows = streamed && self.model()?.follows_motion();
        let slides = slides(motion.speed_mm_s, motion.force_n);
        let scales = options.effects.frequency_scaling && slides && !follows;
        Ok(if scales && motion.is_plausible() {
            self.conditions()?.scaling(motion, options.ceiling).frequency
        } else {
            1.0
        })
    }

    /// Makes the pre-rendered sound of a voice, or returns `None` if the voice is streamed.
    fn still(&self, options: &VoiceOptions) -> Result<Option<StillSound>, Error> {
        if options.synthesis == Synthesis::Streamed {
            return Ok(None);
        }
        let (parameters, _) = self.parameters(options.motion)?;
        Ok(StillSound::new(
            options.synthesis,
            &self.model()?,
            &parameters,
            self.texture.band(),
            options.rate_hz,
            options.seed,
        )?)
    }

    /// Makes the source of a voice: a stream of samples of unit RMS, before the level is applied.
    /// `options` has the sample rate of the program's output. For this rate, the model chooses the
    /// sample rate of the source.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::voice`].
    pub fn source(&self, options: &VoiceOptions) -> Result<SampleSource, Error> {
        let motion = options.motion.unwrap_or_else(|| self.start());
        let model = self.model()?;
        let recorded = self.recorded(&model)?;
        let (band, rate_hz) = (self.texture.band(), options.rate_hz);
        SampleSource::new(recorded, model, band, rate_hz, options.seed, motion)
    }

    /// Returns the magnitudes that a long recording of the voice would show at a motion, or at the
    /// default condition if `motion` is `None`. Frequencies are in hertz, magnitudes in the asset's
    /// unit. Outside the recorded conditions, the asset's scaling law applies. If the finger does
    /// not slide at this motion, the magnitudes are 0. Suppose that m(f) is the magnitude at a
    /// recorded condition, and that the law scales all frequencies by a ratio r. The magnitude of
    /// noise is then `m(f / r) / sqrt(r)`, and the magnitude of a sum of sinusoids is `m(f / r)`.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::voice`].
    pub fn magnitude(
        &self,
        motion: Option<Motion>,
        frequency_hz: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let model = self.model()?;
        let Some(scaling) = self.scaling(motion)? else {
            return Ok(vec![0.0; frequency_hz.len()]);
        };
        let (parameters, level_rms) = self.parameters(motion)?;
        let (band, level_rms) = (self.texture.band(), level_rms * scaling.level);
        scaled_magnitude(&model, &parameters, band, frequency_hz, scaling.frequency, level_rms)
    }

    /// Returns the level of a voice at a motion, or at the default condition if `motion` is `None`.
    /// The level is the RMS in the asset's unit. Outside the recorded conditions, the asset's
    /// scaling law applies. If the finger does not slide at this motion, the level is 0.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::voice`].
    pub fn level_rms(&self, motion: Option<Motion>) -> Result<f64, Error> {
        let Some(scaling) = self.scaling(motion)? else {
            return Ok(0.0);
        };
        let (_, level_rms) = self.parameters(motion)?;
        Ok(level_rms * scaling.level)
    }

    /// Returns the factors that scale frequencies and level at a motion, or `None` if the finger
    /// does not slide.
    fn scaling(&self, motion: Option<Motion>) -> Result<Option<Scaling>, Error> {
        let Some(motion) = motion else {
            return Ok(Some(Scaling::NONE));
        };
        let motion = motion.checked()?;
        if !slides(motion.speed_mm_s, motion.force_n) {
            return Ok(None);
        }
        // A model that follows the motion itself needs no factors.
        if self.model().is_ok_and(|model| model.follows_motion()) {
            return Ok(Some(Scaling::NONE));
        }
        Ok(Some(self.conditions()?.scaling(motion, CEILING)))
    }

    /// Returns the magnitudes at a motion as they were recorded, or interpolated between
    /// recordings. Unlike [`Self::magnitude`], this function does not apply the asset's scaling
    /// law. It also returns these magnitudes, and not 0, if the finger does not slide at this
    /// motion.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::voice`].
    pub fn recorded_magnitude(
        &self,
        motion: Option<Motion>,
        frequency_hz: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let (parameters, level_rms) = self.parameters(motion)?;
        let shape = self.model()?.magnitude(&parameters, self.texture.band(), frequency_hz)?;
        Ok(shape.iter().map(|m| m * level_rms).collect())
    }

    /// Returns the parameters (a flat array) and the level (RMS, in the asset's unit) at a motion,
    /// as recorded or interpolated between recordings. If `motion` is `None`, the function uses the
    /// default condition.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::voice`].
    pub fn parameters(&self, motion: Option<Motion>) -> Result<(Vec<f64>, f64), Error> {
        let motion = motion.unwrap_or_else(|| self.start()).checked()?;
        let model = self.model()?;
        let recorded = self.recorded(&model)?;
        let placement = recorded.conditions.locate(motion);
        Ok((recorded.mix(&model, &placement)?, placement.level_rms))
    }

    /// Returns the same parameters as [`Self::parameters`], with the names of the model's fields.
    ///
    /// ```no_run
    /// let texture = htex::Texture::open("sandpaper.htex")?;
    /// for (name, parameter) in texture.representation("sbeta")?.named_parameters(None)? {
    ///     println!("{name}: {parameter:?}");
    /// }
    /// # Ok::<(), htex::Error>(())
    /// ```
    ///
    /// # Errors
    /// Returns the same errors as [`Self::voice`].
    pub fn named_parameters(
        &self,
        motion: Option<Motion>,
    ) -> Result<Vec<(String, Parameter)>, Error> {
        let (flat, _) = self.parameters(motion)?;
        Ok(with_names(&self.model()?.descriptor().fields, flat))
    }

    /// Returns the recorded conditions, with parameters in the order of the model's fields.
    fn recorded(&self, model: &LoadedModel) -> Result<RecordedConditions, Error> {
        let order = field_order(self.data(), model)?;
        let sets = self.texture.data().parameters[self.index].iter();
        let parameters: Result<_, _> = sets.map(|flat| order.arrange(flat)).collect();
        Ok(RecordedConditions {
            conditions: self.conditions()?,
            parameters: parameters.map_err(|error| Error::Fields {
                model: self.id().to_owned(),
                problem: error.to_string(),
            })?,
        })
    }

    /// Returns the index of the default condition (the condition that is played without a motion)
    /// in the manifest's list of conditions. Loads no model.
    ///
    /// The default is the representation's first condition, unless this condition is silent. If it
    /// is silent, the default is the condition with the highest level among the conditions that are
    /// not silent. If several conditions have this level, the default is the first of them. If all
    /// conditions are silent, the default is the first condition. A condition is silent if its
    /// level is 0, or if a finger does not slide at the speed or the force that the condition
    /// states.
    pub fn default_condition(&self) -> usize {
        let at = &self.data().at;
        let default = default_condition(at, &self.texture.manifest().conditions);
        at.get(default).map_or(0, |at| at.condition)
    }

    /// Returns a motion with a speed in mm/s and a force in newtons. A missing value is taken from
    /// [`Self::default_condition`]. If the default condition does not state the value either, the
    /// speed is 80 mm/s or the force is 0.4 N.
    ///
    /// ```no_run
    /// let texture = htex::Texture::open("sandpaper.htex")?;
    /// // At the force of the default condition.
    /// let faster = texture.representation(None)?.motion(Some(160.0), None);
    /// # Ok::<(), htex::Error>(())
    /// ```
    pub fn motion(&self, speed_mm_s: Option<f64>, force_n: Option<f64>) -> Motion {
        let default = self.condition();
        let (usual_mm_s, usual_n) = USUAL;
        Motion::new(
            speed_mm_s.or(default.speed_mm_s).unwrap_or(usual_mm_s),
            force_n.or(default.force_n).unwrap_or(usual_n),
        )
    }

    fn condition(&self) -> Condition {
        let condition = self.texture.manifest().conditions.get(self.default_condition());
        condition.copied().unwrap_or_default()
    }

    /// Returns the motion of the default condition. A value that the condition does not state is 0,
    /// as in the mesh.
    fn start(&self) -> Motion {
        let default = self.condition();
        let [speed_mm_s, force_n] =
            [default.speed_mm_s, default.force_n].map(Option::unwrap_or_default);
        Motion::new(speed_mm_s, force_n)
    }
}
