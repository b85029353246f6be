//! An asset with the models that can play it.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use htex_format::{Manifest, Quantity, Representation};
use htex_host::{Band, HostError, LoadedModel, RUNS_WASM, Registry, StillSound, Synthesis};

use crate::exploration::Explored;
use crate::known::{Known, Motions};
use crate::mesh::Mesh;
use crate::playable::{field_order, model_of};
use crate::{Error, Motion, Source, Voice, VoiceOptions};

/// An opened texture. A clone shares the data of the file.
///
/// ```no_run
/// let asset = htex::Asset::open("sandpaper.htex")?;
/// println!("{} in {}", asset.manifest().name, asset.quantity().unit());
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Asset {
    data: Arc<htex_format::Asset>,
    registry: Registry,
    /// Whether the models that the asset brings along may run.
    embedded: bool,
    /// The model of each representation, once it was wanted.
    models: Arc<[OnceLock<LoadedModel>]>,
}

impl Asset {
    /// Opens a file, to be played by the models it brings along and the built-in ones.
    ///
    /// # Errors
    /// When the file cannot be read, or is not a valid asset.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(Self::new(htex_format::Asset::open(path.as_ref())?).with_embedded())
    }

    /// Opens an asset in memory.
    ///
    /// # Errors
    /// When the bytes are not a valid asset.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        Ok(Self::new(htex_format::Asset::from_bytes(bytes)?).with_embedded())
    }

    /// Takes an asset that is already read, to be played by the built-in models.
    pub fn new(data: htex_format::Asset) -> Self {
        Self::with_registry(data, Registry::builtin())
    }

    /// Takes an asset that is already read, to be played by the models of `registry`.
    pub fn with_registry(data: htex_format::Asset, registry: Registry) -> Self {
        let models = data.manifest.representations.iter();
        Self {
            models: models.map(|_| OnceLock::new()).collect(),
            data: Arc::new(data),
            registry: registry.of_asset(),
            embedded: false,
        }
    }

    /// Lets the models run that the asset brings along, in their sandbox, before those of its registry (but behind plugins
    /// named by their files). One is loaded when a representation of its id is wanted first, and what cannot be loaded, or
    /// is of another model or version than the asset says, is an error there. Without this call they are not run.
    #[must_use]
    pub fn with_embedded(mut self) -> Self {
        self.embedded = true;
        self.models = self.models.iter().map(|_| OnceLock::new()).collect();
        self
    }

    /// Loads a model that the asset brings along, by its id.
    ///
    /// # Errors
    /// When the asset brings none of this id, when it cannot be loaded, or is of another model or version than the asset
    /// says.
    pub fn load_embedded(&self, id: &str) -> Result<(), Error> {
        if self.brings(id) {
            self.registry_with(id).map(drop)
        } else {
            Err(Error::NoEmbeddedModel { id: id.to_owned() })
        }
    }

    /// Whether the asset brings along a model of this id.
    fn brings(&self, id: &str) -> bool {
        self.data.manifest.plugins.iter().any(|p| p.model == id)
    }

    /// The registry, and in it the model of this id that the asset brings along, if it does.
    fn registry_with(&self, id: &str) -> Result<Registry, Error> {
        let mut registry = self.registry.clone();
        let plugins = self.data.manifest.plugins.iter().zip(&self.data.plugins);
        for (plugin, module) in plugins.filter(|(plugin, _)| plugin.model == id) {
            let declared = (&plugin.model[..], &plugin.version[..]);
            registry.add_declared_wasm(&plugin.file, module, declared)?;
        }
        Ok(registry)
    }

    /// Whether there is a model of this id that could play a representation; none is loaded.
    pub fn knows_model(&self, id: &str) -> bool {
        self.embedded && self.brings(id) || self.registry.find(id).is_ok()
    }

    /// What the asset says of itself.
    pub fn manifest(&self) -> &Manifest {
        &self.data.manifest
    }

    /// What its samples are, and so their unit: a lateral force in newtons, an acceleration in m/s².
    pub fn quantity(&self) -> Quantity {
        self.data.manifest.quantity
    }

    /// The models that can play it, without those it brings along.
    pub fn registry(&self) -> &Registry {
        &self.registry
    }

    /// The asset's band.
    pub fn band(&self) -> Band {
        let band = self.data.manifest.band;
        Band {
            low_hz: band.low_hz,
            high_hz: band.high_hz,
        }
    }

    /// Makes a voice.
    ///
    /// # Errors
    /// When there is no such representation, its model is not there or not compatible, or it
    /// refuses the parameters or the rate; when the synthesis is out of its range.
    pub fn voice(&self, options: &VoiceOptions<'_>) -> Result<Voice, Error> {
        let still = self.still(options)?;
        let base = self.base_ratio(options)?;
        // Read faster, the source's samples come at a higher rate: one that renders at any rate is asked for less.
        let source = self.source(&VoiceOptions {
            rate_hz: options.rate_hz / base,
            ..options.clone()
        })?;
        Voice::new(source, still, options, base)
    }

    /// How many times as fast as recorded a voice is read from its start on.
    fn base_ratio(&self, options: &VoiceOptions<'_>) -> Result<f64, Error> {
        let Some(motion) = options.motion else {
            return Ok(1.0);
        };
        let Motion {
            speed_mm_s,
            force_n,
            ..
        } = motion.checked()?;
        let r = self.representation(options.model)?;
        let streamed = options.synthesis == Synthesis::Streamed;
        let follows = streamed && self.model(r)?.follows_motion();
        let slides = crate::exploration::slides(speed_mm_s, force_n);
        let scales = options.effects.speed_scaling && slides && !follows;
        let explored = self.explored(r);
        Ok(if scales {
            explored.speed_ratio(speed_mm_s)
        } else {
            1.0
        })
    }

    /// The motions that a representation was recorded at. No model is loaded.
    ///
    /// # Errors
    /// When there is no such representation.
    pub fn motions(&self, model: Option<&str>) -> Result<Motions, Error> {
        Ok(self.motions_of(self.representation(model)?))
    }

    /// The sound of a voice that is not streamed.
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

    /// Makes the source of a voice: the shape alone, at the model's own rate for a listener at
    /// `options.rate_hz`.
    ///
    /// # Errors
    /// As [`Self::voice`].
    pub fn source(&self, options: &VoiceOptions<'_>) -> Result<Source, Error> {
        let r = self.representation(options.model)?;
        let motion = options.motion.unwrap_or_else(|| self.first_condition(r));
        let model = self.model(r)?;
        let known = self.known(r, &model)?;
        Source::new(
            known,
            model,
            self.band(),
            options.rate_hz,
            options.seed,
            motion,
        )
    }

    /// Magnitudes of a representation at a motion (else its first condition) and frequencies in
    /// hertz; in the asset's unit, in the measure of the texture spectrum. As recorded, or interpolated: what a voice makes of a
    /// motion beyond that ([`Self::motions`]) is not in it.
    ///
    /// # Errors
    /// As [`Self::voice`].
    pub fn magnitude(
        &self,
        model: Option<&str>,
        motion: Option<Motion>,
        frequency_hz: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let (parameters, level_rms) = self.parameters(model, motion)?;
        let model = self.model(self.representation(model)?)?;
        let shape = model.magnitude(&parameters, self.band(), frequency_hz)?;
        Ok(shape.iter().map(|m| m * level_rms).collect())
    }

    /// The model that plays a representation, named by its id or short name, else the best.
    ///
    /// # Errors
    /// As [`Self::voice`].
    pub fn loaded_model(&self, model: Option<&str>) -> Result<LoadedModel, Error> {
        self.model(self.representation(model)?)
    }

    /// The full id of the model of a representation named by it or by its short name, else of the
    /// best.
    ///
    /// # Errors
    /// When there is no such representation.
    pub fn representation_id(&self, model: Option<&str>) -> Result<&str, Error> {
        let r = self.representation(model)?;
        Ok(&self.data.manifest.representations[r].model)
    }

    /// Parameters (the flat array) and level (RMS, in the asset's unit) of a representation at a motion, else
    /// at its first condition.
    ///
    /// # Errors
    /// As [`Self::voice`].
    pub fn parameters(
        &self,
        model: Option<&str>,
        motion: Option<Motion>,
    ) -> Result<(Vec<f64>, f64), Error> {
        let r = self.representation(model)?;
        let motion = motion
            .unwrap_or_else(|| self.first_condition(r))
            .checked()?;
        let model = self.model(r)?;
        self.known(r, &model)?.at(&model, motion)
    }

    /// The index of a representation by its model's id or short name, else of the best.
    fn representation(&self, model: Option<&str>) -> Result<usize, Error> {
        let all = &self.data.manifest.representations;
        let found = match model {
            Some(name) => all.iter().position(|r| is_named(r, name)),
            None => nearest(all, |r| self.is_runnable(&r.model)),
        };
        found.ok_or_else(|| Error::NoRepresentation {
            wanted: model.unwrap_or("any").to_owned(),
            there: all
                .iter()
                .map(|r| r.model.as_str())
                .collect::<Vec<_>>()
                .join(", "),
        })
    }

    fn model(&self, representation: usize) -> Result<LoadedModel, Error> {
        let kept = &self.models[representation];
        if let Some(model) = kept.get() {
            return Ok(model.clone());
        }
        let stored = &self.data.manifest.representations[representation];
        let model = match self.runs_embedded(&stored.model) {
            true => model_of(&self.registry_with(&stored.model)?, stored)?.clone(),
            false => self.installed(stored)?,
        };
        Ok(kept.get_or_init(|| model).clone())
    }

    /// Whether a model of this id is taken from the asset. A program without a sandbox takes its own, if it has one.
    fn runs_embedded(&self, id: &str) -> bool {
        self.embedded && (RUNS_WASM || self.registry.find(id).is_err())
    }

    /// Whether this program has what it takes to run a model of this id; none is loaded.
    fn is_runnable(&self, id: &str) -> bool {
        RUNS_WASM || self.registry.find(id).is_ok()
    }

    /// The model of a representation from the registry alone.
    fn installed(&self, stored: &Representation) -> Result<LoadedModel, Error> {
        let id = &stored.model;
        match model_of(&self.registry, stored) {
            Err(Error::Model(HostError::UnknownModel { .. })) if self.brings(id) => {
                Err(Error::EmbeddedOff { id: id.clone() })
            }
            found => found.cloned(),
        }
    }

    /// What the asset knows of a representation, its parameters in the order of the model's fields.
    fn known(&self, representation: usize, model: &LoadedModel) -> Result<Known, Error> {
        let manifest = &self.data.manifest;
        let stored = &manifest.representations[representation];
        let order = field_order(stored, model)?;
        let sets = self.data.parameters[representation].iter();
        let parameters: Result<_, _> = sets.map(|flat| order.arrange(flat)).collect();
        Ok(Known {
            motions: self.motions_of(representation),
            level_rms: stored.at.iter().map(|a| a.level_rms).collect(),
            parameters: parameters.map_err(|error| Error::Fields {
                model: stored.model.clone(),
                problem: error.to_string(),
            })?,
        })
    }

    fn motions_of(&self, representation: usize) -> Motions {
        let manifest = &self.data.manifest;
        let at = &manifest.representations[representation].at;
        let point = |condition: usize| {
            let condition = &manifest.conditions[condition];
            [
                condition.speed_mm_s.unwrap_or(0.0),
                condition.force_n.unwrap_or(0.0),
            ]
        };
        let points: Vec<[f64; 2]> = at.iter().map(|a| point(a.condition)).collect();
        Motions {
            mesh: Mesh::new(&points),
            explored: self.explored(representation),
        }
    }

    fn explored(&self, representation: usize) -> Explored {
        let manifest = &self.data.manifest;
        let at = &manifest.representations[representation].at;
        Explored::new(at, &manifest.conditions)
    }

    fn first_condition(&self, representation: usize) -> Motion {
        let manifest = &self.data.manifest;
        let first = manifest.representations[representation].at.first();
        let condition = first.and_then(|at| manifest.conditions.get(at.condition));
        condition.map_or(Motion::new(0.0, 0.0), |c| {
            Motion::new(c.speed_mm_s.unwrap_or(0.0), c.force_n.unwrap_or(0.0))
        })
    }
}

fn is_named(representation: &Representation, name: &str) -> bool {
    let id = &representation.model;
    id == name
        || id
            .rsplit('.')
            .next()
            .is_some_and(|short| short.eq_ignore_ascii_case(name))
}

/// The representation of least nine-band error at its first condition; unmeasured ones come last, and those of models
/// that this program cannot run behind them.
fn nearest(all: &[Representation], runnable: impl Fn(&Representation) -> bool) -> Option<usize> {
    let error = |r: &Representation| {
        let quality = r.at.first().and_then(|at| at.quality.as_ref());
        quality.map_or(f64::INFINITY, |q| q.band_error_rms_db)
    };
    let order = |i: usize| (!runnable(&all[i]), error(&all[i]));
    (0..all.len()).min_by(|&a, &b| {
        let (a, b) = (order(a), order(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    })
}
