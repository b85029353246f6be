//! The models available to a program.

use std::sync::Arc;

use htex_model::{Descriptor, Model, MotionVoice};
use semver::{Version, VersionReq};

use crate::runtime::{Described, RuntimeModel};
use crate::sandbox::Sandbox;
use crate::{HostError, LoadedModel, Note, Origin, Search, WasmLimits};
use crate::{builtin, own};

/// Models by id. Of several models with one id, the first in the order of [`Search`] is used; the others are
/// returned only for requests of their version.
///
/// ```
/// use htex_host::Registry;
/// let registry = Registry::builtin();
/// assert_eq!(registry.models().len(), Registry::builtin_names().len());
/// assert_eq!(registry.find("AR")?.id(), "org.htex.ar");
/// # Ok::<(), htex_host::HostError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Registry {
    /// In display order.
    models: Vec<LoadedModel>,
    /// Models with the same id as one of `models`.
    shadowed: Vec<LoadedModel>,
    /// The rank of each of `models`, ascending.
    ranks: Vec<Rank>,
    notes: Vec<Note>,
    sandbox: Sandbox,
}

/// Precedence of origins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Rank {
    File,
    Embedded,
    Folder,
    User,
    Builtin,
}

impl Registry {
    /// Returns the models linked into this program.
    pub fn builtin() -> Self {
        let mut registry = Self::empty(&WasmLimits::default());
        registry.add_builtin();
        registry
    }

