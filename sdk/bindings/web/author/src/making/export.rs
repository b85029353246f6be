//! Exports textures to files of other haptic formats.

use htex::Texture;
use htex::format::Asset;
use htex_exchange::{Coding, Export, ExportedFile, Format, Path, Profile, Stroke, Writes};
use serde::Serialize;

use super::import::refusal;
use crate::answer::{Answer, Files};
use crate::document::Document;
use crate::refusal::Refusal;

/// Settings: their names in the description of a format, and in this module.
const SETTINGS: [(&str, &str); 9] = [
    ("model", "model"),
    ("speed", "speed_mm_s"),
    ("force", "force_n"),
    ("seconds", "seconds"),
    ("stroke", "stroke"),
    ("profile", "profile"),
    ("rate", "rate_hz"),
    ("coding", "coding"),
    ("seed", "seed"),
];
/// Largest seed. JavaScript and JSON have no larger whole numbers that are exact.
const MOST_SEED: f64 = 9_007_199_254_740_991.0;

fn named(setting: &str) -> &str {
    let own = SETTINGS.iter().find(|(keyword, _)| *keyword == setting);
    own.map_or(setting, |(_, name)| name)
}

/// A format that can be exported.
#[derive(Serialize)]
pub(super) struct ExportSummary<'a> {
    name: &'a str,
    title: &'a str,
    extensions: &'a [&'a str],
    settings: Vec<&'a str>,
    /// The profile that is used if none is given.
    profile: Option<&'a str>,
    keeps: &'a str,
    loses: &'a str,
    /// Where its files state licence and author.
    rights: &'a str,
}

impl ExportSummary<'static> {
    pub(super) fn new(format: &'static Format) -> Option<Self> {
        let writes = format.writes.as_ref()?;
        Some(Self {
            name: format.name,
            title: format.title,
            extensions: format.extensions,
            settings: writes.settings().into_iter().map(named).collect(),
            profile: match writes {
                Writes::Signal { profile, .. } => Some(*profile),
                Writes::Asset(_) | Writes::Map => None,
            },
            keeps: format.keeps,
            loses: format.loses,
            rights: format.rights.place,
        })
    }
}

#[derive(Serialize)]
struct Exported<'a> {
    extension: &'a str,
    report: &'a ExportedFile,
}

/// Exports a texture, which is the first file. If there is a stroke, it is the second file. The
/// bytes of the answer are the exported file.
pub(crate) fn export(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let format = call.text("format")?.unwrap_or_default();
    let mut settings = call.object("settings")?;
    call.finish()?;
    let format = Format::find_for_export(&format)?;
    let given = SETTINGS.iter().filter(|(_, name)| settings.has(name));
    let given = Vec::from_iter(given.map(|(keyword, _)| *keyword));
    let extension = settings.text("extension")?;
    let model = settings.text("model")?;
    let (speed, force) = (settings.number("speed_mm_s")?, settings.number("force_n")?);
    let stroke = settings.text("stroke")?;
    let profile = settings.text("profile")?;
    let coding = settings.text("coding")?;
    let mut export = Export::new(format);
    export.seconds = settings.number("seconds")?.unwrap_or(export.seconds);
    export.rate_hz = settings.number("rate_hz")?;
    export.seed = seed(settings.number("seed")?)?;
    settings.finish()?;
    format.check_export(given).map_err(|error| refusal(error, named))?;
    export.model = model.as_deref();
    export.profile = profile.as_deref().map(Profile::find).transpose()?;
    export.coding = coding.as_deref().map(Coding::find).transpose()?;
    let extension = extension_of(format, extension)?;
    export.extension = Some(extension);
    let (bytes, stroke) = match (files, &stroke) {
        ([texture], None) => (*texture, None),
        ([texture, csv], Some(name)) => (*texture, Some(Stroke::from_bytes(name, csv)?)),
        _ => return Err(Refusal::argument("give one texture, and at most one stroke")),
    };
    let asset = Texture::new(Asset::from_bytes(bytes)?);
    export.file = Some(bytes);
    export.path = match stroke {
        Some(stroke) => Path::Stroke(stroke),
        None => Path::at(&asset, export.model, speed, force)?,
    };
    let exported = htex_exchange::export(&asset, &export);
    let exported = exported.map_err(|error| refusal(error, named))?;
    let told = Exported { extension, report: &exported };
    let mut answer = Answer::new(&told, Vec::new())?;
    answer.bytes = exported.bytes;
    Ok(answer)
}

/// Returns the given extension if files of this format may have it. Without one, returns the
/// format's first extension.
fn extension_of(format: &Format, given: Option<String>) -> Result<&'static str, Refusal> {
    let all = format.extensions;
    let found = match &given {
        None => all.first(),
        Some(own) => all.iter().find(|extension| *extension == own),
    };
    found.copied().ok_or_else(|| {
        Refusal::argument(format!("{}: its extension is {}", format.name, all.join(" or ")))
    })
}

fn seed(given: Option<f64>) -> Result<u64, Refusal> {
    let seed = given.unwrap_or_default();
    if (0.0..=MOST_SEED).contains(&seed) && seed.fract() == 0.0 {
        return Ok(seed as u64);
    }
    Err(Refusal::argument(format!("seed {seed}: a whole number from 0 to {MOST_SEED}")))
}
