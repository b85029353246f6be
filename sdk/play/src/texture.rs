//! An asset and the models that can play it.
//!
//! A model is loaded when one of its representations is first used: validating, listing or
//! inspecting an asset runs no module.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use htex_format::{Condition, ErrorMeasure, Manifest, Quantity, Representation};
use htex_host::{Band, HostError, LoadedModel, RUNS_WASM, Registry, StillSound, Synthesis};

use crate::condition::default_condition;
use crate::exploration::{CEILING, Scaling, USUAL};
use crate::known::{Known, Motions};
use crate::parameter::{Parameter, named};
use crate::playable::{field_order, model_of};
use crate::spectrum::scaled_magnitude;
use crate::{Error, Motion, SampleSource, Voice, VoiceOptions};

/// Highest sample rate, hertz, of models and of the resampler.
const MOST_RATE_HZ: f64 = 1e7;

/// An opened texture. Its clones share the data of the file.
///
/// ```no_run
/// let asset = htex::Texture::open("sandpaper.htex")?;
/// println!("{} in {}", asset.manifest().name, asset.quantity().unit());
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Texture {
    data: Arc<htex_format::Asset>,
    registry: Registry,
    /// Whether embedded models may run.
    embedded: bool,
    /// The model of each representation, loaded when it is first used.
    models: Arc<[OnceLock<LoadedModel>]>,
}