    /// Returns the short names of the models linked into this program, in their display order.
    pub fn builtin_names() -> Vec<&'static str> {
        let models = builtin::models().iter();
        models.map(LoadedModel::short_name).collect()
    }

    /// Returns the short names of those among them whose sound is the same at each place: all but models that follow the motion.
    pub fn placeless_names() -> Vec<&'static str> {
        let models = builtin::models().iter();
        let placeless = models.filter(|model| !model.follows_motion());
        placeless.map(LoadedModel::short_name).collect()
    }

    /// Returns the models that a search finds.
    ///
    /// # Errors
    /// When one of the search's `files` cannot be loaded, or one of its `dirs` cannot be read.
    pub fn search(search: &Search) -> Result<Self, HostError> {
        search.run()
    }

    pub(crate) fn empty(limits: &WasmLimits) -> Self {
        Self {
            models: Vec::new(),
            shadowed: Vec::new(),
            ranks: Vec::new(),
            notes: Vec::new(),
            sandbox: Sandbox::new(limits),
        }
    }

    /// Returns the registry of one asset: modules that are added to it share the limits [`WasmLimits::asset`], within
    /// those of all modules of this registry.
    #[must_use]
    pub fn of_asset(self) -> Self {
        Self {
            sandbox: self.sandbox.of_asset(),
            ..self
        }
    }

    pub(crate) fn sandbox(&self) -> &Sandbox {
        &self.sandbox
    }

    pub(crate) fn add_builtin(&mut self) {
        for model in builtin::models() {
            self.add(Rank::Builtin, model.clone());
        }
    }

    /// Adds a model of this program: a type that implements the trait. It precedes all other models of its id except
    /// those that were named or registered before.
    ///
    /// ```
    /// use htex_host::Registry;
    /// use htex_model::*;
    /// /// White noise.
    /// struct White;
    /// struct WhiteVoice(u32);
    /// impl Voice for WhiteVoice {
    ///     fn render(&mut self, out: &mut [f32]) {
    ///         for x in out {
    ///             self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    ///             *x = self.0 as f32 / 2f32.powi(31) - 1.0;
    ///         }
    ///     }
    ///     fn retune(&mut self, _: &Values<'_>) -> Result<(), Error> { Ok(()) }
    /// }
    /// impl Model for White {
    ///     type Voice = WhiteVoice;
    ///     const DESCRIPTOR: StaticDescriptor =
    ///         StaticDescriptor::new("org.example.white", "White", "1.0.0", "White noise.").fields(FIELDS);
    ///     fn fit(_: &FitInput<'_>) -> Result<Fit, Error> {
    ///         Ok(Fit { parameters: vec![0.0], level_rms: 1.0 })
    ///     }
    ///     fn magnitude(_: &Values<'_>, _: Band, _: &[f64], magnitude: &mut [f64]) -> Result<(), Error> {
    ///         magnitude.fill(1.0);
    ///         Ok(())
    ///     }
    ///     fn interpolate(_: &[Values<'_>], _: &[f64], mixed: &mut Numbers<'_>) -> Result<(), Error> {
    ///         mixed.push(0.0);
    ///         Ok(())
    ///     }
    ///     fn voice(_: &Values<'_>, _: Band, _: f64, seed: u64) -> Result<WhiteVoice, Error> {
    ///         Ok(WhiteVoice(seed as u32))
    ///     }
    /// }
    /// const FIELDS: &[StaticField] = &[StaticField::scalar("colour", "", (0.0, 1.0), "Unused.")];
    /// let mut registry = Registry::builtin();
    /// registry.add_model::<White>()?;
    /// assert_eq!(registry.find("white")?.id(), "org.example.white");
    /// # Ok::<(), htex_host::HostError>(())
    /// ```
    ///
    /// # Errors
    /// When the descriptor is invalid, or longer than 1 MiB in JSON.
    pub fn add_model<M: Model>(&mut self) -> Result<(), HostError> {
        self.add_described(Origin::Own, own::model::<M>()?)
    }

    /// As [`Self::add_model`], for a model that follows the motion itself (the extension `htex.motion/1`).
    ///
    /// # Errors
    /// As [`Self::add_model`].
    pub fn add_motion_model<M: Model<Voice: MotionVoice>>(&mut self) -> Result<(), HostError> {
        self.add_described(Origin::Own, own::motion_model::<M>()?)
    }

    fn add_described(&mut self, origin: Origin, model: Described) -> Result<(), HostError> {
        self.add(Rank::File, LoadedModel::new(origin, Arc::new(model))?);
        Ok(())
    }

    /// Adds a model that is described while the program runs. `written_in` is its [`Origin::Runtime`]. It precedes other
    /// models as [`Self::add_model`] says.
    ///
    /// # Errors
    /// When the descriptor is invalid, or longer than 1 MiB in JSON.
    pub fn add_runtime_model(
        &mut self,
        written_in: &str,
        descriptor: Descriptor,
        model: Arc<dyn RuntimeModel>,
    ) -> Result<(), HostError> {
        let origin = Origin::Runtime(written_in.to_owned());
        self.add_described(origin, Described::new(descriptor, model)?)
    }

    /// Adds the WASM model of a container `name`, such as an asset, after plugins named by their files and before all
    /// others. A native library cannot be added in this way.
    ///
    /// # Errors
    /// When the bytes are not a module, or its model violates the ABI.
    pub fn add_wasm_bytes(&mut self, name: &str, bytes: &[u8]) -> Result<(), HostError> {
        let model = LoadedModel::from_wasm_in(name, bytes, &self.sandbox)?;
        self.add(Rank::Embedded, model);
        Ok(())
    }

    /// As [`Self::add_wasm_bytes`], for a declared id and version: a module with another id or version is not added.
    ///
    /// # Errors
    /// As [`Self::add_wasm_bytes`], and [`HostError::OtherModel`].
    pub fn add_declared_wasm(
        &mut self,
        name: &str,
        bytes: &[u8],
        declared: (&str, &str),
    ) -> Result<(), HostError> {
        let model = LoadedModel::from_wasm_in(name, bytes, &self.sandbox)?;
        let is = (model.id(), &model.descriptor().version[..]);
        if is != declared {
            let words = |(id, version): (&str, &str)| format!("{id} {version}");
            return Err(HostError::OtherModel {
                path: name.to_owned(),
                declared: words(declared),
                found: words(is),
            });
        }
        self.add(Rank::Embedded, model);
        Ok(())
    }

    /// Adds a model after those of its rank, and a note if it shadows a model or is shadowed.
    pub(crate) fn add(&mut self, rank: Rank, model: LoadedModel) {
        let at = self.ranks.partition_point(|other| *other <= rank);
        let same = self.models.iter().position(|m| m.id() == model.id());
        match same {
            Some(used) if used < at => {
                self.note_shadow(used, &model);
                self.shadowed.push(model);
                return;
            }
            Some(later) => {
                let old = std::mem::replace(&mut self.models[later], model.clone());
                self.note_shadow(later, &old);
                self.shadowed.insert(0, old);
                self.models.remove(later);
                self.ranks.remove(later);
            }
            None => self.note_same_name(at, &model),
        }
        self.models.insert(at, model);
        self.ranks.insert(at, rank);
    }

    /// Returns all models of one id: the one that is used, and those that it shadows.
    pub fn all<'a>(&'a self, id: &'a str) -> impl Iterator<Item = &'a LoadedModel> {
        let models = self.models.iter().chain(&self.shadowed);
        models.filter(move |model| model.id() == id)
    }

    pub(crate) fn note(&mut self, note: Note) {
        self.notes.push(note);
    }

    fn note_shadow(&mut self, used: usize, shadowed: &LoadedModel) {
        let named = |m: &LoadedModel| (m.descriptor().version.clone(), m.origin().clone());
        self.notes.push(Note::Shadowed {
            id: shadowed.id().to_owned(),
            used: named(&self.models[used]),
            shadowed: named(shadowed),
        });
    }

    fn note_same_name(&mut self, at: usize, model: &LoadedModel) {
        let name = model.short_name();
        let same = |m: &LoadedModel| m.short_name().eq_ignore_ascii_case(name);
        if let Some(other) = self.models.iter().position(same) {
            let ids = (self.models[other].id().to_owned(), model.id().to_owned());
            let (means, other) = if other < at { ids } else { (ids.1, ids.0) };
            let name = name.to_owned();
            self.notes.push(Note::SameName { name, means, other });
        }
    }

    /// Returns all models that are used, one per id.
    pub fn models(&self) -> &[LoadedModel] {
        &self.models
    }

    /// Returns the models that a program fits where none is named: all but those that are fitted only by name
    /// ([`LoadedModel::is_only_named`]).
    pub fn by_default(&self) -> impl Iterator<Item = &LoadedModel> {
        self.models.iter().filter(|model| !model.is_only_named())
    }

    /// Returns notes for the user: models that shadow others, and plugins that could not be loaded.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Returns a model by its id or its short name (`org.htex.sbeta` or `sbeta`; short names ignore case).
    ///
    /// # Errors
    /// [`HostError::UnknownModel`] with the known names.
    pub fn find(&self, name: &str) -> Result<&LoadedModel, HostError> {
        let by_id = self.models.iter().find(|m| m.id() == name);
        let by_name = || {
            self.models
                .iter()
                .find(|m| m.short_name().eq_ignore_ascii_case(name))
        };
        by_id
            .or_else(by_name)
            .ok_or_else(|| HostError::UnknownModel {
                wanted: name.to_owned(),
                known: self.known(|m| m.short_name().to_owned()),
            })
    }

    /// Returns the first model of this id whose version matches `wanted`, including shadowed ones.
    ///
    /// # Errors
    /// [`HostError::UnknownModel`] with the known ids and versions.
    pub fn find_version(&self, id: &str, wanted: &VersionReq) -> Result<&LoadedModel, HostError> {
        let matches = |m: &&LoadedModel| {
            let version = Version::parse(&m.descriptor().version);
            m.id() == id && version.is_ok_and(|version| wanted.matches(&version))
        };
        let mut all = self.models.iter().chain(&self.shadowed);
        all.find(matches).ok_or_else(|| HostError::UnknownModel {
            wanted: format!("{id} {wanted}"),
            known: self.known(|m| format!("{} {}", m.id(), m.descriptor().version)),
        })
    }

    fn known(&self, name: impl Fn(&LoadedModel) -> String) -> String {
        let all = self.models.iter().chain(&self.shadowed);
        let mut names: Vec<String> = all.map(name).collect();
        names.dedup();
        names.join(", ")
    }
}
