//! Plans the textures of a recipe, each with its recordings and settings.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Path, PathBuf};

use globset::GlobSet;
use htex_author::settings::Metadata;

use crate::BuildError;
use htex_format::library::LibraryMetadata;

use crate::error::at_place;
use crate::globs::glob_set;
use crate::imports::{FileKind, check_files};
use crate::inputs::{Input, MOST_RECORDINGS, Missing, inputs, slashed, too_many};
use crate::recipe::{Gates, MissingTextures, NumberOrTemplate, Recipe, Settings, Textures};
use crate::remote::RemoteFiles;
use crate::template::{Fields, fill};

/// The textures of a recipe.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    pub library: String,
    /// Metadata of the library itself, such as its version.
    pub metadata: LibraryMetadata,
    /// What happens to textures that the existing library contains but the plan does not.
    pub missing: MissingTextures,
    /// Largest number of textures that the library may lose.
    pub max_removed: Option<usize>,
    /// The textures, sorted by name.
    pub textures: Vec<PlannedTexture>,
}

/// A texture to be made.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedTexture {
    /// Name of the texture, unique in the library.
    pub name: String,
    /// Recordings of the texture, sorted by file.
    pub recordings: Vec<PlannedRecording>,
    /// The kind of the recordings' files.
    pub kind: FileKind,
    /// Settings of the texture. Paths in the settings are relative to the recipe.
    pub settings: Settings,
    /// Metadata of the texture. Placeholders of templates are already replaced by values.
    pub metadata: Metadata,
    /// The requirements that the texture's asset must meet.
    pub gates: Gates,
}

/// A recording of a texture.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRecording {
    /// The file, relative to the recipe.
    pub file: PathBuf,
    /// The tracker's file, relative to the recipe.
    pub tracker: Option<PathBuf>,
    /// Speed, mm/s, if the recipe states it.
    pub speed_mm_s: Option<f64>,
    /// Normal force, newtons, if the recipe states it.
    pub force_n: Option<f64>,
}

impl PlannedTexture {
    /// Returns the files that the texture's job reads, relative to the recipe. Plugins of the whole
    /// library are not included.
    pub(crate) fn files(&self) -> impl Iterator<Item = &PathBuf> {
        let recordings =
            self.recordings.iter().flat_map(|r| std::iter::once(&r.file).chain(&r.tracker));
        let settings = &self.settings;
        recordings.chain(&settings.reading.response).chain(settings.embed_plugins.iter().flatten())
    }
}

impl Plan {
    /// Returns the names in `names` that no planned texture has and that the library loses.
    pub(crate) fn removed(&self, names: &BTreeSet<String>) -> Vec<String> {
        match self.missing {
            MissingTextures::Remove => self.unplanned(names),
            MissingTextures::Keep => Vec::new(),
        }
    }

    /// Returns the names in `names` that no planned texture has and that stay in the library.
    pub(crate) fn kept(&self, names: &BTreeSet<String>) -> Vec<String> {
        match self.missing {
            MissingTextures::Remove => Vec::new(),
            MissingTextures::Keep => self.unplanned(names),
        }
    }

    fn unplanned(&self, names: &BTreeSet<String>) -> Vec<String> {
        let own: BTreeSet<&String> = self.textures.iter().map(|texture| &texture.name).collect();
        let unplanned = names.iter().filter(|name| !own.contains(name));
        unplanned.cloned().collect()
    }