impl Texture {
    /// Opens a file. The embedded and the built-in models can play it.
    ///
    /// # Errors
    /// When the file cannot be read, or is not a valid asset.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(Self::new(htex_format::Asset::open(path.as_ref())?).with_embedded())
    }

    /// Opens an asset in memory. The embedded and the built-in models can play it.
    ///
    /// # Errors
    /// When the bytes are not a valid asset.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        Ok(Self::new(htex_format::Asset::from_bytes(bytes)?).with_embedded())
    }

    /// Opens a texture in a library. The embedded and the built-in models can play it.
    ///
    /// ```no_run
    /// let library = htex::Library::open("cloth.htexlib".as_ref())?;
    /// let asset = htex::Texture::from_library(&library, "woven/cotton")?;
    /// # Ok::<(), htex::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the library has no texture with this name, cannot be read, or stores an invalid asset
    /// for it.
    #[cfg(feature = "library")]
    pub fn from_library<S: htex_format::library::LibrarySource>(
        library: &htex_format::library::Library<S>,
        name: &str,
    ) -> Result<Self, Error> {
        Self::from_bytes(&library.get(name)?)
    }

    /// Makes an asset from its data. The built-in models can play it.
    pub fn new(data: htex_format::Asset) -> Self {
        Self::with_registry(data, Registry::builtin())
    }

    /// Makes an asset from its data. The models in `registry` can play it.
    pub fn with_registry(data: htex_format::Asset, registry: Registry) -> Self {
        let models = data.manifest.representations.iter();
        Self {
            models: models.map(|_| OnceLock::new()).collect(),
            data: Arc::new(data),
            registry: registry.of_asset(),
            embedded: false,
        }
    }

    /// Allows embedded models to run, in a sandbox. An embedded model takes precedence over the
    /// models of the registry, unless a plugin that was named by its file can play the
    /// representation ([`model_of`]). An embedded model is loaded when a representation with its id
    /// is first used. That use returns an error if the module cannot be loaded, or if its id or
    /// version is not the declared one.
    #[must_use]
    pub fn with_embedded(mut self) -> Self {
        self.embedded = true;
        self.models = self.models.iter().map(|_| OnceLock::new()).collect();
        self
    }

    /// Loads the embedded model with this id.
    ///
    /// # Errors
    /// When the asset embeds no model with this id, when the model cannot be loaded, or when its id
    /// or version is not the declared one.
    pub fn load_embedded(&self, id: &str) -> Result<(), Error> {
        if self.embeds(id) {
            self.registry_with(id).map(drop)
        } else {
            Err(Error::NoEmbeddedModel { id: id.to_owned() })
        }
    }

    /// Returns whether the asset embeds a model with this id.
    fn embeds(&self, id: &str) -> bool {
        self.data.manifest.plugins.iter().any(|p| p.model == id)
    }

    /// Returns the registry, with the embedded model of this id added if there is one.
    fn registry_with(&self, id: &str) -> Result<Registry, Error> {
        let mut registry = self.registry.clone();
        let plugins = self.data.manifest.plugins.iter().zip(&self.data.plugins);
        for (plugin, module) in plugins.filter(|(plugin, _)| plugin.model == id) {
            let declared = (&plugin.model[..], &plugin.version[..]);
            registry.add_declared_wasm(&plugin.file, module, declared)?;
        }
        Ok(registry)
    }

    /// Returns whether there is a model with this id that can play the asset's representation.
    /// Loads no model.
    pub fn knows_model(&self, id: &str) -> bool {
        let stored = self.data.manifest.representations.iter();
        stored.filter(|r| r.model == id).any(|r| self.is_runnable(r))
    }

    /// Returns the data of the file.
    pub fn data(&self) -> &htex_format::Asset {
        &self.data
    }

    /// Returns the manifest.
    pub fn manifest(&self) -> &Manifest {
        &self.data.manifest
    }

    /// Returns the physical quantity of the samples, which determines their unit: newtons for a
    /// lateral force, m/s² for an acceleration.
    pub fn quantity(&self) -> Quantity {
        self.data.manifest.quantity
    }

    /// Returns the models that can play the asset, without the embedded ones.
    pub fn registry(&self) -> &Registry {
        &self.registry
    }

    /// Returns the asset's frequency band.
    pub fn band(&self) -> Band {
        self.data.manifest.band
    }

    /// Makes a voice, which plays the texture.
    ///
    /// # Errors
    /// When there is no such representation, when its model is missing or incompatible or refuses
    /// the parameters, when the sample rate is below twice the highest frequency of the texture, or
    /// when another option is out of range.
    pub fn voice(&self, options: &VoiceOptions<'_>) -> Result<Voice, Error> {
        self.check_rate(options.rate_hz)?;
        let ceiling = options.ceiling;
        if !(ceiling > 0.0 && ceiling.is_finite()) {
            return Err(Error::Ceiling { ceiling });
        }
        let still = self.still(options)?;
        let base = self.base_ratio(options)?;
        // The voice reads the source at `base` times its speed, so the source can run at a lower
        // rate.
        let source =
            self.source(&VoiceOptions { rate_hz: options.rate_hz / base, ..options.clone() })?;
        Voice::new(source, still, options, base)
    }

    /// Refuses a sample rate that is too low for the texture's frequencies.
    fn check_rate(&self, rate_hz: f64) -> Result<(), Error> {
        let least_hz = 2.0 * self.band().high_hz;
        if (least_hz..=MOST_RATE_HZ).contains(&rate_hz) {
            Ok(())
        } else {
            Err(Error::Rate { rate_hz, least_hz })
        }
    }

    /// Returns the initial reading speed of a voice, as a multiple of the recorded speed.
    fn base_ratio(&self, options: &VoiceOptions<'_>) -> Result<f64, Error> {
        let Some(motion) = options.motion else {
            return Ok(1.0);
        };
        let motion = motion.checked()?;
        let r = self.representation(options.model)?;
        let streamed = options.synthesis == Synthesis::Streamed;
        let follows = streamed && self.model(r)?.follows_motion();
        let slides = crate::exploration::slides(motion.speed_mm_s, motion.force_n);
        let scales = options.effects.frequency_scaling && slides && !follows;
        Ok(if scales && motion.is_plausible() {
            self.motions_of(r)?.scaling(motion, options.ceiling).frequency
        } else {
            1.0
        })
    }

    /// Returns the motions at which a representation was recorded. Loads no model.
    ///
    /// # Errors
    /// When there is no such representation, or its stored triangles are invalid.
    pub fn motions(&self, model: Option<&str>) -> Result<Motions, Error> {
        self.motions_of(self.representation(model)?)
    }

    /// Makes the pre-rendered sound of a voice; `None` if the voice is streamed.
    fn still(&self, options: &VoiceOptions<'_>) -> Result<Option<StillSound>, Error> {
        if options.synthesis == Synthesis::Streamed {
            return Ok(None);
        }
        let (parameters, _) = self.parameters(options.model, options.motion)?;
        Ok(StillSound::new(
            options.synthesis,
            &self.model(self.representation(options.model)?)?,
            &parameters,
            self.band(),
            options.rate_hz,
            options.seed,
        )?)
    }

    /// Makes the source of a voice: samples of unit RMS without the level, at the rate that the
    /// model chooses for a player at `options.rate_hz`.
    ///
    /// # Errors
    /// As [`Self::voice`].
    pub fn source(&self, options: &VoiceOptions<'_>) -> Result<SampleSource, Error> {
        let r = self.representation(options.model)?;
        let motion = options.motion.unwrap_or_else(|| self.start(r));
        let model = self.model(r)?;
        let known = self.known(r, &model)?;
        SampleSource::new(known, model, self.band(), options.rate_hz, options.seed, motion)
    }

    /// Returns the magnitudes that a long recording of the voice would show at a motion, or at the
    /// default condition if `motion` is `None`. Frequencies are in hertz, magnitudes in the asset's
    /// unit. Outside the recorded conditions the asset's law applies; where the finger does not
    /// slide the magnitudes are 0. If the law scales all frequencies by a ratio r, a noise of
    /// magnitude m(f) has the magnitude `m(f / r) / sqrt(r)`, and a sum of sinusoids `m(f / r)`.
    ///
    /// # Errors
    /// As [`Self::voice`].
    pub fn magnitude(
        &self,
        model: Option<&str>,
        motion: Option<Motion>,
        frequency_hz: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let loaded = self.loaded_model(model)?;
        let ratio = match self.scaling(model, motion)? {
            None => return Ok(vec![0.0; frequency_hz.len()]),
            Some(scaling) => scaling.frequency,
        };
        let level_rms = self.level_rms(model, motion)?;
        let (parameters, _) = self.parameters(model, motion)?;
        scaled_magnitude(&loaded, &parameters, self.band(), frequency_hz, ratio, level_rms)
    }

    /// Returns the level of a voice at a motion, or at the default condition if `motion` is `None`:
    /// the RMS in the asset's unit. Outside the recorded conditions the asset's law applies; where
    /// the finger does not slide the level is 0.
    ///
    /// # Errors
    /// As [`Self::voice`].
    pub fn level_rms(&self, model: Option<&str>, motion: Option<Motion>) -> Result<f64, Error> {
        let Some(scaling) = self.scaling(model, motion)? else {
            return Ok(0.0);
        };
        let (_, level_rms) = self.parameters(model, motion)?;
        Ok(level_rms * scaling.level)
    }

    /// Returns the factors that scale a representation's frequencies and level at a motion; `None`
    /// where the finger does not slide.
    fn scaling(
        &self,
        model: Option<&str>,
        motion: Option<Motion>,
    ) -> Result<Option<Scaling>, Error> {
        let r = self.representation(model)?;
        let Some(motion) = motion.filter(|_| !self.follows(r)) else {
            return Ok(Some(Scaling::NONE));
        };
        let motion = motion.checked()?;
        let slides = crate::exploration::slides(motion.speed_mm_s, motion.force_n);
        let motions = self.motions_of(r)?;
        Ok(slides.then(|| motions.scaling(motion, CEILING)))
    }

    /// Returns whether a representation's model follows the motion itself.
    fn follows(&self, representation: usize) -> bool {
        let model = self.model(representation);
        model.is_ok_and(|model| model.follows_motion())
    }

    /// Returns the magnitudes at a motion as they were recorded, or interpolated between
    /// recordings. Unlike [`Self::magnitude`], it does not apply the asset's law, and it also
    /// returns magnitudes where the finger does not slide.
    ///
    /// # Errors
    /// As [`Self::voice`].
    pub fn recorded_magnitude(
        &self,
        model: Option<&str>,
        motion: Option<Motion>,
        frequency_hz: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let (parameters, level_rms) = self.parameters(model, motion)?;
        let model = self.loaded_model(model)?;
        let shape = model.magnitude(&parameters, self.band(), frequency_hz)?;
        Ok(shape.iter().map(|m| m * level_rms).collect())
    }

    /// Returns the model of a representation. `model` is its id or short name; `None` selects the
    /// best representation.
    ///
    /// # Errors
    /// As [`Self::voice`].
    pub fn loaded_model(&self, model: Option<&str>) -> Result<LoadedModel, Error> {
        self.model(self.representation(model)?)
    }

    /// Returns the full model id of a representation. `model` is its id or short name; `None`
    /// selects the best representation.
    ///
    /// # Errors
    /// When there is no such representation.
    pub fn representation_id(&self, model: Option<&str>) -> Result<&str, Error> {
        let r = self.representation(model)?;
        Ok(&self.data.manifest.representations[r].model)
    }

    /// Returns the parameters (a flat array) and the level (RMS, in the asset's unit) of a
    /// representation at a motion, as recorded or interpolated between recordings. Without a motion
    /// they are those at the default condition.
    ///
    /// # Errors
    /// As [`Self::voice`].
    pub fn parameters(
        &self,
        model: Option<&str>,
        motion: Option<Motion>,
    ) -> Result<(Vec<f64>, f64), Error> {
        let r = self.representation(model)?;
        let motion = motion.unwrap_or_else(|| self.start(r)).checked()?;
        let model = self.model(r)?;
        let known = self.known(r, &model)?;
        let located = known.motions.locate(motion);
        Ok((known.at(&model, &located)?, located.level_rms))
    }

    /// Returns the same parameters as [`Self::parameters`], with the names of the model's fields.
    ///
    /// ```no_run
    /// let asset = htex::Texture::open("sandpaper.htex")?;
    /// for (name, parameter) in asset.named_parameters(Some("sbeta"), None)? {
    ///     println!("{name}: {parameter:?}");
    /// }
    /// # Ok::<(), htex::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Self::voice`].
    pub fn named_parameters(
        &self,
        model: Option<&str>,
        motion: Option<Motion>,
    ) -> Result<Vec<(String, Parameter)>, Error> {
        let (flat, _) = self.parameters(model, motion)?;
        Ok(named(&self.loaded_model(model)?.descriptor().fields, flat))
    }

    /// Returns the indices of the representations from the best to the worst. Those that this
    /// program can run come first. Among them, those with a measured error come first, and then the
    /// smaller [`Representation::error_db`]. Ties keep the order of the file.
    ///
    /// ```no_run
    /// let asset = htex::Texture::open("sandpaper.htex")?;
    /// for i in asset.ranked(htex::ErrorMeasure::NineBand) {
    ///     println!("{}", asset.manifest().representations[i].model);
    /// }
    /// # Ok::<(), htex::Error>(())
    /// ```
    pub fn ranked(&self, measure: ErrorMeasure) -> Vec<usize> {
        let all = &self.data.manifest.representations;
        let is_runnable = |i: &usize| self.is_runnable(&all[*i]);
        let (mut ranked, others): (Vec<_>, Vec<_>) =
            self.by_error(measure).into_iter().partition(is_runnable);
        ranked.extend(others);
        ranked
    }

    /// Returns the indices of the representations, those with a measured error first and by it.
    fn by_error(&self, measure: ErrorMeasure) -> Vec<usize> {
        let all = &self.data.manifest.representations;
        let mut sorted: Vec<_> =
            all.iter().map(|stored| stored.error_db(measure)).enumerate().collect();
        sorted.sort_by(|(_, a), (_, b)| {
            let order = |error: &Option<f64>| (error.is_none(), error.unwrap_or_default());
            let (a, b) = (order(a), order(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        sorted.into_iter().map(|(i, _)| i).collect()
    }

    /// Returns the first of [`Self::ranked`]. Asks whether a model is there only as often as
    /// needed, since that takes longer than the rest of the choice.
    fn best(&self, measure: ErrorMeasure) -> Option<usize> {
        let all = &self.data.manifest.representations;
        let sorted = self.by_error(measure);
        let runnable = sorted.iter().find(|i| self.is_runnable(&all[**i]));
        runnable.or(sorted.first()).copied()
    }

    /// Returns the index of a representation by its model's id or short name; `None` selects the
    /// best.
    fn representation(&self, model: Option<&str>) -> Result<usize, Error> {
        let all = &self.data.manifest.representations;
        let found = match model {
            Some(name) => all.iter().position(|r| is_named(r, name)),
            None => self.best(ErrorMeasure::NineBand),
        };
        found.ok_or_else(|| Error::NoRepresentation {
            wanted: model.unwrap_or("any").to_owned(),
            there: all.iter().map(|r| r.model.as_str()).collect::<Vec<_>>().join(", "),
        })
    }

    fn model(&self, representation: usize) -> Result<LoadedModel, Error> {
        let kept = &self.models[representation];
        if let Some(model) = kept.get() {
            return Ok(model.clone());
        }
        let stored = &self.data.manifest.representations[representation];
        let model = if self.may_run_embedded(&stored.model) {
            model_of(&self.registry_with(&stored.model)?, stored)?.clone()
        } else {
            self.installed(stored)?
        };
        Ok(kept.get_or_init(|| model).clone())
    }

    /// Returns whether the embedded model with this id may run; always false in a program without a
    /// sandbox.
    fn may_run_embedded(&self, id: &str) -> bool {
        RUNS_WASM && self.embedded && self.embeds(id)
    }

    /// Returns whether this program has a model that can play a representation. Loads no model.
    fn is_runnable(&self, stored: &Representation) -> bool {
        self.may_run_embedded(&stored.model) || self.installed(stored).is_ok()
    }

    /// Returns the model of a representation from the registry, ignoring embedded models.
    fn installed(&self, stored: &Representation) -> Result<LoadedModel, Error> {
        let id = &stored.model;
        let found = model_of(&self.registry, stored);
        match found.and_then(|model| field_order(stored, model).map(|_| model)) {
            // A program without a sandbox gets the error that says how to get one.
            Err(Error::Model(HostError::UnknownModel { .. }))
                if self.embeds(id) && self.embedded =>
            {
                self.registry_with(id)?.find(id).cloned().map_err(Error::from)
            }
            Err(Error::Model(HostError::UnknownModel { .. })) if self.embeds(id) => {
                Err(Error::EmbeddedOff { id: id.clone() })
            }
            Err(Error::ModelOlder { model, asset, installed, problem, .. }) => {
                Err(Error::ModelOlder {
                    embedded: self.embeds(id) && !self.embedded,
                    model,
                    asset,
                    installed,
                    problem,
                })
            }
            found => found.cloned(),
        }
    }

    /// Returns the recorded conditions of a representation, with its parameters reordered to the
    /// model's fields.
    fn known(&self, representation: usize, model: &LoadedModel) -> Result<Known, Error> {
        let manifest = &self.data.manifest;
        let stored = &manifest.representations[representation];
        let order = field_order(stored, model)?;
        let sets = self.data.parameters[representation].iter();
        let parameters: Result<_, _> = sets.map(|flat| order.arrange(flat)).collect();
        Ok(Known {
            motions: self.motions_of(representation)?,
            parameters: parameters.map_err(|error| Error::Fields {
                model: stored.model.clone(),
                problem: error.to_string(),
            })?,
        })
    }

    fn motions_of(&self, representation: usize) -> Result<Motions, Error> {
        let manifest = &self.data.manifest;
        let stored = &manifest.representations[representation];
        let motions = Motions::of(stored, &manifest.conditions, manifest.law());
        motions.map_err(|error| Error::Triangles { model: stored.model.clone(), error })
    }

    /// Returns the index of the condition at which a representation is played when no motion is
    /// given: its first condition, or its strongest if the first is silent ([`default_condition`]).
    /// `model` is the id or short name; `None` selects the best representation. Loads no model.
    ///
    /// # Errors
    /// When there is no such representation.
    pub fn default_condition(&self, model: Option<&str>) -> Result<usize, Error> {
        Ok(self.default_of(self.representation(model)?))
    }

    /// Returns a motion with a speed in mm/s and a force in newtons. A missing value is taken from
    /// [`Self::default_condition`]; if that condition does not state it, it is 80 mm/s or 0.4 N.
    ///
    /// ```no_run
    /// let asset = htex::Texture::open("sandpaper.htex")?;
    /// let faster = asset.motion(None, Some(160.0), None)?; // at the force of the default condition
    /// # Ok::<(), htex::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Self::default_condition`].
    pub fn motion(
        &self,
        model: Option<&str>,
        speed_mm_s: Option<f64>,
        force_n: Option<f64>,
    ) -> Result<Motion, Error> {
        let default = self.condition(self.default_condition(model)?);
        let (usual_mm_s, usual_n) = USUAL;
        Ok(Motion::new(
            speed_mm_s.or(default.speed_mm_s).unwrap_or(usual_mm_s),
            force_n.or(default.force_n).unwrap_or(usual_n),
        ))
    }

    fn default_of(&self, representation: usize) -> usize {
        let manifest = &self.data.manifest;
        let stored = &manifest.representations[representation];
        let at = stored.at.get(default_condition(stored, &manifest.conditions));
        at.map_or(0, |at| at.condition)
    }

    fn condition(&self, index: usize) -> Condition {
        let condition = self.data.manifest.conditions.get(index);
        condition.copied().unwrap_or_default()
    }

    /// Returns the motion of the default condition. A value that it does not state is 0, as in the
    /// mesh.
    fn start(&self, representation: usize) -> Motion {
        let default = self.condition(self.default_of(representation));
        let [speed_mm_s, force_n] =
            [default.speed_mm_s, default.force_n].map(Option::unwrap_or_default);
        Motion::new(speed_mm_s, force_n)
    }
}

fn is_named(representation: &Representation, name: &str) -> bool {
    let id = &representation.model;
    id == name || id.rsplit('.').next().is_some_and(|short| short.eq_ignore_ascii_case(name))
}
