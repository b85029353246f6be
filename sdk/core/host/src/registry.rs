//! The models available to a program.

use std::cmp::Reverse;
use std::sync::Arc;

use htex_model::{Descriptor, Model, MotionVoice};
use semver::Version;

use crate::runtime::{RuntimeModel, RuntimeModelAdapter};
use crate::sandbox::Sandbox;
use crate::{HostError, LoadedModel, Note, Origin, Search, WasmLimits};
use crate::{builtin, own};

/// Models by id. If several models have the same id, these rules decide which one is used:
///
/// - If the user named a model's file, or the program added the model, it takes precedence over all
///   other models. Among several such models, the one that was added first takes precedence.
/// - Of the installed models and the built-in model, the registry considers only the newest of each
///   major version. The place in which a version was found does not matter. Among equal versions,
///   the first one in the order of [`Search`] is used. Between different major versions, the order
///   of the places decides: the plugin folders, the user's folder, the folders of all users, this
///   program. The registry uses the major version that is in the first of these places. If that
///   place contains several major versions, the registry uses the newest.
///
/// The other models are returned only if their version is requested.
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
    /// The models that are used, in display order.
    models: Vec<LoadedModel>,
    /// The rank of each model in `models`. The ranks are sorted in ascending order.
    ranks: Vec<Rank>,
    /// Models whose id also occurs in `models`. Among models with the same id, the order is the
    /// order of precedence.
    shadowed: Vec<Candidate>,
    notes: Vec<Note>,
    sandbox: Sandbox,
}

/// A model and the rank of its origin.
#[derive(Debug, Clone)]
struct Candidate {
    rank: Rank,
    model: LoadedModel,
}

/// Precedence of origins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Rank {
    File,
    Embedded,
    Folder,
    User,
    System,
    Builtin,
}

impl Rank {
    /// Returns whether the user or a program chose this very model, and did not only name a folder
    /// that contains it.
    fn is_chosen(self) -> bool {
        matches!(self, Self::File | Self::Embedded)
    }
}

impl Candidate {
    fn version(&self) -> Option<Version> {
        Version::parse(&self.model.descriptor().version).ok()
    }

    fn major(&self) -> Option<u64> {
        self.version().map(|version| version.major)
    }
}

