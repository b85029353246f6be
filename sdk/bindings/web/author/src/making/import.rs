//! Imports files of other haptic formats as textures.

use std::path::Path;

use htex::model::Registry;
use htex::play::ErrorKind;
use htex_author::settings::{FitSettings, Metadata};
use htex_c::htex_status::*;
use htex_exchange::{
    ExchangeError, FORMATS, Format, Import, ImportedAsset, MOST_BYTES, Missing, PROFILES, Physical,
    Profile, Reads, missing,
};
use htex_format::Condition;
use serde::Serialize;

use super::TOOL;
use super::describe::{self, DescribedNotice};
use super::export::ExportSummary;
use super::made::quantity;
use super::progress;
use super::represented::{Model, ranked, represented};
use crate::answer::{Answer, Files};
use crate::document::Document;
use crate::refusal::Refusal;

/// Names of settings: in the description of a format, and in this module, where they are the same
/// as for recordings and fits.
const NAMES: [(&str, &str); 5] = [
    ("speed", "speed_mm_s"),
    ("force", "force_n"),
    ("pitch", "pitch_mm"),
    ("model", "models"),
    ("option", "options"),
];
/// The fit setting that refuses recordings because of their findings. An imported signal has no
/// findings, so imports do not have this setting.
const STRICT: &str = "strict";

fn named(setting: &str) -> &str {
    let other = NAMES.iter().find(|(own, _)| *own == setting);
    other.map_or(setting, |(_, name)| name)
}

#[derive(Serialize)]
struct Formats<'a> {
    formats: Vec<FormatSummary<'a>>,
    exports: Vec<ExportSummary<'a>>,
    profiles: Vec<Range<'a>>,
}

/// A format that can be imported.
#[derive(Serialize)]
struct FormatSummary<'a> {
    name: &'a str,
    title: &'a str,
    extensions: &'a [&'a str],
    /// Whether models are fitted to its files.
    fitted: bool,
    settings: Vec<&'a str>,
    asks: Vec<MissingSetting>,
    /// The profile that is used if none is given.
    profile: Option<&'a str>,
    keeps: &'a str,
    loses: &'a str,
    /// Where its files state licence and author.
    rights: &'a str,
}

#[derive(Serialize)]
struct MissingSetting {
    setting: &'static str,
    words: &'static str,
}

/// The frequency range of an actuator.
#[derive(Serialize)]
struct Range<'a> {
    name: &'a str,
    title: &'a str,
    low_hz: f64,
    high_hz: f64,
}

/// Describes the formats that can be imported and exported, and the actuators.
pub(crate) fn formats(call: Document, _: Files<'_>) -> Result<Answer, Refusal> {
    call.finish()?;
    let range = |profile: &'static Profile| Range {
        name: &profile.name,
        title: &profile.title,
        low_hz: profile.low_hz.value,
        high_hz: profile.high_hz.value,
    };
    let told = Formats {
        formats: FORMATS.iter().filter_map(described).collect(),
        exports: FORMATS.iter().filter_map(ExportSummary::new).collect(),
        profiles: PROFILES.iter().map(range).collect(),
    };
    Answer::new(&told, Vec::new())
}