    /// Finds the recordings of a recipe that lies in `folder`. Files in the build's own `output`
    /// folder do not count as recordings.
    ///
    /// # Errors
    /// If a glob matches nothing, a template or a pattern fails, a name is not valid, or two
    /// recordings of a texture have different settings.
    pub(crate) fn new(
        recipe: &Recipe,
        folder: &Path,
        output: &Path,
        remote: &RemoteFiles,
        missing: Missing,
    ) -> Result<Self, BuildError> {
        check_name("library.name", &recipe.library.name)?;
        if recipe.library.name.contains('/') {
            let problem = "`/` is not possible in the name of a file; leave it out";
            return Err(BuildError::at_place("library.name", problem));
        }
        if recipe.textures.is_empty() {
            let problem = "there is none; add a [[textures]] with `recordings`";
            return Err(BuildError::at_place("textures", problem));
        }
        let overrides = Overrides::new(recipe)?;
        let mut textures: BTreeMap<String, PlannedTexture> = BTreeMap::new();
        let mut known = HashSet::new();
        for (i, rule) in recipe.textures.iter().enumerate() {
            let place = format!("textures[{i}]");
            let settings = rule.settings.clone().over(recipe.defaults.clone());
            for input in inputs(rule, &place, (folder, output), remote, missing)? {
                let planned = planned(rule, &settings, &overrides, input, &place)?;
                check_once(&mut known, &planned, &place)?;
                gather(&mut textures, planned, &place)?;
            }
        }
        overrides.check_used(&textures)?;
        let mut textures: Vec<PlannedTexture> = textures.into_values().collect();
        for texture in &mut textures {
            texture.recordings.sort_by(|a, b| a.file.cmp(&b.file));
            check_files(texture)?;
        }
        check_folders(&textures)?;
        let metadata = recipe.library.metadata.clone();
        metadata.check().map_err(at_place("library"))?;
        Ok(Self {
            library: recipe.library.name.clone(),
            metadata,
            missing: recipe.library.missing,
            max_removed: recipe.library.max_removed,
            textures,
        })
    }
}

/// The overrides of a recipe.
struct Overrides<'a>(Vec<(GlobSet, &'a Settings)>);

impl<'a> Overrides<'a> {
    fn new(recipe: &'a Recipe) -> Result<Self, BuildError> {
        let overrides = recipe.overrides.iter().enumerate();
        let compiled = overrides.map(|(i, one)| {
            let set = glob_set(&one.textures, &format!("overrides[{i}].textures"))?;
            Ok((set, &one.settings))
        });
        compiled.collect::<Result<_, _>>().map(Self)
    }

    fn over(&self, name: &str, settings: Settings) -> Settings {
        let own = self.0.iter().filter(|(set, _)| set.is_match(name));
        own.fold(settings, |under, (_, own)| (*own).clone().over(under))
    }

    /// Refuses an override that matches no texture, because its name is probably misspelt.
    fn check_used(&self, textures: &BTreeMap<String, PlannedTexture>) -> Result<(), BuildError> {
        for (i, (set, _)) in self.0.iter().enumerate() {
            if !textures.keys().any(|name| set.is_match(name)) {
                let problem = "no texture has such a name; correct it, or leave the override out";
                return Err(BuildError::at_place(format!("overrides[{i}].textures"), problem));
            }
        }
        Ok(())
    }
}

/// Plans the texture of one recording.
fn planned(
    rule: &Textures,
    settings: &Settings,
    overrides: &Overrides<'_>,
    input: Input,
    place: &str,
) -> Result<PlannedTexture, BuildError> {
    let Input { file, mut fields, .. } = input;
    let shown = slashed(&file);
    let of = |key: &str| format!("{place}.{key}: {shown}");
    let template = match (&rule.name, fields.get("name")) {
        (Some(template), _) => template.clone(),
        (None, Some(_)) => "{name}".to_owned(),
        (None, None) => "{stem}".to_owned(),
    };
    let name = fill(&template, &fields).map_err(at_place(of("name")))?;
    check_name(&format!("{place}.name"), &name)?;
    fields.insert("name".to_owned(), name.clone());
    let mut settings = overrides.over(&name, settings.clone());
    let at = std::mem::take(&mut settings.at);
    let condition = |key: &str, given: Option<NumberOrTemplate>| {
        number(key, given, &fields).map_err(at_place(of("at")))
    };
    let tracker = tracker(&mut settings, &fields).map_err(at_place(of("tracker")))?;
    let recording = PlannedRecording {
        file,
        tracker,
        speed_mm_s: condition("speed_mm_s", at.speed_mm_s)?,
        force_n: condition("force_n", at.force_n)?,
    };
    let metadata = filled(settings.metadata.clone(), &fields, of)?;
    // Gates must not change a fit, so that they can be changed without a new fit. Only `strict`
    // stops a fit.
    let gates = std::mem::take(&mut settings.gates);
    settings.gates.strict = gates.strict;
    Ok(PlannedTexture {
        name,
        recordings: vec![recording],
        kind: FileKind::default(),
        settings,
        metadata,
        gates,
    })
}

/// Takes the tracker's file of a recording out of the settings.
fn tracker(settings: &mut Settings, fields: &Fields) -> Result<Option<PathBuf>, String> {
    match &settings.reading.tracker.take().unwrap_or_default()[..] {
        [] => Ok(None),
        [file] => Ok(Some(fill(&file.to_string_lossy(), fields)?.into())),
        _ => Err("a recording has one tracker; give a template".to_owned()),
    }
}