/// Sorts models with the same id by the precedence that [`Registry`] describes. The models must be
/// in the order in which they were added.
fn by_precedence(all: &mut [Candidate]) {
    let first_place = |major: Option<u64>| {
        let installed = all.iter().filter(|one| !one.rank.is_chosen());
        installed.filter(|one| one.major() == major).map(|one| one.rank).min()
    };
    let places: Vec<_> = all.iter().map(|one| first_place(one.major())).collect();
    let mut keyed: Vec<_> = places.into_iter().zip(all.iter().cloned()).collect();
    keyed.sort_by_cached_key(|(place, one)| {
        if one.rank.is_chosen() {
            // The sort is stable, so chosen models of one rank keep the order in which they were
            // added.
            (one.rank, None, Reverse(None), one.rank)
        } else {
            (Rank::Folder, *place, Reverse(one.version()), one.rank)
        }
    });
    for (sorted, (_, one)) in all.iter_mut().zip(keyed) {
        *sorted = one;
    }
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

    /// Returns the short names of all built-in models except those that follow the motion. The
    /// sound of these models does not depend on the finger's position.
    pub fn placeless_names() -> Vec<&'static str> {
        let models = builtin::models().iter();
        let placeless = models.filter(|model| !model.follows_motion());
        placeless.map(LoadedModel::short_name).collect()
    }

    /// Returns the models that a search finds.
    ///
    /// # Errors
    /// Returns an error if one of the search's `files` or `modules` cannot be loaded, or if one of
    /// its `dirs` cannot be read.
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

    /// Returns a registry for one asset. The modules that a program adds to the new registry share
    /// the limits [`WasmLimits::asset`]. They also count towards the total limits of this registry.
    #[must_use]
    pub fn of_asset(self) -> Self {
        Self { sandbox: self.sandbox.of_asset(), ..self }
    }

    pub(crate) fn sandbox(&self) -> &Sandbox {
        &self.sandbox
    }

    pub(crate) fn add_builtin(&mut self) {
        for model in builtin::models() {
            self.add(Rank::Builtin, model.clone());
        }
    }

    /// Adds a model of this program: a type that implements [`Model`]. The new model takes
    /// precedence over all other models with the same id, except models that the user named or that
    /// the program added earlier.
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
    /// Returns an error if the descriptor is invalid, or longer than 1 MiB in JSON.
    pub fn add_model<M: Model>(&mut self) -> Result<(), HostError> {
        self.add_described(Origin::Own, own::model::<M>()?)
    }

    /// Adds a model that itself follows the motion (the extension `htex.motion/1`). In every other
    /// respect, this function does the same as [`Self::add_model`].
    ///
    /// # Errors
    /// Returns the errors of [`Self::add_model`].
    pub fn add_motion_model<M: Model<Voice: MotionVoice>>(&mut self) -> Result<(), HostError> {
        self.add_described(Origin::Own, own::motion_model::<M>()?)
    }

    fn add_described(
        &mut self,
        origin: Origin,
        model: RuntimeModelAdapter,
    ) -> Result<(), HostError> {
        self.add(Rank::File, LoadedModel::new(origin, Arc::new(model))?);
        Ok(())
    }

    /// Adds a model that is described at run time. `written_in` is the name of the programming
    /// language, for [`Origin::Runtime`]. The model has the same precedence as a model added by
    /// [`Self::add_model`].
    ///
    /// # Errors
    /// Returns an error if the descriptor is invalid, or longer than 1 MiB in JSON.
    pub fn add_runtime_model(
        &mut self,
        written_in: &str,
        descriptor: Descriptor,
        model: Arc<dyn RuntimeModel>,
    ) -> Result<(), HostError> {
        let origin = Origin::Runtime(written_in.to_owned());
        self.add_described(origin, RuntimeModelAdapter::new(descriptor, model)?)
    }

    /// Adds the WASM model of a container, such as an asset; `name` is the container's name. Only
    /// plugins whose files the user named, and models that the program added, take precedence over
    /// this model. This function refuses native libraries.
    ///
    /// # Errors
    /// Returns an error if the bytes are not a module, or if its model violates the ABI.
    pub fn add_wasm_bytes(&mut self, name: &str, bytes: &[u8]) -> Result<(), HostError> {
        let model = LoadedModel::from_wasm_in(name, bytes, &self.sandbox)?;
        self.add(Rank::Embedded, model);
        Ok(())
    }

    /// Adds a model as [`Self::add_wasm_bytes`] does, but only if the module has the declared id
    /// and version.
    ///
    /// # Errors
    /// Returns the errors of [`Self::add_wasm_bytes`], and [`HostError::OtherModel`].
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

    /// Adds a model. If it shadows another model, or another model shadows it, also adds a note.
    pub(crate) fn add(&mut self, rank: Rank, model: LoadedModel) {
        let id = model.id().to_owned();
        let new = Candidate { rank, model };
        let Some(used) = self.models.iter().position(|m| m.id() == id) else {
            let at = self.place_of(rank);
            self.note_same_name(at, &new.model);
            return self.insert(at, new);
        };
        let old = Candidate { rank: self.ranks.remove(used), model: self.models.remove(used) };
        let (mut same, others): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.shadowed).into_iter().partition(|one| one.model.id() == id);
        // The old model is put first, because it had the highest precedence, and `by_precedence`
        // keeps the order of chosen models.
        same.insert(0, old.clone());
        same.push(new.clone());
        by_precedence(&mut same);
        let first = same.remove(0);
        let shadowed = if first.model.is_same(&new.model) { &old.model } else { &new.model };
        self.note_shadow(&first.model, shadowed);
        self.shadowed = [others, same].concat();
        self.insert(self.place_of(first.rank), first);
    }

    /// Returns the index in `models` after the last model of a rank.
    fn place_of(&self, rank: Rank) -> usize {
        self.ranks.partition_point(|other| *other <= rank)
    }

    fn insert(&mut self, at: usize, new: Candidate) {
        self.models.insert(at, new.model);
        self.ranks.insert(at, new.rank);
    }

    /// Returns all models with one id: first the model that is used, then the models that it
    /// shadows.
    pub fn all<'a>(&'a self, id: &'a str) -> impl Iterator<Item = &'a LoadedModel> + Clone {
        self.every().filter(move |model| model.id() == id)
    }

    fn every(&self) -> impl Iterator<Item = &LoadedModel> + Clone {
        let shadowed = self.shadowed.iter().map(|one| &one.model);
        self.models.iter().chain(shadowed)
    }

    pub(crate) fn note(&mut self, note: Note) {
        self.notes.push(note);
    }

    fn note_shadow(&mut self, used: &LoadedModel, shadowed: &LoadedModel) {
        let named = |m: &LoadedModel| (m.descriptor().version.clone(), m.origin().clone());
        self.notes.push(Note::Shadowed {
            id: shadowed.id().to_owned(),
            used: named(used),
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

    /// Returns the models that are used: one model for each id.
    pub fn models(&self) -> &[LoadedModel] {
        &self.models
    }

    /// Returns the models that a program fits if the user names no model. These are all models
    /// except those whose descriptor sets [`only_named`](Descriptor::only_named).
    pub fn by_default(&self) -> impl Iterator<Item = &LoadedModel> {
        self.models.iter().filter(|model| !model.descriptor().only_named)
    }

    /// Returns notes for the user, e.g. about models that shadow other models, and about plugins
    /// that could not be loaded.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Finds a model by its id or its short name (`org.htex.sbeta` or `sbeta`; short names are
    /// case-insensitive).
    ///
    /// # Errors
    /// [`HostError::UnknownModel`] with the known names.
    pub fn find(&self, name: &str) -> Result<&LoadedModel, HostError> {
        let by_id = self.models.iter().find(|m| m.id() == name);
        let by_name = || self.models.iter().find(|m| m.short_name().eq_ignore_ascii_case(name));
        by_id.or_else(by_name).ok_or_else(|| {
            let mut names: Vec<&str> = self.every().map(LoadedModel::short_name).collect();
            names.dedup();
            HostError::UnknownModel { wanted: name.to_owned(), known: names.join(", ") }
        })
    }
}