fn described(format: &'static Format) -> Option<FormatSummary<'static>> {
    let reads = format.reads.as_ref()?;
    let (fitted, profile) = match reads {
        Reads::Positions { profile, .. } => (true, Some(*profile)),
        Reads::Signal(_) => (true, None),
        Reads::Asset(_) | Reads::Map => (false, None),
    };
    Some(FormatSummary {
        name: format.name,
        title: format.title,
        extensions: format.extensions,
        fitted,
        settings: reads.settings().into_iter().map(named).collect(),
        asks: asked(reads.missing()),
        profile,
        keeps: format.keeps,
        loses: format.loses,
        rights: format.rights.place,
    })
}

fn asked(missing: Vec<Missing>) -> Vec<MissingSetting> {
    let one =
        |missing: Missing| MissingSetting { setting: named(missing.setting), words: missing.words };
    missing.into_iter().map(one).collect()
}

/// Returns what a file does not state. An import needs each of these as a setting.
pub(crate) fn asks(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let file = call.text("file")?.unwrap_or_default();
    call.finish()?;
    let bytes = only(&file, files)?;
    Answer::new(&asked(missing(&file, bytes)?), Vec::new())
}

/// Imports a file. The bytes of the answer are the asset.
pub(crate) fn import(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let file = call.text("file")?.unwrap_or_default();
    let mut settings = call.object("settings")?;
    call.finish()?;
    let bytes = only(&file, files)?;
    let format = Format::of_file(&file)?;
    let stem = Path::new(&file).file_stem().unwrap_or_default().to_string_lossy();
    let how = how(&stem, &mut settings)?;
    settings.finish()?;
    let registry = Registry::builtin();
    progress::start(1);
    progress::begin("import", &file);
    let imported = htex_exchange::import(&file, bytes, &how, &registry);
    // Called before an error returns, because the next call must not report the steps of this call.
    progress::end();
    let imported = imported?;
    Answer::new(&Report::new(format, &imported), imported.to_bytes()?)
}

fn how<'a>(name: &'a str, settings: &mut Document) -> Result<Import<'a>, Refusal> {
    let names: Vec<&str> = FitSettings::NAMES.to_vec();
    let names: Vec<&str> = names.into_iter().filter(|name| *name != STRICT).collect();
    let profile = settings.text("profile")?;
    let how = Import {
        name,
        physical: Physical {
            full_scale: settings.number("full_scale")?,
            quantity: quantity(settings.text("quantity")?)?,
            speed_mm_s: settings.number("speed_mm_s")?,
            force_n: settings.number("force_n")?,
            pitch_mm: settings.number("pitch_mm")?,
        },
        profile: profile.as_deref().map(Profile::find).transpose()?,
        fit: settings.table(&names)?,
        metadata: settings.table(Metadata::NAMES)?,
        license_file: None,
        tool: TOOL,
    };
    how.metadata.check()?;
    Ok(how)
}

/// Returns the bytes of the only file.
fn only<'a>(name: &str, files: Files<'a>) -> Result<&'a [u8], Refusal> {
    let [bytes] = files else {
        return Err(Refusal::argument("give one file"));
    };
    if bytes.len() as u64 > MOST_BYTES {
        let name = htex_base::finding::plain(name);
        let sentence =
            format!("{name}: it has {} bytes, and at most {MOST_BYTES} are read", bytes.len());
        return Err(Refusal::file(sentence));
    }
    Ok(bytes)
}

/// The results of an import that the file of the texture does not contain.
#[derive(Serialize)]
struct Report<'a> {
    format: &'a str,
    models: Vec<Model<'a>>,
    ranked: Vec<&'a str>,
    conditions: &'a [Condition],
    warnings: Vec<DescribedNotice<'a>>,
    notes: Vec<DescribedNotice<'a>>,
}

impl<'a> Report<'a> {
    fn new(format: &'a Format, imported: &'a ImportedAsset) -> Self {
        let models = represented(&imported.asset, &imported.felt);
        Self {
            format: format.name,
            ranked: ranked(&models),
            models,
            conditions: &imported.asset.manifest.conditions,
            warnings: describe::notices(&imported.warnings),
            notes: describe::notices(&imported.notes),
        }
    }
}

impl Refusal {
    /// An error for a file that does not follow its own format.
    fn file(error: impl ToString) -> Self {
        Self::new(HTEX_STATUS_INVALID_ARGUMENT, "invalid-file", error)
    }
}

/// Converts an error. `named` converts the keyword of a setting to its name in JavaScript.
pub(super) fn refusal(error: ExchangeError, named: fn(&str) -> &str) -> Refusal {
    match error {
        ExchangeError::Author(error) => error.into(),
        ExchangeError::File { .. } => Refusal::file(error),
        ExchangeError::Play(error) if error.kind() == ErrorKind::NoModel => {
            Refusal::new(HTEX_STATUS_NO_MODEL, "no-model", error)
        }
        ExchangeError::Play(error) => error.into(),
        other => Refusal::argument(other.message_with(&|setting| named(setting).to_owned())),
    }
}

impl From<ExchangeError> for Refusal {
    fn from(error: ExchangeError) -> Self {
        refusal(error, named)
    }
}
