//! An asset and the models that can play it.
//!
//! A model is loaded when one of its representations is first used. Therefore, validating, listing
//! or inspecting an asset runs no model.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use htex_format::signing::Signers;
use htex_format::{ErrorMeasure, Manifest, Quantity};
use htex_host::{Band, HostError, LoadedModel, RUNS_WASM, Registry};

use crate::playable::{field_order, model_of};
use crate::{Error, Motion, Representation, Voice, VoiceOptions};

/// An opened texture. Its clones share the data of the file.
///
/// ```no_run
/// let texture = htex::Texture::open("sandpaper.htex")?;
/// println!("{} in {}", texture.manifest().name, texture.quantity().unit());
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
    /// Opens a file. The embedded and the built-in models can play the texture.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or is not a valid asset.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(Self::new(htex_format::Asset::open(path.as_ref())?).with_embedded())
    }

    /// Opens an asset in memory. The embedded and the built-in models can play the texture.
    ///
    /// # Errors
    /// Returns an error if the bytes are not a valid asset.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        Ok(Self::new(htex_format::Asset::from_bytes(bytes)?).with_embedded())
    }

    /// Opens a file, if one of `signers` signed it. The signature of `oak.htex` is in
    /// `oak.htex.sig`; a texture of a library is signed if its library is.
    ///
    /// ```no_run
    /// use htex::format::signing::Signers;
    /// let key = "00474ae0c6af07224d0a4250b8a3c82cc7c6e1a9e0e27bce347f01a6bd229caa".parse()?;
    /// let texture = htex::Texture::open_signed("sandpaper.htex", &Signers::new([key]))?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns the errors of [`Self::open`], and an error if none of `signers` signed the file.
    pub fn open_signed(path: impl AsRef<Path>, signers: &Signers) -> Result<Self, Error> {
        let data = htex_format::Asset::open_signed(path.as_ref(), signers)?;
        Ok(Self::new(data).with_embedded())
    }

    /// Opens an asset in memory, if one of `signers` signed it. `signature` is the contents of the
    /// file with its signature.
    ///
    /// # Errors
    /// Returns the errors of [`Self::from_bytes`], and an error if none of `signers` signed the asset.
    pub fn from_signed_bytes(
        bytes: &[u8],
        signature: &[u8],
        signers: &Signers,
    ) -> Result<Self, Error> {
        let data = htex_format::Asset::from_signed_bytes(bytes, Some(signature), signers)?;
        Ok(Self::new(data).with_embedded())
    }

    /// Opens a texture in a library, if one of `signers` signed the library. `signature` is the
    /// contents of the file with the library's signature. The first call for a library reads its
    /// whole index.
    ///
    /// # Errors
    /// Returns the errors of [`Self::from_library`], and an error if none of `signers` signed the
    /// library.
    #[cfg(feature = "library")]
    pub fn from_signed_library<S: htex_format::library::LibrarySource>(
        library: &htex_format::library::Library<S>,
        name: &str,
        signature: &[u8],
        signers: &Signers,
    ) -> Result<Self, Error> {
        library.check_signed(Some(signature), signers)?;
        Self::from_library(library, name)
    }

    /// Opens a texture in a library. The embedded and the built-in models can play the texture.
    ///
    /// ```no_run
    /// let library = htex::library::Library::open("cloth.htexlib".as_ref())?;
    /// let texture = htex::Texture::from_library(&library, "woven/cotton")?;
    /// # Ok::<(), htex::Error>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the library has no texture with this name, cannot be read, or stores an
    /// invalid asset for it.
    #[cfg(feature = "library")]
    pub fn from_library<S: htex_format::library::LibrarySource>(
        library: &htex_format::library::Library<S>,
        name: &str,
    ) -> Result<Self, Error> {
        Self::from_bytes(&library.get(name)?)
    }

    /// Makes a texture from the data of an asset. The built-in models can play the texture.
    pub fn new(data: htex_format::Asset) -> Self {
        Self::with_registry(data, Registry::builtin())
    }

    /// Makes a texture from the data of an asset. The models in `registry` can play the texture.
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
    /// models of the registry. There is one exception: a plugin that the user loaded by its file
    /// name takes precedence over the embedded model if the plugin can play the representation
    /// ([`model_of`]). An embedded model is loaded when a representation that names the model's id
    /// is first used. This first use returns an error if the model cannot be loaded, or if its id
    /// or version differs from the id or version that the asset declares.
    #[must_use]
    pub fn with_embedded(mut self) -> Self {
        self.embedded = true;
        self.models = self.models.iter().map(|_| OnceLock::new()).collect();
        self
    }

    /// Loads the embedded model with this id.
    ///
    /// # Errors
    /// Returns an error if the asset embeds no model with this id, or if the model cannot be
    /// loaded. Also returns an error if the model's id or version differs from the id or version
    /// that the asset declares.
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

    /// Returns the registry, and adds the embedded model of this id if there is one.
    fn registry_with(&self, id: &str) -> Result<Registry, Error> {
        let mut registry = self.registry.clone();
        let plugins = self.data.manifest.plugins.iter().zip(&self.data.plugins);
        for (plugin, module) in plugins.filter(|(plugin, _)| plugin.model == id) {
            let declared = (&plugin.model[..], &plugin.version[..]);
            registry.add_declared_wasm(&plugin.file, module, declared)?;
        }
        Ok(registry)
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

    /// Returns the models that can play the asset, except embedded models.
    pub fn registry(&self) -> &Registry {
        &self.registry
    }

    /// Returns the asset's frequency band.
    pub fn band(&self) -> Band {
        self.data.manifest.band
    }

    /// Returns a representation by the id or the short name of its model, such as `"bands"`. `None`
    /// selects the best representation: the first that [`Self::ranked`] returns for the nine-band
    /// error.
    ///
    /// ```no_run
    /// let texture = htex::Texture::open("sandpaper.htex")?;
    /// let bands = texture.representation("bands")?;
    /// println!("{} RMS", bands.level_rms(None)?);
    /// # Ok::<(), htex::Error>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the texture has no representation for this model.
    pub fn representation<'a>(
        &self,
        model: impl Into<Option<&'a str>>,
    ) -> Result<Representation<'_>, Error> {
        let model = model.into();
        let all = &self.data.manifest.representations;
        let found = match model {
            Some(name) => all.iter().position(|r| is_named(r, name)),
            None => self.best(ErrorMeasure::NineBand),
        };
        let index = found.ok_or_else(|| Error::NoRepresentation {
            wanted: model.unwrap_or("any").to_owned(),
            there: all.iter().map(|r| r.model.as_str()).collect::<Vec<_>>().join(", "),
        })?;
        Ok(Representation::new(self, index))
    }

    /// Makes a voice of the best representation. For another representation, use
    /// [`Self::representation`].
    ///
    /// # Errors
    /// Returns the same errors as [`Representation::voice`].
    pub fn voice(&self, options: &VoiceOptions) -> Result<Voice, Error> {
        self.representation(None)?.voice(options)
    }

    /// Returns the spectral magnitudes that the best representation has at a motion.
    ///
    /// # Errors
    /// Returns the same errors as [`Representation::magnitude`].
    pub fn magnitude(
        &self,
        motion: Option<Motion>,
        frequency_hz: &[f64],
    ) -> Result<Vec<f64>, Error> {
        self.representation(None)?.magnitude(motion, frequency_hz)
    }

    /// Returns the level of the best representation at a motion, or at the default condition if
    /// `motion` is `None`. The level is an RMS in the texture's unit.
    ///
    /// # Errors
    /// Returns the same errors as [`Representation::level_rms`].
    pub fn level_rms(&self, motion: Option<Motion>) -> Result<f64, Error> {
        self.representation(None)?.level_rms(motion)
    }

    /// Returns the representations from the best to the worst. Representations that this program
    /// can run come before representations that it cannot run. Within each group, representations
    /// with a measured error come first, ordered by [`htex_format::Representation::error_db`] from
    /// small to large. Representations with equal errors keep the order of the file.
    ///
    /// ```no_run
    /// let texture = htex::Texture::open("sandpaper.htex")?;
    /// for representation in texture.ranked(htex::format::ErrorMeasure::NineBand) {
    ///     println!("{}", representation.id());
    /// }
    /// # Ok::<(), htex::Error>(())
    /// ```
    pub fn ranked(&self, measure: ErrorMeasure) -> Vec<Representation<'_>> {
        let sorted = self.by_error(measure).into_iter();
        let (mut ranked, others): (Vec<_>, Vec<_>) = sorted
            .map(|index| Representation::new(self, index))
            .partition(Representation::is_runnable);
        ranked.extend(others);
        ranked
    }

    /// Returns the indices of the representations. Representations with a measured error come
    /// first, ordered by this error, then the others.
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

    /// Returns the first of [`Self::ranked`]. Looks for models only as often as needed, because
    /// this takes longer than everything else here.
    fn best(&self, measure: ErrorMeasure) -> Option<usize> {
        let all = &self.data.manifest.representations;
        let sorted = self.by_error(measure);
        let runnable = sorted.iter().find(|i| self.is_runnable(&all[**i]));
        runnable.or(sorted.first()).copied()
    }

    /// Returns the model of a representation, which is loaded on the first call.
    pub(crate) fn model(&self, representation: usize) -> Result<LoadedModel, Error> {
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

    /// Returns whether the embedded model with this id may run. Always false in a program without a
    /// sandbox.
    fn may_run_embedded(&self, id: &str) -> bool {
        RUNS_WASM && self.embedded && self.embeds(id)
    }

    /// Returns whether this program has a model that can play a representation. Loads no model.
    pub(crate) fn is_runnable(&self, stored: &htex_format::Representation) -> bool {
        self.may_run_embedded(&stored.model) || self.installed(stored).is_ok()
    }

    /// Returns the model of a representation from the registry, ignoring embedded models.
    fn installed(&self, stored: &htex_format::Representation) -> Result<LoadedModel, Error> {
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
}

fn is_named(representation: &htex_format::Representation, name: &str) -> bool {
    let id = &representation.model;
    id == name || id.rsplit('.').next().is_some_and(|short| short.eq_ignore_ascii_case(name))
}