/// Returns a speed or a force: the given number, or else the number in the table's column.
fn number(
    key: &str,
    given: Option<NumberOrTemplate>,
    fields: &Fields,
) -> Result<Option<f64>, String> {
    let text = match given {
        Some(NumberOrTemplate::Number(number)) => return Ok(Some(number)),
        Some(NumberOrTemplate::Template(template)) => fill(&template, fields)?,
        None => fields.get(key).cloned().unwrap_or_default(),
    };
    let text = text.trim();
    if text.is_empty() {
        return Ok(None);
    }
    let number = text.parse().map_err(|_| format!("{key} is `{text}`; it is a number"))?;
    Ok(Some(number))
}

/// Fills the templates of metadata. `of` gives the place of a key for messages.
fn filled(
    mut metadata: Metadata,
    fields: &Fields,
    of: impl Fn(&str) -> String,
) -> Result<Metadata, BuildError> {
    let texts = [
        ("author", &mut metadata.author),
        ("license", &mut metadata.license),
        ("description", &mut metadata.description),
        ("source", &mut metadata.source),
        ("doi", &mut metadata.doi),
        ("sensor", &mut metadata.sensor),
        ("finger", &mut metadata.finger),
    ];
    for (key, text) in texts {
        if let Some(text) = text {
            *text = fill(text, fields).map_err(at_place(of(key)))?;
        }
    }
    for tag in metadata.tags.iter_mut().flatten() {
        *tag = fill(tag, fields).map_err(at_place(of("tags")))?;
    }
    metadata.check().map_err(at_place(of("metadata")))?;
    Ok(metadata)
}

/// Refuses a recording that the texture already has. `known` holds hashes of textures with their
/// recordings.
fn check_once(
    known: &mut HashSet<[u8; 32]>,
    planned: &PlannedTexture,
    place: &str,
) -> Result<(), BuildError> {
    for recording in &planned.recordings {
        if known.len() == MOST_RECORDINGS {
            return Err(too_many(place));
        }
        let mut hasher = blake3::Hasher::new();
        // The length keeps the name and the file apart.
        hasher.update(&(planned.name.len() as u64).to_le_bytes());
        hasher.update(planned.name.as_bytes());
        hasher.update(recording.file.as_os_str().as_encoded_bytes());
        if !known.insert(*hasher.finalize().as_bytes()) {
            let problem = format!(
                "{} is a recording of the texture {} twice; let one rule find it",
                slashed(&recording.file),
                planned.name
            );
            return Err(BuildError::at_place(place, problem));
        }
    }
    Ok(())
}

/// Adds the texture of a recording to the plan's textures.
fn gather(
    textures: &mut BTreeMap<String, PlannedTexture>,
    planned: PlannedTexture,
    place: &str,
) -> Result<(), BuildError> {
    let Some(known) = textures.get_mut(&planned.name) else {
        textures.insert(planned.name.clone(), planned);
        return Ok(());
    };
    let same = (&known.settings, &known.metadata, &known.gates)
        == (&planned.settings, &planned.metadata, &planned.gates);
    if !same {
        let file = |texture: &PlannedTexture| {
            texture.recordings.first().map(|r| slashed(&r.file)).unwrap_or_default()
        };
        let problem = format!(
            "{} and {} are recordings of one texture, {}, and have different settings; give them the same, or other names",
            file(known),
            file(&planned),
            planned.name
        );
        return Err(BuildError::at_place(place, problem));
    }
    known.recordings.extend(planned.recordings);
    Ok(())
}

fn check_name(place: &str, name: &str) -> Result<(), BuildError> {
    htex_format::library::check_name(name).map_err(at_place(place))
}

/// Refuses a texture whose file would have the same path as a folder of another texture.
fn check_folders(textures: &[PlannedTexture]) -> Result<(), BuildError> {
    for pair in textures.windows(2) {
        let (folder, inside) = (format!("{}.htex/", pair[0].name), &pair[1].name);
        if inside.starts_with(&folder) {
            let problem = format!("{} and {inside} cannot both be files; rename one", pair[0].name);
            return Err(BuildError::at_place("textures", problem));
        }
    }
    Ok(())
}
